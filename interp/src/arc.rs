//! The general circular arc in a plane: any centre, any ends, several turns.

use core::fmt;
use core::iter::FusedIterator;

use crate::Step;
use crate::walk::{Spread, Start, Walk};

/// Largest distance of an end from the centre, in BLU: then every difference of two points of the
/// arc fits `i32`.
const MAX_RADIUS: i64 = (1 << 30) - 8;
/// Largest distance in 2^-f BLU: three times it, and products with 2^16, fit `i64`.
const MAX_SCALED: i64 = 1 << 46;
/// Most events an arc may have.
const MAX_EVENTS: u64 = 1 << 31;
/// (r + 4) 2^f up to here keeps three times that value within `i32`.
const MAX_NARROW: u64 = 710_000_000;

/// Turning sense, seen with the first axis to the right and the second one up.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub enum Direction {
    /// G2.
    Clockwise,
    /// G3.
    CounterClockwise,
}

/// What the arc's ends, which are whole steps, are to its circle.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub enum Rim {
    /// The curve goes exactly through both ends; their distances from the centre may differ.
    Spiral,
    /// A circle of nominal radius R; the ends are rounded points beside it. Each value is
    /// floor((|P - C|^2 - R^2) 2^f) for P in BLU: the residue in units of 2^-f BLU^2.
    Nominal {
        /// Residue of the first point.
        start: i64,
        /// Residue of the last point.
        end: i64,
    },
}

/// An arc to make. All positions are absolute in the plane.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub struct ArcMove {
    /// First point, in BLU.
    pub from: [i32; 2],
    /// Last point, in BLU; the same as `from` means a full circle.
    pub to: [i32; 2],
    /// Centre, in 2^-`fraction_bits` BLU.
    pub centre: [i64; 2],
    /// Fraction bits of the centre, 0 to 30; see [`fraction_bits_for`].
    pub fraction_bits: u8,
    /// Turning sense.
    pub direction: Direction,
    /// Complete turns made on top of the shortest way round.
    pub turns: u32,
    /// Nominal circle or spiral.
    pub rim: Rim,
}

/// Why an arc cannot be made.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
pub enum ArcError {
    /// An end is within a step of the centre: the arc has no direction there. Make a line of it.
    Degenerate,
    /// More than 30 fraction bits.
    FractionBits,
    /// An end is 2^30 BLU (or 2^46 units of the fraction) or more away from the centre.
    TooLarge,
    /// More than 2^31 events.
    TooLong,
    /// A nominal residue puts an end more than two BLU off the circle.
    OffRim,
    /// The two axes of the plane are the same, or one of them does not exist.
    Plane,
}

impl fmt::Display for ArcError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            ArcError::Degenerate => "an end of the arc is at its centre",
            ArcError::FractionBits => "the centre has more than 30 fraction bits",
            ArcError::TooLarge => "the arc's radius exceeds 2^30 steps",
            ArcError::TooLong => "the arc has more than 2^31 events",
            ArcError::OffRim => "an end is more than two steps off the nominal circle",
            ArcError::Plane => "the plane needs two different axes of the machine",
        })
    }
}

impl core::error::Error for ArcError {}

/// Fraction bits to round a centre to, for an arc of `radius_blu`: as many as 32-bit state allows
/// (at most 16); where that would be less than 4, 16 with 64-bit state.
pub const fn fraction_bits_for(radius_blu: u64) -> u8 {
    let reach = radius_blu.saturating_add(4);
    let mut bits = 16;
    while bits >= 4 {
        if reach <= MAX_NARROW >> bits {
            return bits;
        }
        bits -= 1;
    }
    16
}

/// A circular arc, one event at a time: always the nearest point of the next row or column, two
/// sign tests and a few additions an event; ends exactly at `to`.
///
/// Deviation from the circle: less than 1/2 BLU for a whole-step centre and an integer R^2, at most
/// 0.5 + 2^-f / (4 r) otherwise; the first point and the run-off to the last one are rounded
/// (0.7071). State is 32 bits wide when [`Arc::is_narrow`], otherwise 64; the steps are the same.
#[derive(Clone, Debug)]
pub struct Arc {
    walk: Width,
    left: u32,
    events: u32,
    total_sweep: u64,
    largest_sweep: u64,
    radius: u64,
    sweep_bits: i8,
}

#[derive(Clone, Debug)]
enum Width {
    Narrow(Walk<i32>),
    Wide(Walk<i64>),
}

