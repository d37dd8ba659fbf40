//! State of an arc in progress: a few words, without position and without multiplication.
//!
//! In the current quadrant the point is (u, v) from the centre, with u falling and v growing, both
//! in 2^-f BLU. F = (u^2 + v^2 - rho^2) / 2^f measures the distance from the circle. The state
//! holds F and its first differences:
//!
//! ```text
//!         v                 du = -2u + s   change of F by a u-step (towards the v axis)
//!         |  .  .           dv =  2v + s   change of F by a v-step
//!         |        .        s  =  2^f      one BLU
//!         |         .
//!         +---------+-- u   the quadrant ends when du >= 0, that is u <= 1/2 BLU
//! ```

use crate::{Run, Step, interpolator::Totals};

/// A signed machine word for the state: `i32` where it fits, `i64` otherwise.
///
/// All operations wrap; `Arc::new` chooses the word so that no overflow occurs.
pub(crate) trait Word: Copy + Ord + core::fmt::Debug {
    const ZERO: Self;
    const MAX: Self;
    fn narrow(value: i64) -> Self;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn half(self) -> Self;
    /// The exponent of a power of two.
    fn exponent(self) -> u8;
    /// A positive sweep below 2^32 after the shift; a narrow state needs no shift.
    fn sweep(self, shift: u8) -> u32;
}

impl Word for i32 {
    const ZERO: i32 = 0;
    const MAX: i32 = i32::MAX;
    #[inline]
    fn narrow(value: i64) -> i32 {
        value as i32
    }
    #[inline]
    fn plus(self, other: i32) -> i32 {
        self.wrapping_add(other)
    }
    #[inline]
    fn minus(self, other: i32) -> i32 {
        self.wrapping_sub(other)
    }
    #[inline]
    fn half(self) -> i32 {
        self >> 1
    }
    #[inline]
    fn exponent(self) -> u8 {
        self.trailing_zeros() as u8
    }
    #[inline]
    fn sweep(self, _shift: u8) -> u32 {
        self as u32
    }
}

impl Word for i64 {
    const ZERO: i64 = 0;
    const MAX: i64 = i64::MAX;
    #[inline]
    fn narrow(value: i64) -> i64 {
        value
    }
    #[inline]
    fn plus(self, other: i64) -> i64 {
        self.wrapping_add(other)
    }
    #[inline]
    fn minus(self, other: i64) -> i64 {
        self.wrapping_sub(other)
    }
    #[inline]
    fn half(self) -> i64 {
        self >> 1
    }
    #[inline]
    fn exponent(self) -> u8 {
        self.trailing_zeros() as u8
    }
    #[inline]
    fn sweep(self, shift: u8) -> u32 {
        self.wrapping_shr(shift.into()) as u32
    }
}

/// The start state, computed by `Arc::new`; everything is in 2^-f BLU or BLU^2.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Start {
    pub(crate) residue: i64,
    pub(crate) du: i64,
    pub(crate) dv: i64,
    pub(crate) du_end: i64,
    pub(crate) dv_end: i64,
    pub(crate) one: i64,
    pub(crate) quadrants: u32,
    pub(crate) toward_u: Toward,
    pub(crate) toward_v: Toward,
    pub(crate) spread: Spread,
    pub(crate) quotient: i64,
    pub(crate) least_sweep: i64,
    pub(crate) sweep_shift: u8,
}

/// The change of radius, spread over the first `left` steps: the quotient per step, and 1 more
/// whenever the remainders add up to `steps`.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Spread {
    pub(crate) left: u32,
    pub(crate) steps: u32,
    pub(crate) remainder: u32,
    pub(crate) phase: u32,
}

/// A step of one or two axes: the axes in the low byte, those that step backwards in the high byte.
/// Steps are joined by `|` in one word.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub(crate) struct Toward(u16);

impl Toward {
    const NOWHERE: Toward = Toward(0);

    /// One step of an axis below 8.
    pub(crate) const fn new(axis: u32, is_negative: bool) -> Toward {
        let bit = 1_u16.wrapping_shl(axis);
        Toward(if is_negative { bit | (bit << 8) } else { bit })
    }

