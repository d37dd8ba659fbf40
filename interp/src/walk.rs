//! The state of an arc that is walked: a handful of words, no position, no multiplication.
//!
//! In the current quadrant the point is (u, v) from the centre, u falling and v growing, both in
//! 2^-f BLU. F = (u^2 + v^2 - rho^2) / 2^f is the distance from the circle; the state holds F itself
//! and its first differences:
//!
//! ```text
//!         v                     du = -2u + s   F changes by this with a u-step (towards the v axis)
//!         |  .  .               dv =  2v + s   F changes by this with a v-step
//!         |        .            s  =  2^f      one BLU
//!         |         .
//!         +---------+-- u       quadrant ends when du >= 0, that is u <= 1/2 BLU
//! ```

use crate::Step;

/// A signed machine word the state is kept in: `i32` where it fits, `i64` otherwise.
///
/// All operations wrap; `Arc::new` chooses the word so that they do not.
pub(crate) trait Word: Copy + Ord + core::fmt::Debug {
    const ZERO: Self;
    fn narrow(value: i64) -> Self;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn half(self) -> Self;
    /// `self` where `condition` holds, otherwise 0; without a branch.
    fn only_if(self, condition: bool) -> Self;
    fn unsigned(self) -> u64;
}

impl Word for i32 {
    const ZERO: i32 = 0;
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
    fn only_if(self, condition: bool) -> i32 {
        self & i32::from(condition).wrapping_neg()
    }
    #[inline]
    fn unsigned(self) -> u64 {
        u64::from(self as u32)
    }
}

impl Word for i64 {
    const ZERO: i64 = 0;
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
    fn only_if(self, condition: bool) -> i64 {
        self & i64::from(condition).wrapping_neg()
    }
    #[inline]
    fn unsigned(self) -> u64 {
        self as u64
    }
}

/// What `Arc::new` worked out; everything in 2^-f BLU or BLU^2.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Start {
    pub(crate) residue: i64,
    pub(crate) du: i64,
    pub(crate) dv: i64,
    pub(crate) du_end: i64,
    pub(crate) dv_end: i64,
    pub(crate) one: i64,
    pub(crate) quadrants: u64,
    pub(crate) toward_u: [i8; 2],
    pub(crate) toward_v: [i8; 2],
    pub(crate) spread: Spread,
    pub(crate) least_sweep: i64,
    pub(crate) sweep_shift: u32,
}

/// The change of radius, spread over the first `left` steps: `quotient` each and 1 more whenever
/// the remainders add up to `steps`.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Spread {
    pub(crate) left: u32,
    pub(crate) steps: u32,
    pub(crate) quotient: i64,
    pub(crate) remainder: u32,
    pub(crate) phase: u32,
}

/// A step in x and y as one word: bytes that are stored one by one are slow to read back together.
#[derive(Copy, Clone, Debug)]
struct Pair(u16);

impl Pair {
    fn new([x, y]: [i8; 2]) -> Pair {
        Pair(u16::from_ne_bytes([x as u8, y as u8]))
    }

    fn opposite(self) -> Pair {
        Pair(u16::from_ne_bytes(
            self.0.to_ne_bytes().map(u8::wrapping_neg),
        ))
    }

    #[inline]
    fn only_if(self, condition: bool) -> u16 {
        self.0 & u16::from(condition).wrapping_neg()
    }
}

/// The walking state in words of one width.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Walk<W> {
    residue: W,
    du: W,
    dv: W,
    du_end: W,
    dv_end: W,
    one: W,
    bias: W,
    least_sweep: W,
    quotient: W,
    spread: Spread,
    quadrants: u64,
    toward_u: Pair,
    toward_v: Pair,
    sweep_shift: u32,
}

impl<W: Word> Walk<W> {
    pub(crate) fn new(start: &Start) -> Self {
        Walk {
            residue: W::narrow(start.residue),
            du: W::narrow(start.du),
            dv: W::narrow(start.dv),
            du_end: W::narrow(start.du_end),
            dv_end: W::narrow(start.dv_end),
            one: W::narrow(start.one),
            // |F| is least at cos^2/2 beside the radial middle; with f = 0 parity excludes ties.
            bias: W::narrow(start.one / 2),
            least_sweep: W::narrow(start.least_sweep),
            quotient: W::narrow(start.spread.quotient),
            spread: start.spread,
            quadrants: start.quadrants,
            toward_u: Pair::new(start.toward_u),
            toward_v: Pair::new(start.toward_v),
            sweep_shift: start.sweep_shift,
        }
    }

