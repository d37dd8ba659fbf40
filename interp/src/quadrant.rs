//! State of an arc about a whole-step centre: a point in its quadrant, and the distance to the end.
//!
//! The point is rotated into the first quadrant and mirrored if the arc is clockwise: (u, v) from
//! the centre, where u falls to 0 and v grows. At u = 0 the next quadrant begins with (v, 0).
//!
//! ```text
//!         v
//!         |  .  .
//!         |        .
//!         |         .
//!   centre+---------+-- u
//! ```
//!
//! Every event that moves decreases u, increases v, or both: at most 2 R and a few events per
//! quadrant. In the last quadrant the walk ends as soon as it is level with the end in one axis.
//! From there |u - u_end| + |v - v_end| falls with every event. So no arc misses its end, wherever
//! the rounded end is.

use crate::Step;

/// The masks of a step: `Step::axes` in the low byte, `Step::negative` in the high byte.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub(crate) struct Sides(u16);

impl Sides {
    pub(crate) const NONE: Sides = Sides(0);

    /// One step of an axis (0 or 1).
    pub(crate) const fn new(axis: u8, is_negative: bool) -> Sides {
        let axes = 1_u16.wrapping_shl(axis as u32);
        Sides(if is_negative {
            axes | (axes << 8)
        } else {
            axes
        })
    }

    pub(crate) const fn from_bits(bits: u16) -> Sides {
        Sides(bits)
    }

    pub(crate) const fn bits(self) -> u16 {
        self.0
    }

    pub(crate) const fn opposite(self) -> Sides {
        Sides(self.0 ^ (self.0 << 8))
    }

    #[inline]
    pub(crate) const fn and(self, other: Sides) -> Sides {
        Sides(self.0 | other.0)
    }

    #[inline]
    pub(crate) const fn step(self, sweep: u32) -> Step {
        let [axes, negative] = self.0.to_le_bytes();
        Step {
            axes,
            negative,
            sweep,
        }
    }
}

/// The point, the end and the number of quadrants between them.
#[derive(Clone, Debug)]
pub(crate) struct Quadrant {
    pub(crate) u: i32,
    pub(crate) v: i32,
    /// The end, rotated as the point will be when `left` is 0.
    pub(crate) u_end: i32,
    pub(crate) v_end: i32,
    /// Quadrant changes still to come.
    pub(crate) left: u32,
    pub(crate) toward_u: Sides,
    pub(crate) toward_v: Sides,
}

impl Quadrant {
    /// Whether the end is level with the point in one axis, or behind it. The walk then goes
    /// straight to it.
    #[inline]
    pub(crate) const fn is_level(&self) -> bool {
        self.left == 0 && (self.u <= self.u_end || self.v >= self.v_end)
    }

    /// Makes the steps. The sweep is |P x step| of the point before them, at least 1.
    #[inline]
    pub(crate) fn take(&mut self, takes_u: bool, takes_v: bool) -> Step {
        let (mut sides, mut sweep) = (Sides::NONE, 0_i32);
        if takes_u {
            (sides, sweep) = (self.toward_u, self.v);
        }
        if takes_v {
            // Both below 2^29.
            (sides, sweep) = (sides.and(self.toward_v), sweep.wrapping_add(self.u));
            self.v = self.v.wrapping_add(1);
        }
        if takes_u {
            self.u = self.u.wrapping_sub(1);
        }
        sides.step(sweep.max(1).unsigned_abs())
    }

    /// Makes one step straight towards the end; `None` at the end. The end is a rounded point near
    /// the circle, so this takes a step or two.
    pub(crate) fn straight(&mut self, is_diagonal: bool) -> Option<Step> {
        let (mut sides, mut sweep) = (Sides::NONE, 0_i32);
        let (u, v) = (self.u, self.v);
        // Coordinates are below 2^29, so sums of two of them fit.
        if u > self.u_end {
            self.u = u.wrapping_sub(1);
            (sides, sweep) = (self.toward_u, v);
        } else if u < self.u_end {
            self.u = u.wrapping_add(1);
            (sides, sweep) = (self.toward_u.opposite(), v.wrapping_neg());
        }
        if sides == Sides::NONE || is_diagonal {
            if v < self.v_end {
                self.v = v.wrapping_add(1);
                (sides, sweep) = (sides.and(self.toward_v), sweep.wrapping_add(u));
            } else if v > self.v_end {
                self.v = v.wrapping_sub(1);
                let back = self.toward_v.opposite();
                (sides, sweep) = (sides.and(back), sweep.wrapping_sub(u));
            }
        }
        (sides != Sides::NONE).then(|| sides.step(sweep.max(1).unsigned_abs()))
    }

    /// Whether the quadrant is at its end. In the last quadrant the end of the arc comes first.
    #[inline]
    pub(crate) const fn is_over(&self) -> bool {
        self.u <= 0 && self.left != 0
    }

    /// Goes on to the next quadrant.
    #[inline]
    pub(crate) fn turn(&mut self) {
        (self.u, self.v) = (self.v, self.u.wrapping_neg());
        (self.toward_u, self.toward_v) = (self.toward_v.opposite(), self.toward_u);
        self.left = self.left.wrapping_sub(1);
    }
}
