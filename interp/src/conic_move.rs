//! Definitions of arcs of curves of the second degree.

use core::fmt;

use crate::{Direction, GridEllipse};

/// Largest semi-axis in 2^-f BLU; then |F'|, |U|, |V| <= 2 a b max(a, b).
const MAX_SEMI_AXIS: u32 = 1 << 20;
/// Largest coefficient of x^2, x y and y^2.
const MAX_SECOND: u64 = 1 << 40;

/// Definition of an arc of an ellipse with axes parallel to those of the plane.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EllipseMove {
    /// First point in BLU: a rounded point near the ellipse.
    pub from: [i32; 2],
    /// Last point in BLU; equal to `from` for a full turn.
    pub to: [i32; 2],
    /// Centre in 2^-`fraction_bits` BLU.
    pub centre: [i64; 2],
    /// Half the width and half the height in 2^-`fraction_bits` BLU. Each is from one BLU to 2^20
    /// of these units.
    pub semi_axes: [u32; 2],
    /// Fraction bits of centre and semi-axes, 0 to 20.
    pub fraction_bits: u8,
    /// Sense of rotation.
    pub direction: Direction,
    /// Complete turns in addition to the angle from `from` to `to`.
    pub turns: u32,
}

/// Definition of an arc of the curve F(x, y) = A x^2 + B x y + C y^2 + D x + E y + G = 0, with x
/// and y in BLU.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ConicMove {
    /// First point in BLU: a rounded point near the curve.
    pub from: [i32; 2],
    /// Last point in BLU; equal to `from` for a full turn.
    pub to: [i32; 2],
    /// A, B, C, D, E, G. A, B and C are at most 2^40. F and its differences on the curve have to
    /// stay below 2^61. Any common factor and sign are allowed.
    pub coefficients: [i64; 6],
    /// The direction in which the path turns. Parabolas and hyperbolas also turn in one direction
    /// only.
    pub direction: Direction,
    /// Complete turns in addition to the angle from `from` to `to`; for ellipses only.
    pub turns: u32,
}

/// Reason why an arc of a conic cannot be made.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ConicError {
    /// Not a curve (a point, lines, or nothing), an end at the centre, or a semi-axis below one
    /// BLU.
    Degenerate,
    /// More than 20 fraction bits.
    FractionBits,
    /// A semi-axis above 2^20, coefficients above 2^40, or a state that does not fit in 64 bits.
    TooLarge,
    /// More than 2^31 events.
    TooLong,
    /// An end is more than about two BLU off the curve.
    OffCurve,
    /// The curve does not lead from one end to the other in this direction, or it turns so sharply
    /// within a BLU that it cannot be followed.
    Astray,
}

impl fmt::Display for ConicError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            ConicError::Degenerate => "the coefficients or semi-axes do not give a curve",
            ConicError::FractionBits => "the centre has more than 20 fraction bits",
            ConicError::TooLarge => "the curve is too large for 64-bit state",
            ConicError::TooLong => "the arc has more than 2^31 events",
            ConicError::OffCurve => "an end is more than two steps off the curve",
            ConicError::Astray => "the curve does not lead to the end in this direction",
        })
    }
}

impl core::error::Error for ConicError {}

/// How the sweep of an event is computed.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub(crate) enum Pace {
    /// The gradient has the same length everywhere: the sweep is the cross product itself.
    Circle { radius: u32 },
    /// The cross product is divided by the length of the gradient.
    Tangent,
    /// The angle of a circle whose image is the ellipse: that of a row or a column. The steepest
    /// gradient is scaled to 30 bits by this shift.
    Angle { shift: u8 },
}

/// A step of one axis, as the masks of an event.
#[derive(Copy, Clone, PartialEq, Eq, Debug, Default)]
pub(crate) struct Toward {
    pub(crate) axes: u8,
    pub(crate) negative: u8,
}

impl Toward {
    #[inline]
    pub(crate) fn opposite(self) -> Toward {
        Toward {
            axes: self.axes,
            negative: self.negative ^ self.axes,
        }
    }

    /// The same direction in a plane of these axes.
    pub(crate) fn in_plane(self, [first, second]: [u32; 2]) -> Toward {
        let mask = |bits: u8| {
            let x = if bits & 1 == 0 {
                0
            } else {
                1_u8.wrapping_shl(first)
            };
            let y = if bits & 2 == 0 {
                0
            } else {
                1_u8.wrapping_shl(second)
            };
            x | y
        };
        Toward {
            axes: mask(self.axes),
            negative: mask(self.negative),
        }
    }

