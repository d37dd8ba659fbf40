//! The general circular arc in a plane: any centre, any end points, several turns.

use crate::counted::Counted;
use crate::interpolator::Totals;
use crate::length::square_root;
use crate::method::interpolator;
use crate::walk::{Spread, Start, Toward, Walk};
use crate::{Run, Step};
use core::fmt;

/// Largest distance of an end from the centre in BLU. The difference of any two points of the arc
/// then fits in `i32`.
const MAX_RADIUS: u64 = (1 << 30) - 8;
/// Largest distance in 2^-f BLU: three times it, and products with 2^16, fit in `i64`.
const MAX_SCALED: u64 = 1 << 46;
/// Most events of an arc.
const MAX_EVENTS: u64 = 1 << 31;
/// While (r + 4) 2^f is at most this, three times the value fits in `i32`.
const MAX_NARROW: u64 = 710_000_000;

/// Limit of a state word of 32 bits, with room for a step.
const MAX_STATE: u64 = 2_140_000_000;

/// Sense of rotation, seen with the first axis to the right and the second axis up.
///
/// The same as `Direction` of `husillo-gcode`. Crates of this level do not depend on each other, so
/// a `bool` connects them: pass its `is_clockwise` to [`Direction::from_clockwise`].
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Direction {
    /// G2.
    Clockwise,
    /// G3.
    CounterClockwise,
}

impl Direction {
    /// Converts a flag to a sense of rotation.
    pub const fn from_clockwise(is_clockwise: bool) -> Direction {
        if is_clockwise {
            Direction::Clockwise
        } else {
            Direction::CounterClockwise
        }
    }
}

/// Relation of the end points, which are whole steps, to the circle.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Rim {
    /// The curve passes exactly through both ends. Their distances from the centre may differ.
    Spiral,
    /// A circle of nominal radius R; the ends are rounded points near it.
    ///
    /// Each value is the residue (|P - C|^2 - R^2) 2^f for P in BLU, in units of 2^-f BLU^2. With
    /// residues rounded to nearest the error bound is 0.5 + 2^-f / (4 r). With floored residues it
    /// is 0.5 + 2^-f / (2 r). Both residues have to be rounded in the same manner.
    Nominal {
        /// Residue of the first point.
        start: i64,
        /// Residue of the last point.
        end: i64,
    },
}

/// Definition of an arc. All positions are absolute in the plane.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ArcMove {
    /// First point in BLU.
    pub from: [i32; 2],
    /// Last point in BLU; equal to `from` for a full circle.
    pub to: [i32; 2],
    /// Centre in 2^-`fraction_bits` BLU.
    pub centre: [i64; 2],
    /// Fraction bits of the centre, 0 to 30; see [`fraction_bits_for`].
    pub fraction_bits: u8,
    /// Sense of rotation.
    pub direction: Direction,
    /// Complete turns in addition to the angle from `from` to `to`.
    pub turns: u32,
    /// Nominal circle or spiral.
    pub rim: Rim,
}

/// Reason why an arc cannot be made.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ArcError {
    /// An end is within a step of the centre, where the arc has no direction. Use a line instead.
    Degenerate,
    /// More than 30 fraction bits.
    FractionBits,
    /// The centre is between two steps, and the method accepts whole steps only.
    Centre,
    /// An end is at least 2^30 BLU (or 2^46 units of the fraction) away from the centre.
    TooLarge,
    /// More than 2^31 events.
    TooLong,
    /// A nominal residue places an end more than two BLU off the circle.
    OffRim,
    /// The two axes of the plane are equal, or one of them does not exist.
    Plane,
    /// The state needs 64 bits ([`NarrowArc`](crate::NarrowArc)).
    Wide,
    /// The steps of the two axes differ, and the method needs equal ones; or one is more than 256
    /// times the other; or the arc is a spiral of almost a whole turn.
    Unequal,
}