    #[inline]
    const fn opposite(self) -> Toward {
        Toward(self.0 ^ (self.0 << 8))
    }

    #[inline]
    const fn and(self, other: Toward) -> Toward {
        Toward(self.0 | other.0)
    }

    #[inline]
    const fn step(self, sweep: u32) -> Step {
        let [axes, negative] = self.0.to_le_bytes();
        Step {
            axes,
            negative,
            sweep,
        }
    }
}

/// The walking state in words of one width: 64 bytes with words of 32 bits.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Walk<W> {
    residue: W,
    du: W,
    dv: W,
    /// Limit of `du` at which something other than a step is due: the end of the quadrant, or in
    /// the last quadrant the end of the arc.
    du_limit: W,
    dv_limit: W,
    one: W,
    least_sweep: W,
    toward_u: Toward,
    toward_v: Toward,
    sweep_shift: u8,
    quadrants: u32,
    du_end: W,
    dv_end: W,
    quotient: W,
    spread: Spread,
}

#[derive(Copy, Clone, PartialEq, Eq, Debug)]
enum Way {
    U,
    V,
    Both,
}

/// The step to the point nearest to the circle, the F after it, and its sweep.
#[inline(always)]
fn nearest<W: Word>(residue: W, du: W, dv: W, one: W) -> (Way, W, W) {
    let after_u = residue.plus(du);
    let after_v = residue.plus(dv);
    let after_both = after_u.plus(dv);
    // |F| is least at cos^2/2 off the radial middle; with f = 0 parity excludes ties.
    let bias = one.half();
    // In the quadrant du < 0 <= dv, so after_u < after_both <= after_v, and the sign of after_both
    // leaves two candidates. They are compared by differences, which fit where the three values
    // fit. Branches are used because an octant repeats itself: masks take a third more on a
    // Cortex-M and a seventh more on a desktop.
    let is_outside = after_both >= W::ZERO;
    let along_u = dv.minus(one).half();
    let along_v = one.minus(du).half();
    if is_outside & (after_both > bias.minus(after_u)) {
        (Way::U, after_u, along_u)
    } else if !is_outside & (after_both < bias.minus(after_v)) {
        (Way::V, after_v, along_v)
    } else {
        (Way::Both, after_both, along_u.plus(along_v))
    }
}

impl<W: Word> Walk<W> {
    pub(crate) fn new(start: &Start) -> Self {
        Walk {
            residue: W::narrow(start.residue),
            du: W::narrow(start.du),
            dv: W::narrow(start.dv),
            du_limit: W::ZERO,
            dv_limit: W::MAX,
            one: W::narrow(start.one),
            least_sweep: W::narrow(start.least_sweep),
            toward_u: start.toward_u,
            toward_v: start.toward_v,
            sweep_shift: start.sweep_shift,
            quadrants: start.quadrants,
            du_end: W::narrow(start.du_end),
            dv_end: W::narrow(start.dv_end),
            quotient: W::narrow(start.quotient),
            spread: start.spread,
        }
        .limited()
    }

    /// Sets the limits of the present quadrant.
    fn limited(mut self) -> Self {
        if self.quadrants == 0 {
            (self.du_limit, self.dv_limit) = (self.du_end, self.dv_end);
        }
        self
    }

    /// Quadrant changes still to come.
    pub(crate) fn quadrants(&self) -> u32 {
        // A change is made when the next step is requested.
        let is_pending = self.quadrants != 0 && self.du >= W::ZERO;
        self.quadrants.wrapping_sub(is_pending.into())
    }

    /// Number of fraction bits of the sweep in BLU.
    pub(crate) fn sweep_bits(&self) -> i8 {
        // f <= 30 and shift <= 16: fits.
        (self.one.exponent() as i8).wrapping_sub(self.sweep_shift as i8)
    }

    /// Sums over all its steps; `None` when there are more than 2^31. Takes slightly more than half
    /// the instructions of walking them.
    pub(crate) fn totals(mut self) -> Option<Totals> {
        let mut totals = Totals::default();
        loop {
            // As in `next`.
            if self.is_at_limit() {
                if self.quadrants != 0 {
                    self.turn();
                }
                if self.quadrants == 0 && self.is_at_limit() {
                    let (toward, sweep) = self.run_off();
                    if toward == Toward::NOWHERE {
                        return Some(totals);
                    }
                    totals.add(self.step(toward, sweep).sweep);
                    continue;
                }
            }
            self.sum_up(&mut totals);
            // A quadrant has fewer than 2^31 events.
            if totals.events > 1 << 31 {
                return None;
            }
        }
    }

