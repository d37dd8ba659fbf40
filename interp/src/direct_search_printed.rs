//! Direct-search arc in its original form.

use crate::counted::Counted;
use crate::interpolator::Totals;
use crate::lattice::Start;
use crate::method::{Method, interpolator};
use crate::quadrant::Quadrant;
use crate::{ArcError, ArcMove, Step};

/// A circular arc about a whole-step centre. Each event goes to the point with the least |D| among
/// the three points ahead, D = |P|^2 - R^2, found by comparing all three.
///
/// The steps are those of [`DirectSearch`](crate::DirectSearch), which needs half the comparisons.
///
/// | | |
/// | --- | --- |
/// | error, integer R^2 | strictly less than 1/2 BLU; the first point and the run-off to the last are rounded |
/// | events | 4 round(sqrt 2 R) for a full circle |
/// | speed ripple, equal times | 1 to 1.414 BLU per event along the curve, mean 1.111 (-10 / +27 %) |
/// | state | 56 bytes, words of 32 bits; radius up to 2^28 BLU |
/// | cost | 57 instructions per event on Cortex-M0, 38 on Cortex-M4F, 33 on RV32IMAC |
/// | source | Koren 1979; micromill, annex A.6 |
///
/// The printed program lacks the test of the quadrant, the first D, the reload of dX and dY (only
/// one of them changes at the border of a quadrant), and any end test. With the obvious test for
/// the end point, half of all arcs with a rounded end miss it and never stop. These parts are ours:
/// an arc ends exactly.
///
/// The sweep of an event is |P x step|, at least 1; `total_sweep / radius` is the length in BLU.
/// The rim is that of [`Rim`](crate::Rim); its `end` residue follows from the points and is
/// ignored.
#[derive(Clone, Debug)]
pub struct DirectSearchPrinted {
    counted: Counted<Walk>,
    radius: u32,
}

#[derive(Clone, Debug)]
struct Walk {
    point: Quadrant,
    residue: i32,
}

impl DirectSearchPrinted {
    /// Prepares an arc. Walks it once to count its events.
    ///
    /// # Errors
    /// [`ArcError`]: `Centre` where the centre is not a whole step, `OffRim` where an end is more
    /// than about two BLU from the circle through (or about) the first.
    pub fn new(arc: &ArcMove) -> Result<DirectSearchPrinted, ArcError> {
        let start = Start::new(arc)?;
        Ok(DirectSearchPrinted {
            counted: Counted::new(Walk {
                point: start.quadrant,
                residue: start.residue,
            })
            .ok_or(ArcError::TooLong)?,
            radius: start.radius,
        })
    }

    /// Number of events of the whole arc.
    pub const fn events(&self) -> u32 {
        self.counted.events()
    }

    /// Radius rounded to the nearest BLU: `total_sweep / radius` is the length of the arc.
    pub const fn radius(&self) -> u32 {
        self.radius
    }
}

impl Method for DirectSearchPrinted {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        // The walk detects its end itself. With the count checked first, compilers for small
        // processors keep its state in registers, which saves 27 instructions per event.
        if self.counted.left() == 0 {
            return None;
        }
        self.counted.next_step()
    }

    #[inline]
    fn left(&self) -> u32 {
        self.counted.left()
    }

    #[inline]
    fn totals(&self) -> Totals {
        self.counted.totals()
    }
}

interpolator!(DirectSearchPrinted);

impl Iterator for Walk {
    type Item = Step;

    #[inline]
    fn next(&mut self) -> Option<Step> {
        let point = &mut self.point;
        if point.is_level() {
            return point.straight(true);
        }
        let twice = |value: i32| value.wrapping_add(value);
        // u and v are at most R + 3, and |D| is at most 4 (R + 1) at the start of the arc: six
        // times R = 2^28 fits.
        let after_u = self.residue.wrapping_add(1).wrapping_sub(twice(point.u));
        let change_v = twice(point.v).wrapping_add(1);
        let after_v = self.residue.wrapping_add(change_v);
        let after_both = after_u.wrapping_add(change_v);
        let (one_u, one_v) = (after_u.unsigned_abs(), after_v.unsigned_abs());
        let both = after_both.unsigned_abs();
        let (takes_u, takes_v) = if both <= one_u && both <= one_v {
            self.residue = after_both;
            (true, true)
        } else if one_u < one_v {
            self.residue = after_u;
            (true, false)
        } else {
            self.residue = after_v;
            (false, true)
        };
        let step = point.take(takes_u, takes_v);
        if point.is_over() {
            point.turn();
        }
        Some(step)
    }
}
