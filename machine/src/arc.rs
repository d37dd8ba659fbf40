//! A programmed arc in nanometres to the arc of the interpolator in steps.

use husillo_gcode::{Arc, Direction, Nm};
use husillo_interp::{ArcMove, Rim, fraction_bits_for};

use crate::{MoveError, Scale, duration::length};

/// Largest radius in steps: `(r + 4) * 2^f` stays within the interpolator's proof.
const MAX_RADIUS_STEPS: u64 = 1 << 28;

/// What the interpolator is to do for an arc.
pub(crate) enum Course {
    /// Walk round; the radius in steps.
    Round(ArcMove, u32),
    /// Too short to go round anything on this grid: straight to the end.
    Straight,
}

/// The two plane coordinates of a position.
pub(crate) fn in_plane<T: Copy + Default, const N: usize>(
    of: &[T; N],
    plane: [usize; 2],
) -> [T; 2] {
    plane.map(|axis| of.get(axis).copied().unwrap_or_default())
}

/// Vector from the centre to a point, in nanometres.
pub(crate) fn from_centre(point: [Nm; 2], centre: [Nm; 2]) -> [i64; 2] {
    let [x, y] = point;
    let [i, j] = centre;
    [x.0.saturating_sub(i.0), y.0.saturating_sub(j.0)]
}

/// A product of 128 bits: on a small chip a long piece of code, which is there once.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn product(a: i64, b: i64) -> i128 {
    a as i128 * b as i128
}

/// Twice the signed area of two vectors; the products are below 2^127.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn cross([ax, ay]: [i64; 2], [bx, by]: [i64; 2]) -> i128 {
    product(ax, by).wrapping_sub(product(ay, bx))
}

/// Radius of a vector, nanometres.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) fn radius([x, y]: [i64; 2]) -> u64 {
    length(&[x.unsigned_abs()], y.unsigned_abs())
}

/// Lowest and highest coordinate of the arc in each axis of its plane, machine frame.
pub(crate) fn arc_extent<const N: usize>(from: &[Nm; N], arc: &Arc<N>) -> [[Nm; 2]; 2] {
    let plane = arc.plane.axes();
    let centre = in_plane(&arc.centre, plane);
    let ends = [in_plane(from, plane), in_plane(&arc.to, plane)];
    let [start, end] = ends.map(|point| from_centre(point, centre));
    let rim = radius(start).max(radius(end)).min(i64::MAX as u64) as i64;
    let swept = |cardinal| arc.turns > 0 || sweeps(start, end, arc.direction, cardinal);
    let [[x0, y0], [x1, y1]] = ends;
    let [cx, cy] = centre;
    let span = |a: Nm, b: Nm, c: Nm, low: bool, high: bool| {
        let (mut least, mut most) = (a.0.min(b.0), a.0.max(b.0));
        if low {
            least = least.min(c.0.saturating_sub(rim));
        }
        if high {
            most = most.max(c.0.saturating_add(rim));
        }
        [Nm(least), Nm(most)]
    };
    [
        span(x0, x1, cx, swept([-1, 0]), swept([1, 0])),
        span(y0, y1, cy, swept([0, -1]), swept([0, 1])),
    ]
}

/// Whether the way from `start` to `end` passes the direction of `through`; a full turn passes all.
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

/// Counter-clockwise from `start`: is `through` met no later than `end`?
fn is_after(start: [i64; 2], through: [i64; 2], end: [i64; 2]) -> bool {
    let half = |point| -> bool {
        let side = cross(start, point);
        side < 0 || (side == 0 && !is_ahead(start, point))
    };
    match (half(through), half(end)) {
        (false, true) => true,
        (true, false) => false,
        // In the same half turn: through must not be beyond the end.
        _ => cross(through, end) >= 0,
    }
}

#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn is_ahead([ax, ay]: [i64; 2], [bx, by]: [i64; 2]) -> bool {
    product(ax, bx).wrapping_add(product(ay, by)) > 0
}

