//! Where an arc about a whole-step centre is: a point in its quadrant, and the way to the end.
//!
//! The point is turned into the first quadrant and, going clockwise, mirrored: (u, v) from the
//! centre, u falling to 0 and v growing. At u = 0 the next quadrant begins with (v, 0).
//!
//! ```text
//!         v
//!         |  .  .
//!         |        .
//!         |         .
//!   centre+---------+-- u
//! ```

use crate::{ArcError, ArcMove, Direction, Rim, Step};

/// Largest radius in BLU: six times it, the most any method's state reaches, fits `i32`.
pub(crate) const MAX_RADIUS: u64 = 1 << 28;

/// The pins of a step: `Step::axes` in the low byte, `Step::negative` in the high one.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub(crate) struct Sides(u16);

impl Sides {
    pub(crate) const NONE: Sides = Sides(0);

    /// One step of an axis (0 or 1).
    const fn new(axis: u8, is_negative: bool) -> Sides {
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

/// The point, the end and the quadrants in between.
#[derive(Clone, Debug)]
pub(crate) struct Quadrant {
    pub(crate) u: i32,
    pub(crate) v: i32,
    /// The end, turned as the point will be when `left` is 0.
    pub(crate) u_end: i32,
    pub(crate) v_end: i32,
    /// Quadrant changes still to come.
    pub(crate) left: u32,
    pub(crate) toward_u: Sides,
    pub(crate) toward_v: Sides,
}

impl Quadrant {
    /// Whether the end is level with the point in one axis, or behind it: straight to it then.
    #[inline]
    pub(crate) const fn is_level(&self) -> bool {
        self.left == 0 && (self.u <= self.u_end || self.v >= self.v_end)
    }

    /// Takes the steps and returns them with |P x step| of the point before them, at least 1.
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

    /// One step straight towards the end; `None` there. The end is a rounded point beside the
    /// circle, so this is a step or two.
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

    /// Whether the quadrant is at its end; in the last one the arc's end comes before.
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

/// An arc about a whole-step centre, checked.
#[derive(Clone, Debug)]
pub(crate) struct Start {
    pub(crate) quadrant: Quadrant,
    /// R^2, an integer; at most (2^28 + 2)^2.
    pub(crate) squared: u64,
    /// |P|^2 - R^2 of the first point: at most 4 R + 4 either way.
    pub(crate) residue: i32,
    /// R to the nearest BLU, at least 1.
    pub(crate) radius: u32,
}

impl Start {
    pub(crate) fn new(arc: &ArcMove) -> Result<Start, ArcError> {
        if arc.fraction_bits > 30 {
            return Err(ArcError::FractionBits);
        }
        let bits = u32::from(arc.fraction_bits);
        // At most 2^30, so 1 less fits.
        let fraction = 1_i64.wrapping_shl(bits).wrapping_sub(1);
        let [centre_x, centre_y] = arc.centre;
        if (centre_x | centre_y) & fraction != 0 {
            return Err(ArcError::FractionBits);
        }
        let centre = arc.centre.map(|centre| centre.wrapping_shr(bits));
        let from = Spot::new(arc.from, centre, arc.direction)?;
        let to = Spot::new(arc.to, centre, arc.direction)?;

        let residue = match arc.rim {
            Rim::Spiral => 0,
            // In units of 2^-f BLU^2.
            Rim::Nominal { start, .. } => start.wrapping_shr(bits),
        };
        // Squares are below 2^59.
        let squared = from.square.saturating_sub(residue).max(0).unsigned_abs();
        let radius = rounded_root(squared);
        if radius == 0 {
            return Err(ArcError::Degenerate);
        }
        // A point e beside the circle has a residue of about 2 R e.
        let most = radius.wrapping_mul(4).wrapping_add(4);
        let end_residue = to.square.saturating_sub_unsigned(squared);
        if residue.unsigned_abs() > most || end_residue.unsigned_abs() > most {
            return Err(ArcError::OffRim);
        }
        let left = quadrants(&from, &to, arc.turns);
        // A quadrant has at most 2 R events, in any method.
        let events = radius.wrapping_mul(2).saturating_mul(left.max(1));
        if events > 1 << 31 {
            return Err(if radius > MAX_RADIUS {
                ArcError::TooLarge
            } else {
                ArcError::TooLong
            });
        }
        let (axis, is_negative) = match from.quadrant {
            0 => (0, true),
            1 => (1, true),
            2 => (0, false),
            _ => (1, false),
        };
        let is_clockwise = arc.direction == Direction::Clockwise;
        // Clockwise is mirrored in the second axis.
        let side = |axis: u8, is_negative: bool| {
            Sides::new(axis, is_negative ^ (axis == 1 && is_clockwise))
        };
        // The step along v is the one along u, a quarter turn back: -x becomes y, -y becomes -x.
        let toward_v = side(axis ^ 1, is_negative ^ (axis == 0));
        Ok(Start {
            quadrant: Quadrant {
                u: from.u,
                v: from.v,
                u_end: to.u,
                v_end: to.v,
                left: left as u32,
                toward_u: side(axis, is_negative),
                toward_v,
            },
            squared,
            // At most 4 (2^28 + 5).
            residue: residue as i32,
            radius: radius as u32,
        })
    }
}

/// An end of the arc, seen from the centre and turned into the first quadrant.
struct Spot {
    quadrant: u8,
    u: i32,
    v: i32,
    square: i64,
}

impl Spot {
    fn new(at: [i32; 2], centre: [i64; 2], direction: Direction) -> Result<Spot, ArcError> {
        let ([at_x, at_y], [centre_x, centre_y]) = (at, centre);
        // Two BLU off the largest circle.
        let from_centre = |at: i32, centre: i64| {
            i64::from(at)
                .checked_sub(centre)
                .filter(|distance| distance.unsigned_abs() <= MAX_RADIUS.wrapping_add(2))
                .map(|distance| distance as i32)
                .ok_or(ArcError::TooLarge)
        };
        let x = from_centre(at_x, centre_x)?;
        let y = from_centre(at_y, centre_y)?;
        let y = match direction {
            Direction::Clockwise => y.wrapping_neg(),
            Direction::CounterClockwise => y,
        };
        let (quadrant, u, v) = if x > 0 && y >= 0 {
            (0, x, y)
        } else if x <= 0 && y > 0 {
            (1, y, x.wrapping_neg())
        } else if x < 0 && y <= 0 {
            (2, x.wrapping_neg(), y.wrapping_neg())
        } else if x >= 0 && y < 0 {
            (3, y.wrapping_neg(), x)
        } else {
            return Err(ArcError::Degenerate);
        };
        let square = |value: i32| i64::from(value).wrapping_mul(value.into());
        Ok(Spot {
            quadrant,
            u,
            v,
            square: square(u).wrapping_add(square(v)),
        })
    }
}

/// Quadrant changes from the first to the last point.
fn quadrants(from: &Spot, to: &Spot, turns: u32) -> u64 {
    let product = |a: i32, b: i32| i64::from(a).wrapping_mul(b.into());
    let shortest = u64::from(to.quadrant.wrapping_sub(from.quadrant) & 3);
    // Level with the start or behind it in the same quadrant: all the way round.
    let is_behind = product(from.u, to.v) <= product(from.v, to.u);
    let first = if shortest == 0 && is_behind {
        4
    } else {
        shortest
    };
    u64::from(turns).wrapping_mul(4).wrapping_add(first)
}

/// The square root to the nearest integer; of values below 2^62.
pub(crate) const fn rounded_root(square: u64) -> u64 {
    let root = square.isqrt();
    // (root + 1/2)^2 = root^2 + root + 1/4.
    if square.wrapping_sub(root.wrapping_mul(root)) > root {
        root.wrapping_add(1)
    } else {
        root
    }
}
