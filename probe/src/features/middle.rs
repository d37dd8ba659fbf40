//! Between two touches.

use crate::UnitVector;
use crate::unit_vector::{minus, plus};

/// The middle and the width of a web or a pocket, of two opposite points.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Middle {
    /// Halfway between the points, in nm, halves towards the first.
    pub centre_nm: [i64; 3],
    /// Their distance along the direction asked for, without sign, in nm.
    pub width_nm: i64,
}

impl Middle {
    /// The middle of two points and their distance along `direction`; up to 2.1 m apart.
    ///
    /// Two pairs of touches, the second along the line found by the first, give the centre of a
    /// bore or boss: what pairs off the diameter leave is within [`Circle`](super::Circle)'s
    /// residuals. Integers only.
    #[must_use]
    pub fn of(a: [i64; 3], b: [i64; 3], direction: &UnitVector) -> Middle {
        let way = minus(b, a);
        Middle {
            // Halves towards zero, by a shift of the magnitude.
            centre_nm: plus(
                a,
                way.map(|w| {
                    (w.unsigned_abs() >> 1)
                        .cast_signed()
                        .wrapping_mul(w.signum())
                }),
            ),
            width_nm: direction.length_along(way).saturating_abs(),
        }
    }
}