impl fmt::Display for ArcError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            ArcError::Degenerate => "an end of the arc is at its centre",
            ArcError::FractionBits => "the centre has more than 30 fraction bits",
            ArcError::Centre => "the centre is between two steps",
            ArcError::TooLarge => "the arc's radius exceeds 2^30 steps",
            ArcError::TooLong => "the arc has more than 2^31 events",
            ArcError::OffRim => "an end is more than two steps off the nominal circle",
            ArcError::Plane => "the plane needs two different axes of the machine",
            ArcError::Wide => "the arc needs a state of 64 bits",
            ArcError::Unequal => "the steps of the axes of the plane differ too much",
        })
    }
}

impl core::error::Error for ArcError {}

/// Number of fraction bits for the centre of an arc of `radius_blu`. As many as a 32-bit state
/// allows, at most 16. Where that would be less than 4, it is 16 with a 64-bit state.
pub const fn fraction_bits_for(radius_blu: u64) -> u8 {
    let reach = radius_blu.saturating_add(4);
    let mut bits = 16;
    while bits >= 4 {
        if reach <= MAX_NARROW >> bits {
            return bits;
        }
        bits = bits.wrapping_sub(1);
    }
    16
}

/// A circular arc of axes 0 and 1. Each event goes to the nearest point of the next row or column;
/// this takes two sign tests and a few additions. The arc ends exactly at `to`.
///
/// | | |
/// | --- | --- |
/// | error | strictly below 1/2 BLU for a whole-step centre and an integer R^2; otherwise at most 0.5 + 2^-f / (4 r); the first point and the run-off to the last point are rounded (0.7071) |
/// | events | at most 1.42 R plus a few per quadrant; a full turn of a whole-step circle has 4 round(sqrt(2) R) |
/// | speed ripple | timed by its sweep: 1/R and a tick; with equal times per event: -10 to +27 % |
/// | state | 152 bytes. The walk has 64 bytes in words of 32 bits ([`Arc::is_narrow`]: R up to 10 829 with 16 fraction bits, up to 2^24 with 5). The rest is for words of 64 bits (up to R = 2^30) and for the sums of the whole move |
/// | cost | 46 instructions per event on Cortex-M0, 39 on Cortex-M4F, 36 on RV32IMAC, in a loop; in words of 64 bits 112, 68 and 76. Set-up takes slightly more than half as many per event. The excess over [`DirectSearch`](crate::DirectSearch) is due to the choice of the width, the changing radius, the least sweep and ends off the circle |
/// | source | Danielsson 1970 and McIlroy 1983 for the choice of the nearest point; the two sign tests and rounded ends are our derivation |
#[derive(Clone, Debug)]
pub struct Arc {
    counted: Counted<Width>,
    radius: u64,
}

#[derive(Clone, Debug)]
enum Width {
    Narrow(Walk<i32>),
    Wide(Walk<i64>),
}

impl Iterator for Width {
    type Item = Step;

    #[inline(always)]
    fn next(&mut self) -> Option<Step> {
        match self {
            Width::Narrow(walk) => walk.next(),
            Width::Wide(walk) => walk.next(),
        }
    }
}

impl Arc {
    /// Prepares an arc. Walks it once to count its events and to sum its sweep.
    ///
    /// # Errors
    /// See [`ArcError`]; nothing is walked then.
    pub fn new(arc: &ArcMove) -> Result<Arc, ArcError> {
        Arc::in_plane(arc, [0, 1], false)
    }

    /// Prepares an arc with 64-bit state, for comparison. The steps are the same as those of
    /// [`Arc::new`].
    ///
    /// # Errors
    /// As [`Arc::new`].
    pub fn wide(arc: &ArcMove) -> Result<Arc, ArcError> {
        Arc::in_plane(arc, [0, 1], true)
    }