impl Width {
    #[inline]
    fn next(&mut self) -> Option<Step<2>> {
        match self {
            Width::Narrow(walk) => walk.next(),
            Width::Wide(walk) => walk.next(),
        }
    }
}

impl Arc {
    /// Prepares an arc: walks it once to count its events and to add up its sweep.
    ///
    /// # Errors
    /// See [`ArcError`]; nothing is walked then.
    pub fn new(arc: &ArcMove) -> Result<Arc, ArcError> {
        Arc::with_width(arc, false)
    }

    /// As [`Arc::new`], always with 64-bit state; for comparison, the steps are the same.
    ///
    /// # Errors
    /// As [`Arc::new`].
    pub fn wide(arc: &ArcMove) -> Result<Arc, ArcError> {
        Arc::with_width(arc, true)
    }

    fn with_width(arc: &ArcMove, is_wide: bool) -> Result<Arc, ArcError> {
        let (start, radius, fits_narrow) = start(arc)?;
        let walk = if fits_narrow && !is_wide {
            Width::Narrow(Walk::new(&start))
        } else {
            Width::Wide(Walk::new(&start))
        };
        let (mut events, mut total_sweep, mut largest_sweep) = (0_u32, 0_u64, 0_u64);
        let mut dry = walk.clone();
        while let Some(step) = dry.next() {
            events = events.wrapping_add(1);
            if u64::from(events) > MAX_EVENTS {
                return Err(ArcError::TooLong);
            }
            // A sweep is below 2^32 (r < 2^31 in its unit), events are at most 2^31.
            total_sweep = total_sweep.wrapping_add(step.sweep);
            largest_sweep = largest_sweep.max(step.sweep);
        }
        Ok(Arc {
            walk,
            left: events,
            events,
            total_sweep,
            largest_sweep,
            radius,
            // f <= 30 and shift <= 31 (see `start`): fits.
            sweep_bits: (i64::from(arc.fraction_bits) - i64::from(start.sweep_shift)) as i8,
        })
    }

    /// Events of the whole arc.
    pub const fn events(&self) -> u32 {
        self.events
    }

    /// Events still to come.
    pub const fn remaining(&self) -> u32 {
        self.left
    }

    /// Sum of the sweeps of all events of the arc.
    pub const fn total_sweep(&self) -> u64 {
        self.total_sweep
    }

    /// Largest sweep of one event of the arc, below 2^32.
    pub const fn largest_sweep(&self) -> u64 {
        self.largest_sweep
    }

    /// Radius in the unit of the sweep: `total_sweep / radius` is the arc's length in BLU. Of a
    /// spiral the mean of both ends.
    pub const fn radius(&self) -> u64 {
        self.radius
    }

    /// Fraction bits of sweep and radius: those of the centre, fewer (even negative) only where
    /// the radius would need more than 31 bits.
    pub const fn sweep_bits(&self) -> i8 {
        self.sweep_bits
    }

    /// Whether the state is 32 bits wide.
    pub const fn is_narrow(&self) -> bool {
        matches!(self.walk, Width::Narrow(_))
    }

    /// Quadrant changes still to come.
    pub fn quadrants(&self) -> u64 {
        match &self.walk {
            Width::Narrow(walk) => walk.quadrants(),
            Width::Wide(walk) => walk.quadrants(),
        }
    }
}

impl Iterator for Arc {
    type Item = Step<2>;

    #[inline]
    fn next(&mut self) -> Option<Step<2>> {
        let step = self.walk.next()?;
        self.left = self.left.wrapping_sub(1);
        Some(step)
    }

    #[inline]
    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = usize::try_from(self.left).ok();
        (left.unwrap_or(usize::MAX), left)
    }
}

impl ExactSizeIterator for Arc {}
impl FusedIterator for Arc {}

/// A point from the centre in 2^-f BLU, turned into its quadrant.
#[derive(Copy, Clone)]
struct Spot {
    quadrant: u8,
    x: i64,
    y: i64,
    u: i64,
    v: i64,
}

