//! Direct-search arc with two sign tests per event.

use crate::interpolator::Totals;
use crate::lattice::Start;
use crate::method::{Method, interpolator};
use crate::quadrant::{Quadrant, Sides};
use crate::{ArcError, ArcMove, Step};

/// A circular arc about a whole-step centre with integer R^2. Each event goes to the nearest of the
/// three points ahead.
///
/// The three-way comparison of the original needs only two sign tests. With D = |P|^2 - R^2 the
/// three points ahead have D + dU < D + dU + dV < D + dV, where dU = 1 - 2 u < 0 and dV = 2 v +
/// 1 > 0. Let B = D + dU + dV, the middle value. Where B >= 0 the v-step cannot be nearest. The
/// u-step is then nearer than the diagonal when B + (D + dU) = 2 B - dV > 0, that is B > v. Where B
/// < 0 the v-step is nearer than the diagonal when 2 B - dU < 0, that is B + u <= 0. The parity of
/// dU, dV and of sums of two D is known, so there are no ties. The state is (B, u, v) alone.
///
/// Error: the two points compared are an outer and an inner one of the same row or column. They
/// differ by 2 y - 1 in D, where y is the coordinate of the outer one. This is odd, so the nearer
/// one has |D| <= y - 1 <= R - 1 for integer R; and sqrt(R^2 + R - 1) < R + 1/2, sqrt(R^2 -
/// R + 1) > R - 1/2.
///
/// | | |
/// | --- | --- |
/// | error | strictly less than 1/2 BLU; the first point and the run-off to the last are rounded (0.7071) |
/// | events | 4 round(sqrt 2 R) for a full circle: the fewest that this error allows, or 4 more |
/// | speed ripple, equal times | 1 to 1.414 BLU per event along the curve, mean 1.111 (-10 / +27 %) |
/// | speed ripple, times by sweep | about 1/R and a tick: [`TimedDirectSearch`](crate::TimedDirectSearch) |
/// | state | 64 bytes, words of 32 bits; radius up to 2^28 BLU |
/// | cost | 28 instructions per event on Cortex-M0, 26 on Cortex-M4F, 23 on RV32IMAC |
/// | source | direct search: Koren 1979, micromill A.6; two tests: our derivation; best points: McIlroy, ACM TOG 2 (1983) 259 |
///
/// The events are those of [`Arc`](crate::Arc) for the same [`ArcMove`]. This method accepts
/// whole-step centres only and is faster. The sweep of an event is |P x step|, and at least half
/// the radius as in `Arc`; `total_sweep / radius` is the length in BLU. The rim is that of
/// [`Rim`](crate::Rim); its `end` residue follows from the points and is ignored. Set-up walks the
/// arc once to count its events.
#[derive(Clone, Debug)]
pub struct DirectSearch {
    /// Ordinary events until the next careful one.
    free: u32,
    /// B: D after a diagonal step.
    balance: i32,
    u: i32,
    v: i32,
    sides: BothSides,
    ends: Ends,
    totals: Totals,
}

/// Sides of the u-step in the low half, of the v-step in the high half. One word is accessed faster
/// than two halves.
#[derive(Copy, Clone, Debug)]
struct BothSides(u32);

impl BothSides {
    const fn new(toward_u: Sides, toward_v: Sides) -> BothSides {
        BothSides(toward_u.bits() as u32 | (toward_v.bits() as u32) << 16)
    }

    const fn split(self) -> (Sides, Sides) {
        let toward_v = Sides::from_bits((self.0 >> 16) as u16);
        (Sides::from_bits(self.0 as u16), toward_v)
    }
}

/// State that only the careful events at the start and at the end need: their sweep may be too
/// small, and the last ones go straight to the end. In all but tiny arcs these are one or two
/// events.
#[derive(Clone, Debug)]
struct Ends {
    /// Careful events before the ordinary ones.
    before: u32,
    /// Ordinary events that follow them.
    waiting: u32,
    /// Events of the run-off.
    after: u32,
    u: i32,
    v: i32,
    /// R, rounded to the nearest integer.
    radius: u32,
    /// R^2 minus the square of `radius`.
    excess: i32,
}

impl Ends {
    /// A step that crosses the curve instead of following it takes the time of half a step.
    const fn least_sweep(&self) -> u32 {
        // At least 1 where the radius is 1.
        let half = self.radius / 2;
        if half == 0 { 1 } else { half }
    }

