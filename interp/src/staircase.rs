//! Staircase arc: steps of one axis at a time.

use crate::counted::Counted;
use crate::lattice::Start;
use crate::method::interpolator;
use crate::quadrant::Quadrant;
use crate::{ArcError, ArcMove, Step};

/// A circular arc about a whole-step centre by single-axis steps, outward or inward.
///
/// There are two rules. Both are incremental: three additions and one sign test per event, no
/// multiplication. [`Staircase::new`] takes the step that ends nearer to the circle, by the sign of
/// 2 D + dU + dV (D = |P|^2 - R^2, dU and dV its changes by either step). [`Staircase::printed`]
/// uses D alone. No path of single-axis steps is better than the former: it must visit every
/// diagonal of the lattice, and those points are sqrt 2 apart.
///
/// Why it is within sqrt 2 / 2: the two candidate points are sqrt 2 apart. When one is a outside
/// the circle and the other b inside, a + b <= sqrt 2. The outer one is taken where the sum of both
/// D, an even number, is 0 or less: a (2 R + a) <= b (2 R - b), hence a < b. Otherwise that sum is
/// 2 or more, b (2 R - b) + 2 <= a (2 R + a), and then b < sqrt 2 / 2 as well. With both on one
/// side the nearer one is taken, and it is nearer than the point before. The printed rule steps
/// outward from D <= 0 and v < R to at most D <= 2 R - 1, or inward from D >= 1 and u <= R to D >=
/// 2 - 2 R: less than 1 BLU.
///
/// | | |
/// | --- | --- |
/// | error, integer R | `new`: less than 0.7071 BLU; `printed`: less than 1 BLU; the first point and the run-off to the last are rounded |
/// | events | the steps of both axes: 8 R for a full circle |
/// | speed ripple, equal times | 0.71 to 1 BLU per event along the curve, mean 0.785 (-10 / +27 %); single events anything from 0 to 1 |
/// | state | 64 bytes, words of 32 bits; radius up to 2^28 BLU |
/// | cost | 25 instructions per event on Cortex-M0, 19 on Cortex-M4F, 17 on RV32IMAC |
/// | source | Koren, reference-pulse circular interpolators, J. Eng. Ind. 103 (1981) 131; `printed`: micromill, annex A.5 |
///
/// Faults of the printed program: it computes D anew with three multiplications per event, starts
/// at (0, R) only and makes full circles only. Its text says that D = 0 may go either way, but
/// inward is then off by exactly 1 BLU and runs to the centre for R = 1. Here it goes outward. Ends
/// and directions are ours.
///
/// The sweep of an event is |P x step|, at least 1; `total_sweep / radius` is the length in BLU.
/// The rim is that of [`Rim`](crate::Rim); its `end` residue follows from the points and is
/// ignored.
#[derive(Clone, Debug)]
pub struct Staircase {
    counted: Counted<Walk>,
    radius: u32,
}

#[derive(Clone, Debug)]
struct Walk {
    point: Quadrant,
    /// D, or (2 D + dU + dV) / 2 = D - u + v + 1; a positive value steps inward.
    balance: i32,
    /// The change per step in addition to 2 u or 2 v: 1 for D, 2 for the other rule.
    bend: i32,
}

impl Staircase {
    /// Creates the minimax staircase, which stays within 0.7071 BLU.
    ///
    /// # Errors
    /// [`ArcError`]: `Centre` where the centre is not a whole step, `OffRim` where an end is more
    /// than about two BLU from the circle through (or about) the first.
    pub fn new(arc: &ArcMove) -> Result<Staircase, ArcError> {
        let start = Start::new(arc)?;
        let Quadrant { u, v, .. } = start.quadrant;
        // At most 4 (R + 1) + 2 R.
        let balance = start
            .residue
            .wrapping_sub(u)
            .wrapping_add(v)
            .wrapping_add(1);
        Staircase::with(start, balance, 2)
    }

    /// Creates the staircase of micromill A.5, which steps outward wherever D <= 0.
    ///
    /// # Errors
    /// As [`Staircase::new`].
    pub fn printed(arc: &ArcMove) -> Result<Staircase, ArcError> {
        let start = Start::new(arc)?;
        let balance = start.residue;
        Staircase::with(start, balance, 1)
    }

    fn with(start: Start, balance: i32, bend: i32) -> Result<Staircase, ArcError> {
        Ok(Staircase {
            counted: Counted::new(Walk {
                point: start.quadrant,
                balance,
                bend,
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

interpolator!(Staircase, counted);

impl Iterator for Walk {
    type Item = Step;

    #[inline]
    fn next(&mut self) -> Option<Step> {
        let point = &mut self.point;
        if point.is_level() {
            return point.straight(false);
        }
        let is_inward = self.balance > 0;
        let twice = if is_inward {
            point.u.wrapping_neg()
        } else {
            point.v
        };
        // |D| <= 4 (R + 1) at the start of the arc and at most 2 R later, so six times the radius
        // fits.
        self.balance = self
            .balance
            .wrapping_add(twice)
            .wrapping_add(twice)
            .wrapping_add(self.bend);
        let step = point.take(is_inward, !is_inward);
        if point.is_over() {
            // D is unchanged; D - u + v + 1 becomes D - v + 1.
            if self.bend == 2 {
                self.balance = self.balance.wrapping_sub(point.v).wrapping_sub(point.v);
            }
            point.turn();
        }
        Some(step)
    }
}
