//! From where the probe was to where the work piece is.

use crate::unit_vector::{minus, plus};
use crate::{PreTravel, UnitVector};

/// What is known of a probe: the radius of its tip and its pre-travel.
///
/// `M = p - ed d - r n`: measured point, latched position of the ball's centre, pre-travel along
/// the direction of travel `d`, radius along the outward normal `n` of the surface. (Equation 1.6
/// of the one-axis original is the case `d = -x`, `n = +x`.) Both signs follow from the two
/// directions, so oblique approaches need nothing more.
///
/// Integers only; what it adds to the error of the position is below 1 nm.
///
/// ```
/// use husillo_probe::{PreTravel, Tip, UnitVector};
///
/// let tip = Tip { radius_nm: 1_000_000, pre_travel: PreTravel::uniform(5_000) };
/// let travel = UnitVector::X.reversed();
/// let surface = tip.surface_nm([20_000_000, 0, 0], &travel, &travel.reversed());
/// assert_eq!(surface, [19_005_000, 0, 0]);
/// ```
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tip<const K: usize> {
    /// Radius of the ball in nm, up to 2.1 m.
    pub radius_nm: i32,
    /// Pre-travel in nm by direction of travel.
    pub pre_travel: PreTravel<K>,
}

impl<const K: usize> Tip<K> {
    /// The point of contact, in nm: the latched `position_nm` of an approach along `travel`, on a
    /// surface whose outward normal is `normal`.
    ///
    /// Rounded twice, at most 1 nm from exact in each axis. Where the normal is not known, feature
    /// fits take [`centre_nm`](Tip::centre_nm) instead and correct the feature by the radius.
    #[must_use]
    pub fn surface_nm(
        &self,
        position_nm: [i64; 3],
        travel: &UnitVector,
        normal: &UnitVector,
    ) -> [i64; 3] {
        minus(
            self.centre_nm(position_nm, travel),
            normal.scaled(i64::from(self.radius_nm)),
        )
    }

    /// The centre of the ball at the instant of contact, in nm: the latched position less the
    /// pre-travel.
    #[must_use]
    pub fn centre_nm(&self, position_nm: [i64; 3], travel: &UnitVector) -> [i64; 3] {
        minus(
            position_nm,
            travel.scaled(i64::from(self.pre_travel.along(travel))),
        )
    }

    /// The latched position that a surface point would give, in nm: the inverse of
    /// [`surface_nm`](Tip::surface_nm), for targets and for simulation.
    #[must_use]
    pub fn position_nm(
        &self,
        surface_nm: [i64; 3],
        travel: &UnitVector,
        normal: &UnitVector,
    ) -> [i64; 3] {
        let centre = plus(surface_nm, normal.scaled(i64::from(self.radius_nm)));
        plus(
            centre,
            travel.scaled(i64::from(self.pre_travel.along(travel))),
        )
    }

    /// How far before the surface a point is reported, along `travel`, when the normal is taken as
    /// opposite to the travel, in nm: the cosine error `r (1 / cos a - 1)`. The work piece seems
    /// larger by it. `None` where the travel does not go into the surface.
    ///
    /// 0.0038 r at 5 degrees, 0.0154 r at 10, 0.155 r at 30.
    #[must_use]
    pub fn cosine_error_nm(&self, travel: &UnitVector, normal: &UnitVector) -> Option<i64> {
        let cosine = i64::from(travel.reversed().cosine(normal).to_bits());
        if cosine <= 0 {
            return None;
        }
        // 2^31 x 2^30 at most, and half of a divisor of 2^30; halves away from zero in magnitude.
        let short = i64::from(1_i32 << 30).wrapping_sub(cosine);
        let error = u64::from(self.radius_nm.unsigned_abs())
            .wrapping_mul(short.unsigned_abs())
            .wrapping_add(cosine.unsigned_abs() >> 1)
            .checked_div(cosine.unsigned_abs())?
            .cast_signed();
        Some(if self.radius_nm < 0 {
            error.wrapping_neg()
        } else {
            error
        })
    }
}