    const fn squared(&self) -> u64 {
        square(self.radius).wrapping_add_signed(self.excess as i64)
    }
}

/// Square of the radius, below 2^58.
const fn square(radius: u32) -> u64 {
    (radius as u64).wrapping_mul(radius as u64)
}

impl DirectSearch {
    /// Prepares an arc. Walks it once to count its events and to sum its sweep.
    ///
    /// # Errors
    /// [`ArcError`]: `Centre` where the centre is not a whole step, `OffRim` where an end is more
    /// than about two BLU from the circle through (or about) the first.
    pub fn new(arc: &ArcMove) -> Result<DirectSearch, ArcError> {
        let start = Start::new(arc)?;
        let Quadrant { u, v, .. } = start.quadrant;
        // |D| <= 4 (R + 1), and u and v <= R + 3. With R <= 2^28 that is at most six times R.
        let balance = start
            .residue
            .wrapping_sub(u)
            .wrapping_sub(u)
            .wrapping_add(v)
            .wrapping_add(v)
            .wrapping_add(2);
        let mut search = DirectSearch {
            free: 0,
            balance,
            u,
            v,
            sides: BothSides::new(start.quadrant.toward_u, start.quadrant.toward_v),
            ends: Ends {
                before: 0,
                waiting: 0,
                after: 0,
                u: start.quadrant.u_end,
                v: start.quadrant.v_end,
                radius: start.radius,
                // Rounded to nearest, so |R^2 - r^2| <= r.
                excess: start.squared.wrapping_sub(square(start.radius)) as i32,
            },
            totals: Totals::default(),
        };
        search.sort(start.quadrant.left)?;
        Ok(search)
    }

    /// Walks a copy to the end, `quadrants` away, and classifies the events.
    fn sort(&mut self, mut quadrants: u32) -> Result<(), ArcError> {
        let mut dry = self.clone();
        let (mut events, mut before) = (0_u32, 0_u32);
        let mut totals = Totals::default();
        let mut sum = |sweep: u32| {
            totals.total_sweep = totals.total_sweep.wrapping_add(sweep.into());
            totals.largest_sweep = totals.largest_sweep.max(sweep);
        };
        while quadrants != 0 || (dry.u > self.ends.u && dry.v < self.ends.v) {
            if events > 1 << 31 {
                return Err(ArcError::TooLong);
            }
            events = events.wrapping_add(1);
            let (Step { sweep, .. }, ()) = dry.ordinary(&mut ());
            if dry.u == 0 {
                quadrants = quadrants.wrapping_sub(1);
                dry.turn();
            }
            if sweep < self.ends.least_sweep() {
                before = events;
            }
            sum(sweep.max(self.ends.least_sweep()));
        }
        // The run-off has only a few steps; its sweeps are summed one by one.
        while let Some(step) = dry.straight() {
            self.ends.after = self.ends.after.wrapping_add(1);
            sum(step.sweep);
        }
        totals.events = events.wrapping_add(self.ends.after);
        self.totals = totals;
        self.ends.before = before;
        let ordinary = events.wrapping_sub(before);
        if before == 0 {
            self.free = ordinary;
        } else {
            self.ends.waiting = ordinary;
        }
        Ok(())
    }

    /// Number of events of the whole arc.
    pub const fn events(&self) -> u32 {
        self.totals.events
    }

    /// Radius rounded to the nearest BLU: `total_sweep / radius` is the length of the arc.
    pub const fn radius(&self) -> u32 {
        self.ends.radius
    }

    /// u and v.
    pub(crate) const fn coordinates(&self) -> [u32; 2] {
        // Neither is negative where an event may follow.
        [self.u as u32, self.v as u32]
    }

    /// R^2.
    pub(crate) const fn squared(&self) -> u64 {
        self.ends.squared()
    }

    /// The next event if it is an ordinary one, as nearly all are. Otherwise
    /// [`DirectSearch::careful`] makes it.
    #[inline(always)]
    pub(crate) fn ordinary_next<A: Along>(&mut self, along: &mut A) -> Option<(Step, A::Time)> {
        if self.free == 0 || self.u == 0 {
            return None;
        }
        self.free = self.free.wrapping_sub(1);
        Some(self.ordinary(along))
    }