/// The arc on the grid, its start moved to the origin.
///
/// `lattice` are the steps on which the axes of the plane stand and shall stand.
///
/// # Errors
/// When the radius is 2^28 steps or more.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) fn course<const N: usize>(
    from: &[Nm; N],
    arc: &Arc<N>,
    scale: Scale,
    lattice: [[i32; 2]; 2],
) -> Result<Course, MoveError> {
    let plane = arc.plane.axes();
    let centre = in_plane(&arc.centre, plane);
    let points = [in_plane(from, plane), in_plane(&arc.to, plane)];
    let [start, end] = points.map(|point| from_centre(point, centre));
    let radius_nm = Nm(radius(start).max(radius(end)).min(i64::MAX as u64) as i64);
    let radius_steps = match scale.nearest(radius_nm) {
        Some(steps) if u64::from(steps.unsigned_abs()) < MAX_RADIUS_STEPS => steps.unsigned_abs(),
        _ => return Err(MoveError::ArcTooLarge),
    };
    let bits = fraction_bits_for(u64::from(radius_steps));
    let [[ax, ay], [bx, by]] = lattice;
    // Both ends are within 2 * 2^28 steps of each other, unless the programmed radii lie about it.
    let to = [bx.wrapping_sub(ax), by.wrapping_sub(ay)];
    let [centre_x, centre_y] = centre.map(|at| scale.nearest_fraction(at, bits));
    let (Some(centre_x), Some(centre_y)) = (centre_x, centre_y) else {
        return Err(MoveError::ArcTooLarge);
    };
    // 2^31 steps with at most 16 fraction bits: 47 bits.
    let centre = [
        centre_x.wrapping_sub(i64::from(ax) << bits),
        centre_y.wrapping_sub(i64::from(ay) << bits),
    ];
    let mut turns = arc.turns;
    let spoke = centre.map(i64::wrapping_neg);
    if let Some(short) = nearly_closed(spoke, to, start, end, arc.direction) {
        if short && turns == 0 {
            return Ok(Course::Straight);
        }
        // The grid sees a hop forward as short and anything else as a whole turn; the program decides.
        if !short {
            turns = turns.saturating_add(1);
        }
        if to == [0, 0] || !is_forward(centre.map(i64::wrapping_neg), to, arc.direction) {
            turns = turns.saturating_sub(1);
        }
    }
    let half_step = arc
        .mismatch
        .0
        .unsigned_abs()
        .saturating_mul(2 * u64::from(scale.steps()));
    let rim = if half_step <= u64::from(scale.nm()) {
        nominal(start, centre, to, scale, bits)
    } else {
        Rim::Spiral
    };
    let round = ArcMove {
        from: [0, 0],
        to,
        centre,
        fraction_bits: bits,
        direction: match arc.direction {
            Direction::Clockwise => husillo_interp::Direction::Clockwise,
            Direction::CounterClockwise => husillo_interp::Direction::CounterClockwise,
        },
        turns,
        rim,
    };
    Ok(Course::Round(round, radius_steps))
}

/// For ends that lie within a step and a half of one spoke on the grid (the second one may be further in or out): whether the exact arc is the short way
/// (`Some(true)`) or a whole turn (`Some(false)`); the grid alone cannot tell.
fn nearly_closed(
    spoke: [i64; 2],
    to: [i32; 2],
    start: [i64; 2],
    end: [i64; 2],
    direction: Direction,
) -> Option<bool> {
    // How far beside the spoke, times the spoke's length; both have the centre's fraction bits.
    let beside = cross(spoke, to.map(i64::from)).unsigned_abs();
    let length = u128::from(radius(spoke));
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

/// Whether a hop from `start` by `to` goes round the centre in the direction of the arc.
fn is_forward(start: [i64; 2], [dx, dy]: [i32; 2], direction: Direction) -> bool {
    let turn = cross(start, [i64::from(dx), i64::from(dy)]);
    match direction {
        Direction::CounterClockwise => turn > 0,
        Direction::Clockwise => turn < 0,
    }
}

/// The values of F at both ends for a circle through the exact start.
///
/// With V the vector from the fixed-point centre to the start on the grid and e = V - P its rounding
/// residual, `F_S = |V|^2 - |P|^2 = 2 e.V - e^2`: R^2 is never formed. `e` is at most one step and is kept
/// with `g` fraction bits such that `2 * |V| 2^f * 2^g < 2^61`; the error in F, `|V| 2^-g`, moves the circle
/// by less than `2^-g` steps.
fn nominal(start: [i64; 2], centre: [i64; 2], to: [i32; 2], scale: Scale, bits: u8) -> Rim {
    let [cx, cy] = centre;
    let grid = [cx.wrapping_neg(), cy.wrapping_neg()];
    let reach = grid.iter().fold(1u64, |most, v| most.max(v.unsigned_abs()));
    let residual_bits = reach.leading_zeros().saturating_sub(4).min(24) as u8;
    let extra = residual_bits.saturating_sub(bits);
    let part = |grid: i64, exact: i64| -> i64 {
        let exact = scale
            .nearest_fraction(Nm(exact), bits.wrapping_add(extra))
            .unwrap_or(0);
        let residual = (grid << extra).wrapping_sub(exact);
        let product = grid.wrapping_mul(residual).wrapping_mul(2);
        let square = residual.wrapping_mul(residual) >> extra;
        product.wrapping_sub(square)
    };
    let [gx, gy] = grid;
    let [px, py] = start;
    // `residual` has `bits + extra` fraction bits, `grid` has `bits`: together 2^bits too many for F.
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