    /// The outward direction of a quadrant: +y, -x, -y, +x.
    fn of(quadrant: u8, is_clockwise: bool) -> Toward {
        let (axes, is_negative) = match quadrant & 3 {
            0 => (2, is_clockwise),
            1 => (1, true),
            2 => (2, !is_clockwise),
            _ => (1, false),
        };
        let negative = if is_negative { axes } else { 0 };
        Toward { axes, negative }
    }
}

/// State of a walk: at first before its first event, later at its present point.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Start {
    /// F at the point.
    pub(crate) residue: i64,
    /// F(P + u) - F(P), negative.
    pub(crate) du: i64,
    /// F(P + v) - F(P).
    pub(crate) dv: i64,
    /// Change of `du` per step of u.
    pub(crate) duu: i64,
    /// Change of `dv` per step of v.
    pub(crate) dvv: i64,
    /// Change of `du` per step of v, and of `dv` per step of u.
    pub(crate) duv: i64,
    /// Steps to the end, in BLU.
    pub(crate) u_left: i32,
    pub(crate) v_left: i32,
    pub(crate) toward_u: Toward,
    pub(crate) toward_v: Toward,
    /// Quadrant changes still to come.
    pub(crate) quadrants: u32,
    pub(crate) pace: Pace,
    /// Whether the curve is not an ellipse.
    pub(crate) is_open: bool,
}

/// F near one point: residue, gradient and second differences, in the (mirrored) frame of the walk.
#[derive(Copy, Clone)]
struct Spot {
    residue: i64,
    /// Derivatives of F at the point.
    gradient: [i64; 2],
    /// Second derivatives: xx, yy and xy.
    second: [i64; 3],
}

impl Spot {
    /// F(P + d) - F(P) for the outward direction of `quadrant`. The second differences 2 A and 2 C
    /// are even.
    fn difference(&self, quadrant: u8) -> i64 {
        let [x, y] = self.gradient;
        let [xx, yy, _] = self.second;
        match quadrant & 3 {
            0 => (yy / 2).wrapping_add(y),
            1 => (xx / 2).wrapping_sub(x),
            2 => (yy / 2).wrapping_sub(y),
            _ => (xx / 2).wrapping_add(x),
        }
    }

    /// The quadrant: F does not fall in its direction and falls in the next direction to the left.
    /// Among several it is the steepest; `None` at a centre.
    fn quadrant(&self) -> Option<u8> {
        (0..4_u8)
            .filter(|&quadrant| {
                self.difference(quadrant) >= 0 && self.difference(quadrant.wrapping_add(1)) < 0
            })
            .max_by_key(|&quadrant| {
                let outwards = self.difference(quadrant);
                outwards.saturating_sub(self.difference(quadrant.wrapping_add(1)))
            })
    }

    /// Whether the point is within about two BLU of the curve: compares |F| with its change over
    /// two steps.
    fn is_near(&self) -> bool {
        let [x, y] = self.gradient.map(i64::unsigned_abs);
        let [xx, yy, xy] = self.second.map(i64::unsigned_abs);
        let change = x.saturating_add(y).saturating_add(xx);
        let change = change.saturating_add(yy).saturating_add(xy);
        self.residue.unsigned_abs() <= change.saturating_mul(2)
    }
}

impl Start {
    /// Whether the point is farther from the curve than a step. The gradient alone is not enough,
    /// so second differences count.
    pub(crate) fn is_off(&self) -> bool {
        let [du, dv] = [self.du, self.dv].map(i64::unsigned_abs);
        let [duu, dvv, duv] = [self.duu, self.dvv, self.duv].map(i64::unsigned_abs);
        // Each is below 2^62.
        let step = du.wrapping_add(dv);
        let bend = duu.wrapping_add(dvv).wrapping_add(duv);
        self.residue.unsigned_abs() > step.wrapping_add(bend)
    }