    /// Prepares an arc whose steps are those of two axes below 8.
    pub(crate) fn in_plane(arc: &ArcMove, plane: [u32; 2], is_wide: bool) -> Result<Arc, ArcError> {
        let (start, radius, fits_narrow) = start(arc, plane)?;
        let walk = if fits_narrow && !is_wide {
            Width::Narrow(Walk::new(&start))
        } else {
            Width::Wide(Walk::new(&start))
        };
        let totals = match &walk {
            Width::Narrow(walk) => walk.totals(),
            Width::Wide(walk) => walk.totals(),
        };
        let totals = totals.ok_or(ArcError::TooLong)?;
        Ok(Arc {
            counted: Counted::with_totals(walk, totals),
            radius,
        })
    }

    /// Prepares an arc whose totals are known from an arc of the same [`ArcMove`].
    pub(crate) fn with_totals(
        arc: &ArcMove,
        plane: [u32; 2],
        totals: Totals,
    ) -> Result<Arc, ArcError> {
        let (start, radius, fits_narrow) = start(arc, plane)?;
        let walk = if fits_narrow {
            Width::Narrow(Walk::new(&start))
        } else {
            Width::Wide(Walk::new(&start))
        };
        Ok(Arc {
            counted: Counted::with_totals(walk, totals),
            radius,
        })
    }

    /// See [`Helix::directions`](crate::Helix::directions). `None` for words of 64 bits: with the
    /// [`fraction_bits_for`] a radius, only arcs of more than 2^24 steps have them.
    pub(crate) fn directions(&mut self) -> Option<[u8; 2]> {
        match &mut self.counted.walk {
            Width::Narrow(walk) => walk.directions(),
            Width::Wide(_) => None,
        }
    }

    /// See [`Helix::fill`](crate::Helix::fill). `each` takes the sweep and the steps of each event.
    pub(crate) fn fill<'a, const N: usize>(
        &mut self,
        places: impl Iterator<Item = (&'a mut u32, &'a mut [i8; N])>,
        room: u32,
        each: impl FnMut(u32, &mut [i8; N]),
    ) -> Run<N> {
        let Width::Narrow(walk) = &mut self.counted.walk else {
            return Run::NONE;
        };
        let run = walk.fill(places, room, each);
        self.counted.pass(run.events);
        run
    }

    /// Number of events of the whole arc.
    pub const fn events(&self) -> u32 {
        self.counted.events()
    }

    /// Radius in the unit of the sweep: `total_sweep / radius` is the length of the arc in BLU. For
    /// a spiral it is the mean of both ends.
    pub const fn radius(&self) -> u64 {
        self.radius
    }

    /// Fraction bits of sweep and radius. They are those of the centre; there are fewer (even a
    /// negative number) only where the radius would need more than 31 bits.
    pub fn sweep_bits(&self) -> i8 {
        match &self.counted.walk {
            Width::Narrow(walk) => walk.sweep_bits(),
            Width::Wide(walk) => walk.sweep_bits(),
        }
    }

    /// Whether the state is 32 bits wide.
    pub const fn is_narrow(&self) -> bool {
        matches!(self.counted.walk, Width::Narrow(_))
    }

    /// Quadrant changes still to come.
    pub fn quadrants(&self) -> u32 {
        match &self.counted.walk {
            Width::Narrow(walk) => walk.quadrants(),
            Width::Wide(walk) => walk.quadrants(),
        }
    }
}

