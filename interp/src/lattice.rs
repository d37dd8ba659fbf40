//! Start state of the arcs about a whole-step centre.

use crate::quadrant::{Quadrant, Sides};
use crate::{ArcError, ArcMove, Direction, Rim};

/// Largest radius in BLU. Six times it, the largest state of any method, fits in `i32`.
const MAX_RADIUS: u64 = 1 << 28;

/// A checked arc about a whole-step centre.
#[derive(Clone, Debug)]
pub(crate) struct Start {
    pub(crate) quadrant: Quadrant,
    /// R^2, an integer; at most (2^28 + 2)^2.
    pub(crate) squared: u64,
    /// |P|^2 - R^2 of the first point: at most 4 R + 4 in magnitude.
    pub(crate) residue: i32,
    /// R rounded to the nearest BLU, at least 1.
    pub(crate) radius: u32,
}

impl Start {
    pub(crate) fn new(arc: &ArcMove) -> Result<Start, ArcError> {
        if arc.fraction_bits > 30 {
            return Err(ArcError::FractionBits);
        }
        let bits = u32::from(arc.fraction_bits);
        // At most 2^30, so subtracting 1 is safe.
        let fraction = 1_i64.wrapping_shl(bits).wrapping_sub(1);
        let [centre_x, centre_y] = arc.centre;
        if (centre_x | centre_y) & fraction != 0 {
            return Err(ArcError::Centre);
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
        // A point at distance e from the circle has a residue of about 2 R e.
        let most = radius.wrapping_mul(4).wrapping_add(4);
        let end_residue = to.square.saturating_sub_unsigned(squared);
        if residue.unsigned_abs() > most || end_residue.unsigned_abs() > most {
            return Err(ArcError::OffRim);
        }
        let left = quadrants(&from, &to, arc.turns);
        // A quadrant has at most 2 R events in any method.
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
        // The step along v is the step along u, a quarter turn back: -x becomes y, -y becomes -x.
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

/// An end of the arc relative to the centre, rotated into the first quadrant.
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

/// Number of quadrant changes from the first to the last point.
fn quadrants(from: &Spot, to: &Spot, turns: u32) -> u64 {
    let product = |a: i32, b: i32| i64::from(a).wrapping_mul(b.into());
    let shortest = u64::from(to.quadrant.wrapping_sub(from.quadrant) & 3);
    // The end is level with the start or behind it in the same quadrant: a whole turn.
    let is_behind = product(from.u, to.v) <= product(from.v, to.u);
    let first = if shortest == 0 && is_behind {
        4
    } else {
        shortest
    };
    u64::from(turns).wrapping_mul(4).wrapping_add(first)
}

/// The square root, rounded to the nearest integer, of a value below 2^62.
pub(crate) const fn rounded_root(square: u64) -> u64 {
    let root = square.isqrt();
    // (root + 1/2)^2 = root^2 + root + 1/4.
    if square.wrapping_sub(root.wrapping_mul(root)) > root {
        root.wrapping_add(1)
    } else {
        root
    }
}