    pub(crate) fn of_ellipse(ellipse: &EllipseMove) -> Result<Start, ConicError> {
        let bits = ellipse.fraction_bits;
        if bits > 20 {
            return Err(ConicError::FractionBits);
        }
        let one = 1_u32.wrapping_shl(bits.into());
        let [width, height] = ellipse.semi_axes;
        if width.max(height) > MAX_SEMI_AXIS {
            return Err(ConicError::TooLarge);
        }
        if width.min(height) < one {
            return Err(ConicError::Degenerate);
        }
        let is_clockwise = ellipse.direction == Direction::Clockwise;
        // F' = (A X^2 + C Y^2 - A width^2) / 2^f, with X and Y in 2^-f BLU. A : C is height^2 :
        // width^2 in lowest terms, at most 2^40.
        let common = common_divisor(width, height).max(1);
        let square = |length: u32| {
            let length = i64::from(length.checked_div(common).unwrap_or(1));
            length.wrapping_mul(length)
        };
        let (a, c) = (square(height), square(width));
        let width_squared = i128::from(width).wrapping_mul(width.into());
        let spot = |at: [i32; 2]| {
            let [at_x, at_y] = at;
            let [centre_x, centre_y] = ellipse.centre;
            let x = from_centre(at_x, centre_x, width, bits)?;
            let y = from_centre(at_y, centre_y, height, bits)?;
            let y = if is_clockwise { y.wrapping_neg() } else { y };
            // Coefficients are below 2^41 and coordinates below 2^22, so the product is below 2^86.
            let part = |factor: i64, at: i64| {
                i128::from(factor).wrapping_mul(i128::from(at).wrapping_mul(at.into()))
            };
            let residue = part(a, x)
                .wrapping_add(part(c, y))
                .wrapping_sub(i128::from(a).wrapping_mul(width_squared));
            let half = i128::from(one / 2);
            let second = |factor: i64| factor.wrapping_mul(2).checked_mul(one.into());
            let spot = Spot {
                residue: i64::try_from(residue.wrapping_add(half).wrapping_shr(bits.into()))
                    .map_err(|_| ConicError::OffCurve)?,
                // Below 2 2^40 2^22 = 2^63.
                gradient: [
                    a.wrapping_mul(x).wrapping_mul(2),
                    c.wrapping_mul(y).wrapping_mul(2),
                ],
                // Below 2 2^40 2^20.
                second: [
                    second(a).ok_or(ConicError::TooLarge)?,
                    second(c).ok_or(ConicError::TooLarge)?,
                    0,
                ],
            };
            spot.is_near().then_some(spot).ok_or(ConicError::OffCurve)
        };
        let (from, to) = (spot(ellipse.from)?, spot(ellipse.to)?);
        let pace = if width == height {
            Pace::Circle { radius: width }
        } else {
            Pace::Tangent
        };
        let ends = [ellipse.from, ellipse.to];
        start(
            &from,
            &to,
            ends,
            is_clockwise,
            Turns::Whole(ellipse.turns),
            pace,
        )
    }

    pub(crate) fn of_conic(conic: &ConicMove) -> Result<Start, ConicError> {
        Start::passing(conic, None)
    }

    /// A circle on a grid of unequal steps, in the plane of these axes.
    pub(crate) fn on_grid(ellipse: &GridEllipse, plane: [u32; 2]) -> Result<Start, ConicError> {
        let start = Start::passing(&ellipse.conic, Some(ellipse.quadrants))?;
        Ok(Start {
            toward_u: start.toward_u.in_plane(plane),
            toward_v: start.toward_v.in_plane(plane),
            pace: Pace::Angle {
                shift: ellipse.shift,
            },
            ..start
        })
    }