// In the loop of its caller the state of an arc stays in registers, which halves the cost.
interpolator!(#[inline(always)] [] Arc, counted);

/// A point relative to the centre in 2^-f BLU, rotated into its quadrant.
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
        // |at| <= 2^31 and bits <= 30, so the shift loses nothing.
        let from_centre = |at: i32, centre: i64| {
            shifted(at.into(), bits)
                .checked_sub(centre)
                .filter(|distance| {
                    let distance = distance.unsigned_abs();
                    distance < MAX_SCALED && distance < MAX_RADIUS.wrapping_shl(bits.into())
                })
                .ok_or(ArcError::TooLarge)
        };
        let x = from_centre(at_x, centre_x)?;
        let y = from_centre(at_y, centre_y)?;
        // The walk is counter-clockwise; a clockwise arc is its mirror image.
        let y = if is_clockwise { y.wrapping_neg() } else { y };
        // Below 2^46, so doubling and negating fit.
        let (across, up) = (x.wrapping_add(x), y.wrapping_add(y));
        let (back, down) = (x.wrapping_neg(), y.wrapping_neg());
        let one = shifted(1, bits);
        let minus_one = one.wrapping_neg();
        let (quadrant, u, v) = if across > one && up >= minus_one {
            (0, x, y)
        } else if across <= one && up > one {
            (1, y, back)
        } else if across < minus_one && up <= one {
            (2, back, down)
        } else if across >= minus_one && up < minus_one {
            (3, down, x)
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

    /// |x| + |y|: at least the distance from the centre, below 2^47.
    fn reach(&self) -> u64 {
        self.x.unsigned_abs().wrapping_add(self.y.unsigned_abs())
    }

    /// Distance from the centre in units of 2^`shift`, with `residue` subtracted from its square.
    fn radius(&self, shift: u8, residue: i64, bits: u8) -> u64 {
        let square = |value: i64| {
            let value = value.unsigned_abs().wrapping_shr(shift.into());
            value.wrapping_mul(value)
        };
        // |x| + |y| < 2^31 in this unit, so the sum of the squares is below 2^62.
        let sum = square(self.x).wrapping_add(square(self.y)) as i64;
        // The residue times 2^f, in the square of the unit: at most 4 (r + 4) 2^2f. This is below
        // 2^63 because (r + 4) 2^f < 2^32, or the unit compensates for it.
        let excess = u32::from(bits).wrapping_sub(u32::from(shift).wrapping_mul(2)) as i32;
        let scaled = if excess < 0 {
            residue.wrapping_shr(excess.unsigned_abs().min(63))
        } else {
            residue.saturating_mul(shifted(1, excess as u8))
        };
        square_root(sum.saturating_sub(scaled).max(0).unsigned_abs())
    }
}

/// `value` 2^`bits`.
const fn shifted(value: i64, bits: u8) -> i64 {
    value.wrapping_shl(bits as u32)
}

/// Computes the start state of the walk, the radius in sweep units, and whether 32 bits hold the
/// state.
///
/// All arithmetic here wraps in name only: coordinates and radii are below 2^47, see [`Spot::new`].
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) fn start(arc: &ArcMove, plane: [u32; 2]) -> Result<(Start, u64, bool), ArcError> {
    let bits = arc.fraction_bits;
    if bits > 30 {
        return Err(ArcError::FractionBits);
    }
    let one = shifted(1, bits);
    let is_clockwise = arc.direction == Direction::Clockwise;
    let from = Spot::new(arc.from, arc.centre, bits, is_clockwise)?;
    let to = Spot::new(arc.to, arc.centre, bits, is_clockwise)?;

    // Limits radii to 31 bits, so that sweeps are below 2^32 and squares fit in 64 bits. At
    // most 16.
    let reach = from.reach().max(to.reach());
    let shift = 33_u32.saturating_sub(reach.leading_zeros()) as u8;
    let first = from.radius(shift, 0, bits);
    let last = to.radius(shift, 0, bits);
    let larger = first.max(last).wrapping_shl(shift.into());
    let larger_blu = larger.wrapping_shr(bits.into());
    if larger_blu >= MAX_RADIUS {
        return Err(ArcError::TooLarge);
    }

    let quadrants = quadrants(&from, &to, arc);
    // A quadrant has about 1.42 r events; this bounds the dry pass.
    let bound = larger_blu.wrapping_add(2).saturating_mul(quadrants.max(1));
    if bound.saturating_add(bound / 2) > MAX_EVENTS {
        return Err(ArcError::TooLong);
    }

    let (start_residue, end_residue) = match arc.rim {
        Rim::Spiral => (0, 0),
        Rim::Nominal { start, end } => (start, end),
    };
    // A point at distance e from the circle has a residue of about 2 r e.
    let reach = larger.wrapping_add(shifted(4, bits).unsigned_abs());
    let most = reach.wrapping_mul(4);
    if start_residue.unsigned_abs() > most || end_residue.unsigned_abs() > most {
        return Err(ArcError::OffRim);
    }
    let change = radius_change(&from, &to, arc)
        .and_then(|change| change.checked_sub(end_residue))
        .and_then(|change| change.checked_add(start_residue))
        .ok_or(ArcError::TooLarge)?;
    let mean_radius = mean(first, last).wrapping_shl(shift.into());
    let (spread, quotient) = spread(&from, &to, change, quadrants, mean_radius, bits)?;
    let radius = match arc.rim {
        Rim::Spiral => mean(first, last),
        Rim::Nominal { .. } => from.radius(shift, start_residue, bits),
    }
    .max(1);

    let (toward_u, toward_v) = toward(plane, from.quadrant, is_clockwise);
    let difference = |coordinate: i64| one.wrapping_add(coordinate).wrapping_add(coordinate);
    let start = Start {
        residue: start_residue,
        du: difference(from.u.wrapping_neg()),
        dv: difference(from.v),
        du_end: difference(to.u.wrapping_neg()),
        dv_end: difference(to.v),
        one,
        // Below 2^31, like the number of events.
        quadrants: quadrants as u32,
        toward_u,
        toward_v,
        spread,
        quotient,
        // A step that crosses the curve instead of following it takes the time of half a step.
        least_sweep: (radius.wrapping_shl(shift.into()) / 2).max(1) as i64,
        sweep_shift: shift,
    };
    let is_narrow = fits_narrow(&start, reach);
    Ok((start, radius, is_narrow))
}

