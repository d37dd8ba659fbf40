//! Compensation: from the latched position to the surface point.

use crate::unit_vector::{minus, plus};
use crate::{PreTravel, UnitVector};

/// The properties of a probe: tip radius and pre-travel.
///
/// `M = p - ed d - r n`: measured point, latched position of the ball's centre, pre-travel along
/// the direction of travel `d`, radius along the outward normal `n` of the surface. (Equation 1.6
/// of the one-axis original is the case `d = -x`, `n = +x`.) Both signs follow from the two
/// directions, so oblique approaches need nothing more.
///
/// The compensation uses integers only and adds less than 1 nm to the error of the position.
///
/// # Examples
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
    /// Returns the point of contact, in nm, for the latched `position_nm` of an approach along
    /// `travel`. `normal` is the outward normal of the surface.
    ///
    /// The result is rounded twice and is at most 1 nm from exact in each axis. If the normal is
    /// not known, fit features to [`centre_nm`](Tip::centre_nm) and correct the feature by the
    /// radius.
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

    /// Returns the centre of the ball at the instant of contact, in nm: the latched position minus
    /// the pre-travel.
    #[must_use]
    pub fn centre_nm(&self, position_nm: [i64; 3], travel: &UnitVector) -> [i64; 3] {
        minus(
            position_nm,
            travel.scaled(i64::from(self.pre_travel.along(travel))),
        )
    }

    /// Returns the latched position for a surface point, in nm. This is the inverse of
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

    /// Returns the cosine error in nm, `r (1 / cos a - 1)`. It is the distance along `travel`
    /// between the reported point and the surface if the normal is assumed opposite to the travel.
    /// The work piece seems larger by it. Returns `None` if the travel does not go into the
    /// surface.
    ///
    /// It is 0.0038 r at 5 degrees, 0.0154 r at 10, 0.155 r at 30.
    #[must_use]
    pub fn cosine_error_nm(&self, travel: &UnitVector, normal: &UnitVector) -> Option<i64> {
        let cosine = i64::from(travel.reversed().cosine(normal).to_bits());
        if cosine <= 0 {
            return None;
        }
        // The product is at most 2^31 x 2^30, plus half of a divisor of 2^30. The magnitude is
        // rounded, halves away from zero.
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
