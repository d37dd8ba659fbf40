//! Three axes that are not exactly square to each other.

use crate::error_table::REACH_NM;

/// The leans of three axes. X is the reference, and Y lies in the plane of X and Y.
///
/// A lean is the distance across per distance along an axis, in parts in 10^9 (100 um/m are 100
/// 000, or 100 microradians). With `xy_ppb` above 0 the angle between X and Y is less than 90
/// degrees, and a motion along Y also moves X. Up to 1 % the lengths along the axes change by only
/// 5 parts in 10^5, an effect of second order that belongs to the scales.
///
/// The reverse conversion is exact to the nanometre, because the correction of a coordinate depends
/// on the other ones only, which the reverse conversion finds first. Coordinates beyond 34 m get
/// the correction of 34 m.
///
/// # Examples
/// ```
/// use husillo_backlash::Squareness;
///
/// let frame = Squareness { xy_ppb: 100_000, ..Squareness::default() };
/// assert_eq!(frame.position_nm([0, 200_000_000, 0]), [20_000, 200_000_000, 0]); // 20 um at 200 mm
/// assert_eq!(frame.reading_nm([20_000, 200_000_000, 0]), [0, 200_000_000, 0]);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Squareness {
    /// Lean of Y towards X. All three are limited to 1 %.
    pub xy_ppb: i32,
    /// Lean of Z towards X.
    pub xz_ppb: i32,
    /// Lean of Z towards Y.
    pub yz_ppb: i32,
}

impl Squareness {
    /// Converts coordinates along the axes to square coordinates, in nanometres. Wraps at the ends
    /// of `i64`.
    ///
    /// # Cost
    /// Two 64-bit divisions by a constant.
    #[must_use]
    pub fn position_nm(&self, [x, y, z]: [i64; 3]) -> [i64; 3] {
        [
            x.wrapping_add(self.x_shift(y, z)),
            y.wrapping_add(self.y_shift(z)),
            z,
        ]
    }

    /// Converts square coordinates to coordinates along the axes, in nanometres. It is the exact
    /// inverse.
    #[must_use]
    pub fn reading_nm(&self, [x, y, z]: [i64; 3]) -> [i64; 3] {
        let y = y.wrapping_sub(self.y_shift(z));
        [x.wrapping_sub(self.x_shift(y, z)), y, z]
    }

    /// The part of X that is due to Y and Z.
    pub(crate) fn x_shift(&self, y: i64, z: i64) -> i64 {
        // Each below 2^59.
        rounded(across(self.xy_ppb, y).wrapping_add(across(self.xz_ppb, z)))
    }

    /// The part of Y that is due to Z.
    pub(crate) fn y_shift(&self, z: i64) -> i64 {
        rounded(across(self.yz_ppb, z))
    }
}

/// Lean times distance, in 10^-9 nm. The factors are below 2^24 and 2^35.
fn across(ppb: i32, way_nm: i64) -> i64 {
    let ppb = ppb.clamp(-10_000_000, 10_000_000);
    let way_nm = way_nm.clamp(-REACH_NM, REACH_NM);
    way_nm.wrapping_mul(ppb.into())
}

/// Rounds to the nearest nanometre.
fn rounded(ppb_nm: i64) -> i64 {
    ppb_nm.wrapping_add(500_000_000).div_euclid(1_000_000_000)
}