    /// An arc that passes this number of quadrants of an ellipse, if that is known.
    fn passing(conic: &ConicMove, quadrants: Option<u32>) -> Result<Start, ConicError> {
        let is_clockwise = conic.direction == Direction::Clockwise;
        let [a, b, c, d, e, g] = conic.coefficients;
        if [a, b, c]
            .iter()
            .any(|second| second.unsigned_abs() > MAX_SECOND)
        {
            return Err(ConicError::TooLarge);
        }
        // A clockwise arc is mirrored: y and the odd powers of y change sign.
        let mirror = |value: i64| {
            if is_clockwise {
                value.wrapping_neg()
            } else {
                value
            }
        };
        let spot = |at: [i32; 2], sign: i64| -> Result<Spot, ConicError> {
            let [x, y] = at.map(i128::from);
            let wide = i128::from;
            let times = |factor: i64, at: i128| wide(factor).wrapping_mul(at);
            // Coefficients have 64 bits, |x|, |y| <= 2^31: at most 2^40 2^62 and 2^63 2^31, six
            // terms.
            let residue = times(a, x.wrapping_mul(x))
                .wrapping_add(times(b, x.wrapping_mul(y)))
                .wrapping_add(times(c, y.wrapping_mul(y)))
                .wrapping_add(times(d, x))
                .wrapping_add(times(e, y))
                .wrapping_add(wide(g));
            let along_x = times(a, x.wrapping_mul(2))
                .wrapping_add(times(b, y))
                .wrapping_add(wide(d));
            let along_y = times(c, y.wrapping_mul(2))
                .wrapping_add(times(b, x))
                .wrapping_add(wide(e));
            let fit = |value: i128| fit(value).map(|value| value.wrapping_mul(sign));
            Ok(Spot {
                residue: fit(residue)?,
                gradient: [fit(along_x)?, mirror(fit(along_y)?)],
                second: [
                    a.wrapping_mul(2).wrapping_mul(sign),
                    c.wrapping_mul(2).wrapping_mul(sign),
                    mirror(b).wrapping_mul(sign),
                ],
            })
        };
        // The sign of F for which the curve turns left: the sign of its second derivative along the
        // tangent.
        let sign = turn(&spot(conic.from, 1)?);
        if sign == 0 {
            return Err(ConicError::Degenerate);
        }
        let (from, to) = (spot(conic.from, sign)?, spot(conic.to, sign)?);
        if !from.is_near() || !to.is_near() {
            return Err(ConicError::OffCurve);
        }
        // At most 2^82 and 2^80.
        let is_closed = i128::from(a).wrapping_mul(c.into()).wrapping_mul(4)
            > i128::from(b).wrapping_mul(b.into());
        if !is_closed && conic.turns != 0 {
            return Err(ConicError::Astray);
        }
        let turns = match (quadrants, is_closed) {
            (Some(quadrants), _) => Turns::Quadrants(quadrants),
            (None, true) => Turns::Whole(conic.turns),
            (None, false) => Turns::Open,
        };
        start(
            &from,
            &to,
            [conic.from, conic.to],
            is_clockwise,
            turns,
            Pace::Tangent,
        )
    }
}

/// The distance of a point from the centre of an ellipse in 2^-`bits` BLU, at most two BLU more than
/// its semi-axis.
#[inline]
fn from_centre(at: i32, centre: i64, semi_axis: u32, bits: u8) -> Result<i64, ConicError> {
    // |at| <= 2^31 and f <= 20; the semi-axis plus two BLU is below 2^22.
    i64::from(at)
        .wrapping_shl(bits.into())
        .checked_sub(centre)
        .filter(|distance| {
            let beyond = distance.unsigned_abs().saturating_sub(semi_axis.into());
            beyond <= 2_u64.wrapping_shl(bits.into())
        })
        .ok_or(ConicError::OffCurve)
}

/// A value of the conic in 62 bits.
#[inline]
fn fit(value: i128) -> Result<i64, ConicError> {
    i64::try_from(value)
        .ok()
        .filter(|value| value.unsigned_abs() < 1 << 62)
        .ok_or(ConicError::TooLarge)
}

/// Greatest common divisor. Euclid's algorithm takes at most 30 divisions for 21 bits.
fn common_divisor(mut larger: u32, mut smaller: u32) -> u32 {
    while let Some(rest) = larger.checked_rem(smaller) {
        (larger, smaller) = (smaller, rest);
    }
    larger
}

/// Sign of C F_x^2 - B F_x F_y + A F_y^2: positive where the curve turns left around F < 0. It is
/// constant along a conic, and 0 for lines.
fn turn(spot: &Spot) -> i64 {
    let [x, y] = spot.gradient;
    let [xx, yy, xy] = spot.second;
    // The gradient is scaled to 40 bits: 41 + 80 bits, three terms.
    let largest = x.unsigned_abs() | y.unsigned_abs();
    let shift = 24_u32.saturating_sub(largest.leading_zeros());
    let [x, y] = [x, y].map(|value| i128::from(value.wrapping_shr(shift)));
    let bend = |second: i64, square: i128| i128::from(second).wrapping_mul(square);
    let twice_xy = xy.wrapping_mul(2);
    let sum = bend(yy, x.wrapping_mul(x))
        .wrapping_add(bend(xx, y.wrapping_mul(y)))
        .wrapping_sub(bend(twice_xy, x.wrapping_mul(y)));
    sum.signum() as i64
}