impl Spot {
    fn new(at: [i32; 2], centre: [i64; 2], bits: u8, is_clockwise: bool) -> Result<Spot, ArcError> {
        let [at_x, at_y] = at;
        let [centre_x, centre_y] = centre;
        // |at| <= 2^31 and bits <= 30: the shift fits.
        let from_centre = |at: i32, centre: i64| {
            (i64::from(at) << bits)
                .checked_sub(centre)
                .filter(|distance| {
                    distance.unsigned_abs() < MAX_SCALED as u64
                        && distance.unsigned_abs() >> bits < MAX_RADIUS as u64
                })
                .ok_or(ArcError::TooLarge)
        };
        let x = from_centre(at_x, centre_x)?;
        let y = from_centre(at_y, centre_y)?;
        // The walk is counter-clockwise; clockwise is its mirror image.
        let y = if is_clockwise { -y } else { y };
        let one = 1_i64 << bits;
        let (quadrant, u, v) = if 2 * x > one && 2 * y >= -one {
            (0, x, y)
        } else if 2 * x <= one && 2 * y > one {
            (1, y, -x)
        } else if 2 * x < -one && 2 * y <= one {
            (2, -x, -y)
        } else if 2 * x >= -one && 2 * y < -one {
            (3, -y, x)
        } else {
            return Err(ArcError::Degenerate);
        };
        Ok(Spot {
            quadrant,
            x,
            y,
            u,
            v,
        })
    }

    /// Distance from the centre in units of 2^`shift`; `residue` is taken off its square.
    fn radius(&self, shift: u32, residue: i64, bits: u8) -> i64 {
        let (x, y) = (self.x >> shift, self.y >> shift);
        // |x| + |y| < 2^31 by the choice of shift, so the square is below 2^62; the residue is at
        // most 4 (r + 4) 2^f, so scaled it is below it too unless the radius is a few steps.
        let scaled = if 2 * shift >= u32::from(bits) {
            residue >> (2 * shift - u32::from(bits)).min(63)
        } else {
            residue.saturating_mul(1 << (u32::from(bits) - 2 * shift))
        };
        let square = (x * x + y * y).saturating_sub(scaled).max(1);
        square_root(square.unsigned_abs()) as i64
    }
}

/// Works out the walk; with it the radius in sweep units and whether 32 bits hold the state.
fn start(arc: &ArcMove) -> Result<(Start, u64, bool), ArcError> {
    let bits = arc.fraction_bits;
    if bits > 30 {
        return Err(ArcError::FractionBits);
    }
    let one = 1_i64 << bits;
    let is_clockwise = arc.direction == Direction::Clockwise;
    let from = Spot::new(arc.from, arc.centre, bits, is_clockwise)?;
    let to = Spot::new(arc.to, arc.centre, bits, is_clockwise)?;

    // Coordinates are below 2^46, so sums and doubles of two of them fit easily.
    let reach = (from.x.abs() + from.y.abs()).max(to.x.abs() + to.y.abs());
    let shift = (64 - reach.leading_zeros()).saturating_sub(31);
    let (first, last) = (from.radius(shift, 0, bits), to.radius(shift, 0, bits));
    let larger = first.max(last) << shift;
    if larger >> bits > MAX_RADIUS {
        return Err(ArcError::TooLarge);
    }
    let mean_radius = mean(first, last) << shift;

    let chord = [
        i64::from(arc.to[0]) - i64::from(arc.from[0]),
        if is_clockwise {
            i64::from(arc.from[1]) - i64::from(arc.to[1])
        } else {
            i64::from(arc.to[1]) - i64::from(arc.from[1])
        },
    ];
    let quadrants = quadrants(&from, &to, chord, arc.turns);
    // A quadrant has at most 1.42 r + 2 events; MAX_EVENTS bounds the dry pass.
    let bound = ((larger >> bits) as u64 + 2).saturating_mul(quadrants.max(1));
    if bound.saturating_add(bound / 2) > MAX_EVENTS {
        return Err(ArcError::TooLong);
    }

    let (first_residue, last_residue) = match arc.rim {
        Rim::Spiral => (0, 0),
        Rim::Nominal { start, end } => (start, end),
    };
    // |P|^2 - R^2 of a point e off the circle is about 2 r e.
    let most_residue = 4 * (larger.unsigned_abs() + 4 * one.unsigned_abs());
    if first_residue.unsigned_abs() > most_residue || last_residue.unsigned_abs() > most_residue {
        return Err(ArcError::OffRim);
    }

    let spread = spread(
        &from,
        &to,
        chord,
        last_residue - first_residue,
        quadrants,
        mean_radius,
        bits,
    )?;
    let radius = match arc.rim {
        Rim::Spiral => mean(first, last),
        Rim::Nominal { .. } => from.radius(shift, first_residue, bits),
    }
    .max(1);

    let toward_u = match from.quadrant {
        0 => [-1, 0],
        1 => [0, -1],
        2 => [1, 0],
        _ => [0, 1],
    };
    let [ux, uy]: [i8; 2] = toward_u;
    let mirror = |[x, y]: [i8; 2]| [x, if is_clockwise { -y } else { y }];
    let start = Start {
        residue: first_residue,
        du: one - 2 * from.u,
        dv: one + 2 * from.v,
        du_end: one - 2 * to.u,
        dv_end: one + 2 * to.v,
        one,
        quadrants,
        toward_u: mirror(toward_u),
        toward_v: mirror([uy, -ux]),
        spread,
        least_sweep: (radius << shift) / 2,
        sweep_shift: shift,
    };
    // The state needs 3 (r + 4) 2^f, and what one step of the spread adds on top.
    let reach = (larger.unsigned_abs()).saturating_add(4 * one.unsigned_abs());
    let needed = reach
        .saturating_mul(3)
        .saturating_add(spread.quotient.unsigned_abs().saturating_mul(4));
    let at_start = [
        start.residue,
        start.residue + start.du + start.dv,
        start.residue + start.du,
        start.residue + start.dv,
    ];
    let fits_narrow = reach <= MAX_NARROW
        && needed <= i32::MAX.unsigned_abs().into()
        && at_start
            .iter()
            .all(|value| value.unsigned_abs() <= 2_140_000_000);
    Ok((start, radius.unsigned_abs(), fits_narrow))
}

