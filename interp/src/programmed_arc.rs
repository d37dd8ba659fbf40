//! Conversion of an arc in nanometres to an arc in steps.

use crate::length::length;
use crate::{ArcError, ArcMove, Direction, Rim, Scale, fraction_bits_for};

/// Largest radius in steps: `(r + 4) * 2^f` stays within the proof of [`Arc`](crate::Arc).
const MAX_RADIUS_STEPS: u64 = 1 << 28;

/// An arc as programmed: exact positions in nanometres of the two axes of its plane.
///
/// Both axes have steps of the same length. For a helix this is the arc in its plane; the other
/// axes are not part of it.
///
/// # Examples
/// A quarter turn with 107 steps per millimetre:
/// ```
/// use husillo_interp::{Arc, Direction, ProgrammedArc, Scale};
///
/// let scale = Scale::new(1_000_000, 107).unwrap();
/// let quarter = ProgrammedArc {
///     from: [10_000_000, 0],
///     to: [0, 10_000_000],
///     centre: [0, 0],
///     direction: Direction::from_clockwise(false),
///     turns: 0,
///     mismatch_nm: 0,
/// };
/// assert_eq!(quarter.extent(), [[0, 10_000_000], [0, 10_000_000]]);
/// let steps = [quarter.from, quarter.to].map(|at| at.map(|nm| scale.nearest(nm).unwrap()));
/// let grid = quarter.on_grid(scale, steps)?;
/// let arc = Arc::new(&grid.arc)?;
/// assert_eq!(arc.map(|step| i32::from(step.delta(1))).sum::<i32>(), 1070);
/// # Ok::<(), husillo_interp::ArcError>(())
/// ```
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ProgrammedArc {
    /// First point in nm.
    pub from: [i64; 2],
    /// Last point in nm; in the same direction from the centre as `from` it means a full turn.
    pub to: [i64; 2],
    /// Centre in nm.
    pub centre: [i64; 2],
    /// Sense of rotation.
    pub direction: Direction,
    /// Complete turns in addition to the angle from `from` to `to`.
    pub turns: u32,
    /// Difference of the radii at both ends in nm. Up to half a step the path is the circle through
    /// `from`; beyond that it is a spiral. [`as_circle`](ProgrammedArc::as_circle) moves the centre
    /// instead.
    pub mismatch_nm: u64,
}

/// A [`ProgrammedArc`] on the step grid of its axes.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GridArc {
    /// The move, in steps from its first point.
    pub arc: ArcMove,
    /// The larger radius of its ends, rounded to the nearest step; below 2^28.
    pub radius_steps: u32,
}

impl ProgrammedArc {
    /// The vectors from the centre to the first and to the last point, in nanometres.
    pub fn spokes(&self) -> [[i64; 2]; 2] {
        let [x, y] = self.centre;
        [self.from, self.to].map(|[at_x, at_y]| [at_x.saturating_sub(x), at_y.saturating_sub(y)])
    }

    /// The distances of the first and the last point from the centre in nanometres, accurate to
    /// half a nanometre or 2^-28 of the distance.
    pub fn radii(&self) -> [u64; 2] {
        self.spokes().map(size)
    }

    /// Lowest and highest coordinate of the path in each of the two axes, in nanometres.
    ///
    /// For a spiral these are the values of the circle with the larger radius.
    pub fn extent(&self) -> [[i64; 2]; 2] {
        let [start, end] = self.spokes();
        let rim = larger_radius(start, end);
        let sweeps = |cardinal| self.turns > 0 || sweeps(start, end, self.direction, cardinal);
        let ([x0, y0], [x1, y1], [cx, cy]) = (self.from, self.to, self.centre);
        let span = |a: i64, b: i64, c: i64, low: bool, high: bool| {
            let (mut least, mut most) = (a.min(b), a.max(b));
            if low {
                least = least.min(c.saturating_sub(rim));
            }
            if high {
                most = most.max(c.saturating_add(rim));
            }
            [least, most]
        };
        [
            span(x0, x1, cx, sweeps([-1, 0]), sweeps([1, 0])),
            span(y0, y1, cy, sweeps([0, -1]), sweeps([0, 1])),
        ]
    }

