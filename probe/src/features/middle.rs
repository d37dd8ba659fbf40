//! Middle of two touches.

use crate::UnitVector;
use crate::unit_vector::{minus, plus};

/// Middle and width of a web or a pocket, from two opposite points.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Middle {
    /// The point halfway between the points, in nm; halves are rounded towards the first point.
    pub centre_nm: [i64; 3],
    /// The unsigned distance of the points along the given direction, in nm.
    pub width_nm: i64,
}

impl Middle {
    /// Returns the middle of two points up to 2.1 m apart and their distance along `direction`.
    ///
    /// Two pairs of touches give the centre of a bore or boss: touch the second pair along the line
    /// found by the first. The error of pairs off the diameter is within the residuals of
    /// [`Circle`](super::Circle). Integers only.
    #[must_use]
    pub fn of(a: [i64; 3], b: [i64; 3], direction: &UnitVector) -> Middle {
        let displacement = minus(b, a);
        Middle {
            // A shift of the magnitude rounds halves towards zero.
            centre_nm: plus(
                a,
                displacement.map(|w| {
                    (w.unsigned_abs() >> 1)
                        .cast_signed()
                        .wrapping_mul(w.signum())
                }),
            ),
            width_nm: direction.length_along(displacement).saturating_abs(),
        }
    }
}