/// Whether 32 bits hold the state of a walk; `reach` is its radius and four BLU.
#[inline]
fn fits_narrow(start: &Start, reach: u64) -> bool {
    // A spiral of slope s crosses the axes of the circle at this slope, but the steps of a quadrant
    // go in two directions only. So it lags there by r s^2 / 2, and F by r^2 s^2 2^f. With a change
    // q of F per step, r s is q / 2^(f + 1). Taken twice.
    // A change of 2^31 and more is too large by itself. So the square is at most 2^62.
    let change = start.quotient.unsigned_abs().min(1 << 31);
    let lag = (change.wrapping_mul(change) >> 1).wrapping_shr(start.one.trailing_zeros());
    // The state needs 3 (r + 4) 2^f plus the change of radius over a few steps, plus the lag.
    let needed = reach
        .wrapping_mul(3)
        .wrapping_add(change.wrapping_mul(4))
        .wrapping_add(lag);
    let after_u = start.residue.wrapping_add(start.du);
    let after_v = start.residue.wrapping_add(start.dv);
    reach <= MAX_NARROW
        && needed <= MAX_STATE
        && after_u.unsigned_abs() <= MAX_STATE
        && after_v.unsigned_abs() <= MAX_STATE
        && after_u.wrapping_add(start.dv).unsigned_abs() <= MAX_STATE
}

/// The u-step and the v-step of a quadrant. The u-step of the quadrants is (-1, 0), (0, -1),
/// (1, 0), (0, 1). The v-step is the previous u-step, reversed.
#[inline]
fn toward([first, second]: [u32; 2], quadrant: u8, is_clockwise: bool) -> (Toward, Toward) {
    let along_x = |is_negative: bool| Toward::new(first, is_negative);
    let along_y = |is_negative: bool| Toward::new(second, is_negative != is_clockwise);
    match quadrant {
        0 => (along_x(true), along_y(false)),
        1 => (along_y(true), along_x(true)),
        2 => (along_x(false), along_y(true)),
        _ => (along_y(false), along_x(false)),
    }
}