    /// Adds this step and the following ones up to the limit of the quadrant.
    fn sum_up(&mut self, totals: &mut Totals) {
        // Without the rest of the state these fit in registers.
        let (mut residue, mut du, mut dv, mut sum) = (self.residue, self.du, self.dv, *totals);
        let (du_limit, dv_limit) = (self.du_limit, self.dv_limit);
        let two = self.one.plus(self.one);
        loop {
            if self.spread.left != 0 {
                residue = residue.minus(self.change_of_radius());
            }
            let (way, after, sweep) = nearest(residue, du, dv, self.one);
            residue = after;
            if way != Way::V {
                du = du.plus(two);
            }
            if way != Way::U {
                dv = dv.plus(two);
            }
            sum.add(sweep.max(self.least_sweep).sweep(self.sweep_shift));
            if (du >= du_limit) | (dv >= dv_limit) {
                break;
            }
        }
        (self.residue, self.du, self.dv, *totals) = (residue, du, dv, sum);
    }

    /// The axes of the next events, as a mask, and those of them that step backwards. They hold up
    /// to the end of the quadrant. `None` where an event does not go to the nearest point.
    pub(crate) fn directions(&mut self) -> Option<[u8; 2]> {
        if self.is_at_limit() {
            if self.quadrants == 0 {
                return None;
            }
            // As in `next`. A circle of a step or two may be at the next limit at once.
            let mut turned = *self;
            turned.turn();
            if turned.is_at_limit() {
                return None;
            }
            *self = turned;
        }
        Some(self.toward_u.and(self.toward_v).0.to_le_bytes())
    }