/// Whether the gradient of one point is turned left, by less than half a turn, to that of the
/// other.
fn is_left_turn(from: &Spot, to: &Spot) -> bool {
    let ([from_x, from_y], [to_x, to_y]) = (from.gradient, to.gradient);
    // Products of 62 bits each.
    let product = |one: i64, other: i64| i128::from(one).wrapping_mul(other.into());
    product(from_x, to_y) > product(from_y, to_x)
}

/// How often the path goes around.
#[derive(Copy, Clone, PartialEq, Eq)]
enum Turns {
    /// An open curve.
    Open,
    /// Whole turns, in addition to the angle between the ends.
    Whole(u32),
    /// Quadrants in all, before the ends were rounded to steps.
    Quadrants(u32),
}

/// The number of quadrants near `exact` that is `between` modulo 4. Rounding moves each end across
/// an axis at most, so it is the right one.
#[inline]
fn near(exact: u32, between: u32) -> Option<u32> {
    match between.wrapping_sub(exact) & 3 {
        0 => Some(exact),
        1 => Some(exact.wrapping_add(1)),
        3 => exact.checked_sub(1),
        _ => None,
    }
}

/// Combines both ends into the start state.
fn start(
    from: &Spot,
    to: &Spot,
    ends: [[i32; 2]; 2],
    is_clockwise: bool,
    turns: Turns,
    pace: Pace,
) -> Result<Start, ConicError> {
    let first = from.quadrant().ok_or(ConicError::Degenerate)?;
    let last = to.quadrant().ok_or(ConicError::Degenerate)?;
    let [[from_x, from_y], [to_x, to_y]] = ends;
    // The walk gives up beyond 2^22, so a distance that does not fit in 31 bits is refused as well.
    let way = |from: i32, to: i32| {
        to.checked_sub(from)
            .filter(|way| way.unsigned_abs() < 1 << 30)
            .ok_or(ConicError::TooLarge)
    };
    let (x_left, y_left) = (way(from_x, to_x)?, way(from_y, to_y)?);
    let y_left = if is_clockwise {
        y_left.wrapping_neg()
    } else {
        y_left
    };
    let left = |quadrant: u8| match quadrant & 3 {
        0 => y_left,
        1 => x_left.wrapping_neg(),
        2 => y_left.wrapping_neg(),
        _ => x_left,
    };
    let next = first.wrapping_add(1);
    let (u_left, v_left) = (left(next), left(first));
    let [xx, yy, xy] = from.second;
    let is_upright = first & 1 == 0;
    let (duu, dvv) = if is_upright { (xx, yy) } else { (yy, xx) };
    // For -x and +y, for -y and -x, and so on.
    let duv = if is_upright { xy.wrapping_neg() } else { xy };
    let (du, dv) = (from.difference(next), from.difference(first));

    // Ahead along the tangent: 63 bits by 31 bits.
    let along_u = i128::from(dv.saturating_sub(dvv / 2));
    let along_v = i128::from((duu / 2).saturating_sub(du));
    let ahead = along_u
        .wrapping_mul(u_left.into())
        .wrapping_add(along_v.wrapping_mul(v_left.into()));
    let between = u32::from(last.wrapping_sub(first) & 3);
    let quadrants = match between {
        0 if ahead <= 0 => 4,
        quadrants => quadrants,
    };
    let quadrants = match turns {
        Turns::Whole(turns) => turns
            .checked_mul(4)
            .and_then(|more| more.checked_add(quadrants))
            .ok_or(ConicError::TooLong)?,
        Turns::Quadrants(exact) => match near(exact, between) {
            Some(0) if u_left <= 0 && v_left <= 0 => return Err(ConicError::Degenerate),
            quadrants => quadrants.ok_or(ConicError::Degenerate)?,
        },
        // An open curve turns left by less than half a turn.
        Turns::Open if quadrants > 2 || (quadrants == 2 && !is_left_turn(from, to)) => {
            return Err(ConicError::Astray);
        }
        Turns::Open => quadrants,
    };
    Ok(Start {
        residue: from.residue,
        du,
        dv,
        duu,
        dvv,
        duv,
        u_left,
        v_left,
        toward_u: Toward::of(next, is_clockwise),
        toward_v: Toward::of(first, is_clockwise),
        quadrants,
        pace,
        is_open: turns == Turns::Open,
    })
}