    pub(crate) fn quadrants(&self) -> u64 {
        self.quadrants
    }

    /// The next step; `None` when the end is reached.
    #[inline(always)]
    pub(crate) fn next(&mut self) -> Option<Step<2>> {
        if self.quadrants == 0 && (self.du >= self.du_end || self.dv >= self.dv_end) {
            let (delta, sweep) = self.run_off();
            return (delta != 0).then(|| self.step(delta, sweep));
        }
        if self.spread.left != 0 {
            self.change_radius();
        }
        let (du, dv) = (self.du, self.dv);
        let after_u = self.residue.plus(du);
        let after_v = self.residue.plus(dv);
        let after_both = after_u.plus(dv);
        // In the quadrant du < 0 <= dv, so after_u < after_both <= after_v and the sign of
        // after_both leaves two candidates. Compared by differences: each fits where the three do.
        let is_outside = after_both >= W::ZERO;
        let takes_v = !(is_outside & (after_both > self.bias.minus(after_u)));
        let takes_u = is_outside | (after_both >= self.bias.minus(after_v));
        self.residue = self
            .residue
            .plus(du.only_if(takes_u))
            .plus(dv.only_if(takes_v));
        let two = self.one.plus(self.one);
        self.du = du.plus(two.only_if(takes_u));
        self.dv = dv.plus(two.only_if(takes_v));
        let along_u = dv.minus(self.one).half();
        let along_v = self.one.minus(du).half();
        let step = self.step(
            self.toward_u.only_if(takes_u) | self.toward_v.only_if(takes_v),
            along_u.only_if(takes_u).plus(along_v.only_if(takes_v)),
        );
        if self.quadrants != 0 && self.du >= W::ZERO {
            (self.du, self.dv) = (two.minus(self.dv), self.du);
            (self.toward_u, self.toward_v) = (self.toward_v.opposite(), self.toward_u);
            self.quadrants = self.quadrants.wrapping_sub(1);
        }
        Some(step)
    }

    /// Level with the end in one axis (or past it): straight to it. The end is a rounded point, so
    /// this is a step or two. Returns the step and its sweep, which may be negative; no step: there.
    #[cold]
    fn run_off(&mut self) -> (u16, W) {
        let along_u = self.dv.minus(self.one).half();
        let along_v = self.one.minus(self.du).half();
        let two = self.one.plus(self.one);
        let (mut delta, mut sweep) = (0, W::ZERO);
        if self.du < self.du_end {
            self.du = self.du.plus(two);
            (delta, sweep) = (delta | self.toward_u.0, sweep.plus(along_u));
        } else if self.du > self.du_end {
            self.du = self.du.minus(two);
            (delta, sweep) = (delta | self.toward_u.opposite().0, sweep.minus(along_u));
        }
        if self.dv < self.dv_end {
            self.dv = self.dv.plus(two);
            (delta, sweep) = (delta | self.toward_v.0, sweep.plus(along_v));
        } else if self.dv > self.dv_end {
            self.dv = self.dv.minus(two);
            (delta, sweep) = (delta | self.toward_v.opposite().0, sweep.minus(along_v));
        }
        (delta, sweep)
    }

    #[inline(always)]
    fn step(&self, delta: u16, sweep: W) -> Step<2> {
        let [x, y] = delta.to_ne_bytes();
        Step {
            delta: [x as i8, y as i8],
            sweep: sweep
                .max(self.least_sweep)
                .unsigned()
                .wrapping_shr(self.sweep_shift),
        }
    }

    #[inline]
    fn change_radius(&mut self) {
        let spread = &mut self.spread;
        spread.left = spread.left.wrapping_sub(1);
        self.residue = self.residue.minus(self.quotient);
        // phase and remainder are below steps <= 2^31: the sum fits.
        spread.phase = spread.phase.wrapping_add(spread.remainder);
        if spread.phase >= spread.steps {
            spread.phase = spread.phase.wrapping_sub(spread.steps);
            self.residue = self.residue.minus(W::narrow(1));
        }
    }
}