/// Quadrant changes on the way from `from` to `to`.
fn quadrants(from: &Spot, to: &Spot, chord: [i64; 2], turns: u32) -> u64 {
    let changes = u64::from((to.quadrant + 4 - from.quadrant) % 4);
    let [chord_x, chord_y] = chord;
    // from x to = from x (to - from) 2^f; its sign says whether the end is ahead. 128-bit products
    // once an arc: 2^46 times 2^32.
    let ahead = i128::from(from.x) * i128::from(chord_y) - i128::from(from.y) * i128::from(chord_x);
    let whole = if changes == 0 && ahead <= 0 {
        4
    } else {
        changes
    };
    whole + 4 * u64::from(turns)
}

/// The change of radius and how it is spread over the events (motion.md 2.3, K and N).
fn spread(
    from: &Spot,
    to: &Spot,
    chord: [i64; 2],
    residue_change: i64,
    quadrants: u64,
    mean_radius: i64,
    bits: u8,
) -> Result<Spread, ArcError> {
    let [chord_x, chord_y] = chord;
    let change = i128::from(chord_x) * i128::from(from.x + to.x)
        + i128::from(chord_y) * i128::from(from.y + to.y)
        - i128::from(residue_change);
    let change = i64::try_from(change).map_err(|_| ArcError::TooLarge)?;
    if change == 0 {
        return Ok(Spread {
            left: 0,
            steps: 1,
            quotient: 0,
            remainder: 0,
            phase: 0,
        });
    }
    // r / sqrt(2): the octant's height; r < 2^47, so the product is below 2^63.
    let height = (mean_radius * 46341) >> 16;
    let place = |spot: &Spot| {
        if spot.v <= spot.u {
            spot.v
        } else {
            2 * height - spot.u
        }
    };
    // quadrants * r <= 2^31 * 2^f <= 2^61 (checked by the caller): fits.
    let travel = (quadrants as i64) * 2 * height + place(to) - place(from);
    let whole = travel >> bits;
    let steps = if whole <= 2 {
        1
    } else {
        (whole - 1 - (quadrants / 2) as i64).max(1)
    };
    // At most 1.42 quadrants * (r + 2) <= 2^31.
    let steps = u32::try_from(steps).map_err(|_| ArcError::TooLong)?;
    Ok(Spread {
        left: steps,
        steps,
        quotient: change.div_euclid(i64::from(steps)),
        remainder: change.rem_euclid(i64::from(steps)) as u32,
        phase: 0,
    })
}

/// Mean of two values of 0 to 2^47, rounded down.
const fn mean(one: i64, other: i64) -> i64 {
    one.wrapping_add(other) >> 1
}

/// floor(sqrt(square)), one bit at a time: no division, 32 rounds.
const fn square_root(square: u64) -> u64 {
    let mut root = 0_u64;
    let mut rest = square;
    let mut bit = 1_u64 << 62;
    while bit > square {
        bit >>= 2;
    }
    while bit != 0 {
        if rest >= root + bit {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
        bit >>= 2;
    }
    root
}