/// The vector from the first to the last point in BLU, mirrored like the walk. Differences of two
/// `i32`: 33 bits.
fn chord(arc: &ArcMove) -> [i64; 2] {
    let ([from_x, from_y], [to_x, to_y]) = (arc.from.map(i64::from), arc.to.map(i64::from));
    let up = to_y.wrapping_sub(from_y);
    let is_clockwise = arc.direction == Direction::Clockwise;
    [
        to_x.wrapping_sub(from_x),
        if is_clockwise { up.wrapping_neg() } else { up },
    ]
}

/// Product of 47 by 33 bits: a 128-bit multiplication, used a few times per arc.
fn product(one: i64, other: i64) -> i128 {
    i128::from(one).wrapping_mul(other.into())
}

/// Number of quadrant changes on the arc.
fn quadrants(from: &Spot, to: &Spot, arc: &ArcMove) -> u64 {
    let changes = u64::from(to.quadrant.wrapping_sub(from.quadrant) & 3);
    let [chord_x, chord_y] = chord(arc);
    // from x to = from x chord: the sign tells whether the end is ahead in the same quadrant.
    let is_ahead = product(from.x, chord_y) > product(from.y, chord_x);
    let shortest = if changes == 0 && !is_ahead {
        4
    } else {
        changes
    };
    // turns < 2^32.
    shortest.wrapping_add(u64::from(arc.turns).wrapping_mul(4))
}

/// (|to - C|^2 - |from - C|^2) / 2^f, computed as (to - from) (to + from - 2 C). No square and no
/// division is needed.
fn radius_change(from: &Spot, to: &Spot, arc: &ArcMove) -> Option<i64> {
    let [chord_x, chord_y] = chord(arc);
    let sum = product(from.x.wrapping_add(to.x), chord_x)
        .wrapping_add(product(from.y.wrapping_add(to.y), chord_y));
    i64::try_from(sum).ok()
}

/// Spreads the change of the residue of a spiral evenly over its events: the remainder, and the
/// whole part per event.
fn spread(
    from: &Spot,
    to: &Spot,
    change: i64,
    quadrants: u64,
    mean_radius: u64,
    bits: u8,
) -> Result<(Spread, i64), ArcError> {
    // r / sqrt(2), the height of an octant. r < 2^47, so the product is below 2^63.
    let height = (mean_radius.wrapping_mul(46341) >> 16) as i64;
    let octants = height.wrapping_add(height);
    let place = |spot: &Spot| {
        if spot.v <= spot.u {
            spot.v
        } else {
            octants.wrapping_sub(spot.u)
        }
    };
    // quadrants (r + 2) <= 2^31 in BLU, so this is below 2^62 in 2^-f BLU.
    let travel = (quadrants as i64)
        .wrapping_mul(octants)
        .wrapping_add(place(to))
        .wrapping_sub(place(from));
    let whole = travel.wrapping_shr(bits.into());
    let steps = if whole <= 2 {
        1
    } else {
        whole
            .wrapping_sub(1)
            .wrapping_sub((quadrants / 2) as i64)
            .max(1)
    };
    // At most 1.42 quadrants (r + 2) < 2^31.
    let steps = u32::try_from(steps).map_err(|_| ArcError::TooLong)?;
    let quotient = change.checked_div_euclid(steps.into()).unwrap_or(0);
    let spread = Spread {
        left: if change == 0 { 0 } else { steps },
        steps,
        // change - quotient steps is the remainder, below steps.
        remainder: change.wrapping_sub(quotient.wrapping_mul(steps.into())) as u32,
        phase: 0,
    };
    Ok((spread, quotient))
}

/// Mean of two values below 2^63, rounded down.
const fn mean(one: u64, other: u64) -> u64 {
    one.wrapping_add(other) >> 1
}