    /// Converts the arc to the grid, with its first point at the origin.
    ///
    /// `steps` are the positions of the axes at both ends, normally [`Scale::nearest`] of both
    /// ends. Ends on one spoke may round to steps on different spokes, or to the same step. The
    /// exact positions then decide whether the arc is short or a whole turn.
    ///
    /// The centre keeps the fraction bits of [`fraction_bits_for`]. A circle passes through the
    /// exact first point. Its squared radius is never formed: the residues are rounded to nearest,
    /// which gives the smaller bound of [`Rim::Nominal`].
    ///
    /// # Errors
    /// [`ArcError::Degenerate`] where the arc is too short to have a direction on this grid; use a
    /// line instead. [`ArcError::TooLarge`] where the radius is 2^28 steps or more, or the centre
    /// is 2^31 steps or more from zero.
    ///
    /// # Cost
    /// About fifteen products of 64 and 128 bits, three roots and five divisions of 64 bits.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub fn on_grid(&self, scale: Scale, steps: [[i32; 2]; 2]) -> Result<GridArc, ArcError> {
        let [start, end] = self.spokes();
        let radius_steps = match scale.nearest(larger_radius(start, end)) {
            Some(steps) if u64::from(steps.unsigned_abs()) < MAX_RADIUS_STEPS => {
                steps.unsigned_abs()
            }
            _ => return Err(ArcError::TooLarge),
        };
        let bits = fraction_bits_for(u64::from(radius_steps));
        let [[ax, ay], [bx, by]] = steps;
        // Both ends are within 2 * 2^28 steps of each other, unless the programmed radii are wrong.
        let to = [bx.wrapping_sub(ax), by.wrapping_sub(ay)];
        let [centre_x, centre_y] = self.centre.map(|at| scale.nearest_fraction(at, bits));
        let (Some(centre_x), Some(centre_y)) = (centre_x, centre_y) else {
            return Err(ArcError::TooLarge);
        };
        // 2^31 steps with at most 16 fraction bits have 47 bits.
        let centre = [
            centre_x.wrapping_sub(i64::from(ax) << bits),
            centre_y.wrapping_sub(i64::from(ay) << bits),
        ];
        let mut turns = self.turns;
        let spoke = centre.map(i64::wrapping_neg);
        if let Some(short) = nearly_closed(spoke, to, start, end, self.direction) {
            if short && turns == 0 {
                return Err(ArcError::Degenerate);
            }
            // The grid takes a small forward step as a short arc and everything else as a whole
            // turn; the program decides.
            if !short {
                turns = turns.saturating_add(1);
            }
            if to == [0, 0] || !is_forward(spoke, to, self.direction) {
                turns = turns.saturating_sub(1);
            }
        }
        let half_step = self
            .mismatch_nm
            .saturating_mul(2 * u64::from(scale.steps()));
        let rim = if half_step <= u64::from(scale.nm()) {
            nominal(start, centre, to, scale, bits)
        } else {
            Rim::Spiral
        };
        Ok(GridArc {
            arc: ArcMove {
                from: [0, 0],
                to,
                centre,
                fraction_bits: bits,
                direction: self.direction,
                turns,
                rim,
            },
            radius_steps,
        })
    }
}

/// Size of a vector.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) fn size([x, y]: [i64; 2]) -> u64 {
    length(&[x.unsigned_abs()], y.unsigned_abs())
}

/// The larger distance from the centre.
fn larger_radius(start: [i64; 2], end: [i64; 2]) -> i64 {
    size(start).max(size(end)).min(i64::MAX as u64) as i64
}

/// A product of 128 bits. On a small processor it is a long piece of code, so it exists only once.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) fn product(a: i64, b: i64) -> i128 {
    a as i128 * b as i128
}

/// Twice the signed area between two vectors; the products are below 2^127.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) fn cross([ax, ay]: [i64; 2], [bx, by]: [i64; 2]) -> i128 {
    product(ax, by).wrapping_sub(product(ay, bx))
}

/// The scalar product of two vectors; the products are below 2^127.
pub(crate) fn dot([ax, ay]: [i64; 2], [bx, by]: [i64; 2]) -> i128 {
    product(ax, bx).wrapping_add(product(ay, by))
}

/// Whether the arc from `start` to `end` passes the direction of `through`; a full turn passes all.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn sweeps(start: [i64; 2], end: [i64; 2], direction: Direction, through: [i64; 2]) -> bool {
    let (start, end) = match direction {
        Direction::CounterClockwise => (start, end),
        Direction::Clockwise => (end, start),
    };
    if start == end {
        return true;
    }
    let after_start = is_after(start, through, end);
    let turn = cross(start, end);
    if turn == 0 && is_ahead(start, end) {
        // Unequal radii in the same direction: a full turn.
        return true;
    }
    after_start
}

/// Whether `through` is reached no later than `end`, counter-clockwise from `start`.
fn is_after(start: [i64; 2], through: [i64; 2], end: [i64; 2]) -> bool {
    let half = |point| -> bool {
        let side = cross(start, point);
        side < 0 || (side == 0 && !is_ahead(start, point))
    };
    match (half(through), half(end)) {
        (false, true) => true,
        (true, false) => false,
        // In the same half turn, through must not be beyond the end.
        _ => cross(through, end) >= 0,
    }
}

