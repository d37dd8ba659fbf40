//! The staircase arc: one axis at a time.

use core::iter::FusedIterator;

use crate::counted::Counted;
use crate::lattice::Start;
use crate::quadrant::Quadrant;
use crate::{ArcError, ArcMove, Interpolator, Step};

/// A circular arc about a whole-step centre by single-axis steps, outward or inward.
///
/// Two rules, both incremental: two additions and one sign test an event, no multiplication.
/// [`Staircase::new`] takes the step that ends nearer to the circle, by the sign of
/// 2 D + dX + dY (D = |P|^2 - R^2, dX and dY its changes by either step);
/// [`Staircase::printed`] looks at D alone. The path with single-axis steps cannot be better than
/// the former: it must visit every diagonal of the lattice, and those points are sqrt 2 apart.
///
/// | | |
/// | --- | --- |
/// | error, integer R | `new`: less than 0.7071 BLU; `printed`: less than 1 BLU; first point and run-off to the last: their rounding |
/// | events | the steps of both axes: 8 R for a full circle |
/// | speed ripple, equal times | 0.71 to 1 of the rate along the curve, mean 0.785 (-10 / +27 %), from one event to the next all between 0 and 1 |
/// | state | 64 bytes, words of 32 bits; radius up to 2^28 BLU |
/// | cost | 49 instructions an event on Cortex-M0, 38 on Cortex-M4F |
/// | source | Koren, reference-pulse circular interpolators, J. Eng. Ind. 103 (1981) 131; `printed`: micromill, annex A.5 |
///
/// What the printed program gets wrong: it works D out anew with three multiplications an event,
/// starts at (0, R) only and makes full circles only; its text says that D = 0 may go either way, but inward
/// is off by exactly 1 BLU then and runs to the centre for R = 1. Here it goes outward. Ends and
/// directions are ours.
///
/// The sweep of an event is |P x step|, at least 1; `total_sweep / radius` is the length in BLU. The
/// rim is that of [`Rim`](crate::Rim), whose `end` residue follows from the points and is not looked at.
#[derive(Clone, Debug)]
pub struct Staircase {
    walk: Counted<Walk>,
    radius: u32,
}

#[derive(Clone, Debug)]
struct Walk {
    point: Quadrant,
    /// D, or (2 D + dU + dV) / 2 = D - u + v + 1: inward where positive.
    balance: i32,
    /// What a step changes it by, besides 2 u or 2 v: 1 for D, 2 for the other.
    bend: i32,
}

impl Staircase {
    /// The minimax staircase: never 0.7071 BLU away.
    ///
    /// # Errors
    /// [`ArcError`]; `FractionBits` where the centre is no whole step, `OffRim` where an end is more
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

    /// The staircase of micromill A.5: outward wherever D <= 0.
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
            walk: Counted::new(Walk {
                point: start.quadrant,
                balance,
                bend,
            })?,
            radius: start.radius,
        })
    }

    /// Events of the whole arc.
    pub const fn events(&self) -> u32 {
        self.walk.totals.events
    }

    /// Radius to the nearest BLU: `total_sweep / radius` is the arc's length.
    pub const fn radius(&self) -> u32 {
        self.radius
    }
}

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
        // |D| <= 4 (R + 1) where the arc begins and at most 2 R later: six times the radius fits.
        self.balance = self
            .balance
            .wrapping_add(twice)
            .wrapping_add(twice)
            .wrapping_add(self.bend);
        let step = point.take(is_inward, !is_inward);
        if point.is_over() {
            // D stays; D - u + v + 1 becomes D - v + 1.
            if self.bend == 2 {
                self.balance = self.balance.wrapping_sub(point.v).wrapping_sub(point.v);
            }
            point.turn();
        }
        Some(step)
    }
}

impl Iterator for Staircase {
    type Item = Step;

    #[inline]
    fn next(&mut self) -> Option<Step> {
        self.walk.next()
    }

    #[inline]
    fn size_hint(&self) -> (usize, Option<usize>) {
        self.walk.size_hint()
    }
}

impl ExactSizeIterator for Staircase {}
impl FusedIterator for Staircase {}

impl Interpolator for Staircase {
    #[inline]
    fn remaining(&self) -> u32 {
        self.walk.left()
    }

    fn total_sweep(&self) -> u64 {
        self.walk.totals.total_sweep
    }

    fn largest_sweep(&self) -> u32 {
        self.walk.totals.largest_sweep
    }
}
