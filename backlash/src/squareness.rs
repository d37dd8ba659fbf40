//! Three axes that are not quite square to each other.

use crate::error_table::REACH_NM;

/// By how much three axes lean: X is the reference, Y lies in the plane of X and Y.
///
/// A lean is the way across for a way along, in parts in 10^9 (100 um/m are 100 000, or 100
/// microradians): with `xy_ppb` above 0 the angle between X and Y is below a right one, and a way
/// along Y carries X with it. Up to 1 % the lengths along the axes change by 5 parts in 10^5 only,
/// second order; they belong to the scales.
///
/// To readings and back is exact, nanometre for nanometre: what is added to a coordinate is found
/// from the others, which the way back finds first. Coordinates beyond 34 m count as 34 m in it.
///
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
    /// Lean of Y towards X. All three are taken as 1 % where they are beyond it.
    pub xy_ppb: i32,
    /// Lean of Z towards X.
    pub xz_ppb: i32,
    /// Lean of Z towards Y.
    pub yz_ppb: i32,
}

impl Squareness {
    /// The position in square coordinates of a place with these along the axes, nanometres. Wraps
    /// at the ends of `i64`.
    ///
    /// Cost: two 64-bit divisions by a constant.
    #[must_use]
    pub fn position_nm(&self, [x, y, z]: [i64; 3]) -> [i64; 3] {
        [
            x.wrapping_add(self.x_shift(y, z)),
            y.wrapping_add(self.y_shift(z)),
            z,
        ]
    }

    /// The coordinates along the axes of a place in square ones, nanometres: exactly back.
    #[must_use]
    pub fn reading_nm(&self, [x, y, z]: [i64; 3]) -> [i64; 3] {
        let y = y.wrapping_sub(self.y_shift(z));
        [x.wrapping_sub(self.x_shift(y, z)), y, z]
    }

    /// What the other two, along their axes, add to X.
    pub(crate) fn x_shift(&self, y: i64, z: i64) -> i64 {
        // Each below 2^59.
        rounded(across(self.xy_ppb, y).wrapping_add(across(self.xz_ppb, z)))
    }

    /// What Z adds to Y.
    pub(crate) fn y_shift(&self, z: i64) -> i64 {
        rounded(across(self.yz_ppb, z))
    }
}

/// Lean times way, in 10^-9 nm: below 2^24 and 2^35.
fn across(ppb: i32, way_nm: i64) -> i64 {
    let ppb = ppb.clamp(-10_000_000, 10_000_000);
    let way_nm = way_nm.clamp(-REACH_NM, REACH_NM);
    way_nm.wrapping_mul(ppb.into())
}

/// To the nearest nanometre.
fn rounded(ppb_nm: i64) -> i64 {
    ppb_nm.wrapping_add(500_000_000).div_euclid(1_000_000_000)
}