#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn is_ahead(a: [i64; 2], b: [i64; 2]) -> bool {
    dot(a, b) > 0
}

/// For ends within a step and a half of one spoke on the grid, at any distance from the centre. The
/// grid alone cannot tell a short arc from a whole turn there. Returns `Some(true)` where the exact
/// arc is short and `Some(false)` where it is a whole turn.
fn nearly_closed(
    spoke: [i64; 2],
    to: [i32; 2],
    start: [i64; 2],
    end: [i64; 2],
    direction: Direction,
) -> Option<bool> {
    // Distance from the spoke, times the length of the spoke; both have the fraction bits of the
    // centre.
    let beside = cross(spoke, to.map(i64::from)).unsigned_abs();
    let length = u128::from(size(spoke));
    if beside > length.saturating_add(length / 2) {
        return None;
    }
    if start == end {
        return Some(false);
    }
    let turn = cross(start, end);
    let turn = match direction {
        Direction::CounterClockwise => turn,
        Direction::Clockwise => turn.wrapping_neg(),
    };
    // Ends on opposite sides of a tiny circle are neither.
    is_ahead(start, end).then_some(turn > 0)
}

/// Whether a small step from `start` by the given vector goes around the centre in the direction of
/// the arc.
fn is_forward(start: [i64; 2], [dx, dy]: [i32; 2], direction: Direction) -> bool {
    let turn = cross(start, [i64::from(dx), i64::from(dy)]);
    match direction {
        Direction::CounterClockwise => turn > 0,
        Direction::Clockwise => turn < 0,
    }
}

/// The values of F at both ends for a circle through the exact start.
///
/// Let V be the vector from the fixed-point centre to the start on the grid, and e = V - P its
/// rounding residual. Then `F_S = |V|^2 - |P|^2 = 2 e.V - e^2`, so R^2 is never formed. `e` is at
/// most one step and is kept with `g` fraction bits such that `2 * |V| 2^f * 2^g < 2^61`. The error
/// in F is `|V| 2^-g`; it moves the circle by less than `2^-g` steps.
fn nominal(start: [i64; 2], centre: [i64; 2], to: [i32; 2], scale: Scale, bits: u8) -> Rim {
    let [cx, cy] = centre;
    let grid = [cx.wrapping_neg(), cy.wrapping_neg()];
    let reach = grid.iter().fold(1u64, |most, v| most.max(v.unsigned_abs()));
    let residual_bits = reach.leading_zeros().saturating_sub(4).min(24) as u8;
    let extra = residual_bits.saturating_sub(bits);
    let part = |grid: i64, exact: i64| -> i64 {
        let exact = scale
            .nearest_fraction(exact, bits.wrapping_add(extra))
            .unwrap_or(0);
        let residual = (grid << extra).wrapping_sub(exact);
        let product = grid.wrapping_mul(residual).wrapping_mul(2);
        let square = residual.wrapping_mul(residual) >> extra;
        product.wrapping_sub(square)
    };
    let [gx, gy] = grid;
    let [px, py] = start;
    // `residual` has `bits + extra` fraction bits, `grid` has `bits`; together these are 2^bits too
    // many for F.
    let shift = bits.wrapping_add(extra);
    let half = (1i64 << shift) >> 1;
    let sum = part(gx, px).wrapping_add(part(gy, py));
    let at_start = sum.wrapping_add(half) >> shift;
    // F_E - F_S = (|E|^2 - |S|^2) / 2^bits, so that both ends lie on one circle.
    let square = |grid: i64, step: i32| -> i128 {
        let step = (step as i128) << bits;
        step.wrapping_mul((grid as i128).wrapping_mul(2).wrapping_add(step))
    };
    let [dx, dy] = to;
    let half = (1i128 << bits) >> 1;
    let difference = square(gx, dx)
        .wrapping_add(square(gy, dy))
        .wrapping_add(half)
        >> bits;
    Rim::Nominal {
        start: at_start,
        end: at_start.wrapping_add(difference as i64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_sweep_what_they_pass() {
        use Direction::{Clockwise, CounterClockwise};
        let [east, north, west, south] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
        assert!(sweeps(east, north, CounterClockwise, [1, 1]));
        assert!(!sweeps(east, north, CounterClockwise, west));
        assert!(sweeps(east, north, Clockwise, west));
        assert!(sweeps(east, north, Clockwise, south));
        assert!(!sweeps(east, north, Clockwise, [1, 1]));
        assert!(sweeps(east, east, Clockwise, west));
        assert!(sweeps(east, west, CounterClockwise, north));
        assert!(!sweeps(east, west, CounterClockwise, south));
        assert!(sweeps([3, 0], [5, 0], CounterClockwise, south));
    }
}