    /// Steps to the nearest of the three points ahead and notifies `along`.
    #[inline(always)]
    fn ordinary<A: Along>(&mut self, along: &mut A) -> (Step, A::Time) {
        let (u, v, balance) = (self.u, self.v, self.balance);
        // All sums stay within six times R, see `new`; on the circle they stay within three times
        // R. u > 0 and v >= 0.
        let (sides, sweep, time) = if balance > v {
            self.u = u.wrapping_sub(1);
            self.balance = balance.wrapping_sub(twice(u)).wrapping_add(3);
            (self.sides.0, v, along.u_step())
        } else if balance.wrapping_add(u) <= 0 {
            self.v = v.wrapping_add(1);
            self.balance = balance.wrapping_add(twice(v)).wrapping_add(3);
            (self.sides.0 >> 16, u, along.v_step())
        } else {
            self.u = u.wrapping_sub(1);
            self.v = v.wrapping_add(1);
            // dU and dV have grown by 2 each.
            let change = twice(v.wrapping_sub(u)).wrapping_add(6);
            self.balance = balance.wrapping_add(change);
            let sides = self.sides.0 | (self.sides.0 >> 16);
            (sides, u.wrapping_add(v), along.diagonal())
        };
        (Sides::from_bits(sides as u16).step(sweep as u32), time)
    }

    /// Goes on to the next quadrant. B = D + 2 v + 2 becomes D - 2 v + 2.
    fn turn(&mut self) {
        self.balance = self.balance.wrapping_sub(twice(twice(self.v)));
        (self.u, self.v) = (self.v, 0);
        let (toward_u, toward_v) = self.sides.split();
        self.sides = BothSides::new(toward_v.opposite(), toward_u);
    }

    /// Makes an event that may be the first of a quadrant or not ordinary; `None` at the end.
    #[cold]
    pub(crate) fn careful(&mut self, along: &mut impl Along) -> Option<Step> {
        if self.u == 0 {
            along.turn();
            self.turn();
        }
        if let Some(free) = self.free.checked_sub(1) {
            self.free = free;
            return Some(self.ordinary(along).0);
        }
        if let Some(before) = self.ends.before.checked_sub(1) {
            self.ends.before = before;
            if before == 0 {
                (self.free, self.ends.waiting) = (self.ends.waiting, 0);
            }
            let (step, _) = self.ordinary(along);
            let sweep = step.sweep.max(self.ends.least_sweep());
            return Some(Step { sweep, ..step });
        }
        self.ends.after = self.ends.after.checked_sub(1)?;
        self.straight()
    }

    /// Makes one step straight to the end; `None` at the end.
    fn straight(&mut self) -> Option<Step> {
        let (toward_u, toward_v) = self.sides.split();
        let mut point = Quadrant {
            u: self.u,
            v: self.v,
            u_end: self.ends.u,
            v_end: self.ends.v,
            left: 0,
            toward_u,
            toward_v,
        };
        let step = point.straight(true)?;
        (self.u, self.v) = (point.u, point.v);
        let sweep = step.sweep.max(self.ends.least_sweep());
        Some(Step { sweep, ..step })
    }
}

#[inline]
const fn twice(value: i32) -> i32 {
    value.wrapping_add(value)
}

/// An observer that accompanies the point. It is notified of every step and of each turn to the
/// next quadrant.
pub(crate) trait Along {
    /// Result for the sweep of a step.
    type Time;
    fn u_step(&mut self) -> Self::Time;
    fn v_step(&mut self) -> Self::Time;
    fn diagonal(&mut self) -> Self::Time;
    fn turn(&mut self);
}

/// The observer that does nothing.
impl Along for () {
    type Time = ();
    #[inline(always)]
    fn u_step(&mut self) {}
    #[inline(always)]
    fn v_step(&mut self) {}
    #[inline(always)]
    fn diagonal(&mut self) {}
    #[inline(always)]
    fn turn(&mut self) {}
}

impl Method for DirectSearch {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        match self.ordinary_next(&mut ()) {
            Some((step, ())) => Some(step),
            None => self.careful(&mut ()),
        }
    }

    #[inline]
    fn left(&self) -> u32 {
        // The sum is the number of events left, at most 2^31 and a few.
        self.free
            .wrapping_add(self.ends.before)
            .wrapping_add(self.ends.waiting)
            .wrapping_add(self.ends.after)
    }

    #[inline]
    fn totals(&self) -> Totals {
        self.totals
    }
}

interpolator!(DirectSearch);