    /// Writes the sweeps and the steps of the events for which [`directions`](Self::directions)
    /// holds. Ends after the event that goes beyond `room`. `each` may add steps of other axes.
    #[inline(always)]
    pub(crate) fn fill<'a, const N: usize>(
        &mut self,
        places: impl Iterator<Item = (&'a mut u32, &'a mut [i8; N])>,
        mut room: u32,
        mut each: impl FnMut(u32, &mut [i8; N]),
    ) -> Run<N> {
        let mut run = Run::NONE;
        if self.directions().is_none() {
            return run;
        }
        // Without the rest of the state these fit in registers.
        let (mut residue, mut du, mut dv) = (self.residue, self.du, self.dv);
        let (du_limit, dv_limit) = (self.du_limit, self.dv_limit);
        let (one, two) = (self.one, self.one.plus(self.one));
        let [toward_u, toward_v] = [self.toward_u, self.toward_v];
        let deltas = |toward: Toward| toward.step(1).deltas::<N>();
        let (along_u, along_v) = (deltas(toward_u), deltas(toward_v));
        let along_both = deltas(toward_u.and(toward_v));
        let (mut events, mut steps_u, mut steps_v) = (0_u32, 0_u32, 0_u32);
        for (place, delta) in places {
            if self.spread.left != 0 {
                residue = residue.minus(self.change_of_radius());
            }
            let (way, after, sweep) = nearest(residue, du, dv, one);
            residue = after;
            events = events.wrapping_add(1);
            match way {
                Way::U => {
                    du = du.plus(two);
                    steps_u = steps_u.wrapping_add(1);
                    *delta = along_u;
                }
                Way::V => {
                    dv = dv.plus(two);
                    steps_v = steps_v.wrapping_add(1);
                    *delta = along_v;
                }
                Way::Both => {
                    du = du.plus(two);
                    dv = dv.plus(two);
                    steps_u = steps_u.wrapping_add(1);
                    steps_v = steps_v.wrapping_add(1);
                    *delta = along_both;
                }
            }
            let sweep = sweep.max(self.least_sweep).sweep(self.sweep_shift);
            *place = sweep;
            each(sweep, delta);
            match room.checked_sub(sweep) {
                Some(rest) => room = rest,
                None => {
                    run.is_beyond = true;
                    break;
                }
            }
            if (du >= du_limit) | (dv >= dv_limit) {
                break;
            }
        }
        (self.residue, self.du, self.dv) = (residue, du, dv);
        run.events = events;
        for (steps, (u, v)) in run.steps.iter_mut().zip(along_u.iter().zip(along_v)) {
            if *u != 0 {
                *steps = steps_u;
            }
            if v != 0 {
                *steps = steps_v;
            }
        }
        run
    }

    /// Whether something other than a step to the nearest point may be due.
    #[inline(always)]
    fn is_at_limit(&self) -> bool {
        (self.du >= self.du_limit) | (self.dv >= self.dv_limit)
    }

    /// Goes on to the next quadrant.
    #[cold]
    fn turn(&mut self) {
        let two = self.one.plus(self.one);
        (self.du, self.dv) = (two.minus(self.dv), self.du);
        (self.toward_u, self.toward_v) = (self.toward_v.opposite(), self.toward_u);
        self.quadrants = self.quadrants.wrapping_sub(1);
        *self = self.limited();
    }

    /// Goes straight to the end once the walk is level with it in one axis (or past it). The end is
    /// a rounded point, so this takes a step or two. At the end there is no step.
    #[cold]
    fn run_off(&mut self) -> (Toward, W) {
        let along_u = self.dv.minus(self.one).half();
        let along_v = self.one.minus(self.du).half();
        let two = self.one.plus(self.one);
        let (mut toward, mut sweep) = (Toward::NOWHERE, W::ZERO);
        if self.du < self.du_end {
            self.du = self.du.plus(two);
            (toward, sweep) = (toward.and(self.toward_u), sweep.plus(along_u));
        } else if self.du > self.du_end {
            self.du = self.du.minus(two);
            (toward, sweep) = (toward.and(self.toward_u.opposite()), sweep.minus(along_u));
        }
        if self.dv < self.dv_end {
            self.dv = self.dv.plus(two);
            (toward, sweep) = (toward.and(self.toward_v), sweep.plus(along_v));
        } else if self.dv > self.dv_end {
            self.dv = self.dv.minus(two);
            (toward, sweep) = (toward.and(self.toward_v.opposite()), sweep.minus(along_v));
        }
        (toward, sweep)
    }

    #[inline(always)]
    fn step(&self, toward: Toward, sweep: W) -> Step {
        toward.step(sweep.max(self.least_sweep).sweep(self.sweep_shift))
    }

    /// Change of F with the next step because of the change of radius.
    #[inline]
    fn change_of_radius(&mut self) -> W {
        let spread = &mut self.spread;
        spread.left = spread.left.wrapping_sub(1);
        // phase and remainder are below steps <= 2^31, so the sum fits.
        spread.phase = spread.phase.wrapping_add(spread.remainder);
        if spread.phase < spread.steps {
            return self.quotient;
        }
        spread.phase = spread.phase.wrapping_sub(spread.steps);
        self.quotient.plus(W::narrow(1))
    }
}

impl<W: Word> Iterator for Walk<W> {
    type Item = Step;

    #[inline(always)]
    fn next(&mut self) -> Option<Step> {
        if self.is_at_limit() {
            if self.quadrants != 0 {
                self.turn();
            }
            if self.quadrants == 0 && self.is_at_limit() {
                let (toward, sweep) = self.run_off();
                return (toward != Toward::NOWHERE).then(|| self.step(toward, sweep));
            }
        }
        if self.spread.left != 0 {
            self.residue = self.residue.minus(self.change_of_radius());
        }
        let (way, residue, sweep) = nearest(self.residue, self.du, self.dv, self.one);
        let two = self.one.plus(self.one);
        self.residue = residue;
        let toward = match way {
            Way::U => {
                self.du = self.du.plus(two);
                self.toward_u
            }
            Way::V => {
                self.dv = self.dv.plus(two);
                self.toward_v
            }
            Way::Both => {
                self.du = self.du.plus(two);
                self.dv = self.dv.plus(two);
                self.toward_u.and(self.toward_v)
            }
        };
        Some(self.step(toward, sweep))
    }
}
