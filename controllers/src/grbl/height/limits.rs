//! Rates and accelerations with which Z can follow the surface.

use husillo_gcode::Nm;
use husillo_machine::{Axis, Config};

use super::map::HeightMap;

/// One, in the unit of slopes.
const ONE: u64 = 1_000_000;
/// Least deviation at the edge of a cell, in nanometres.
const LEAST_DEVIATION_NM: i64 = 1000;

/// Shape of a map along X or Y, in millionths.
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    /// Steepest slope.
    slope: u64,
    /// Largest change of the slope from cell to cell. The surface is level outside the grid.
    bend: u64,
}

/// Limits the axes to what Z can follow, takes from Z what the map needs at most, and keeps the
/// corrected position within the travel.
///
/// Along X and Y together, the slopes take up to one half of the rate of Z, and one quarter of its
/// acceleration; the twist of a cell takes up to another quarter. At the edge of a cell Z changes
/// its speed as at a corner within the permitted deviation.
pub(super) fn limit(map: &HeightMap, config: &mut Config<3>) {
    let deviation = config.corner_deviation.map_or(0, |nm| nm.0);
    let deviation = deviation.max(LEAST_DEVIATION_NM).unsigned_abs();
    let [x, y, z] = &mut config.axes;
    let (rate, acceleration) = (rate_of(z), acceleration_of(z));
    let jump = acceleration.saturating_mul(deviation.saturating_mul(8));
    let jump = jump.isqrt();
    let square = twist_square(map, acceleration);
    let (mut rate_used, mut acceleration_used) = (0_u64, 0_u64);
    let mut rates = [0_u64; 2];
    let axes = [x, y].into_iter().zip(&mut rates);
    for (number, (axis, kept)) in (0_usize..2).zip(axes) {
        let Shape { slope, bend } = shape(map, number);
        let most = over(rate, slope.saturating_mul(4))
            .min(over(jump, bend.saturating_mul(2)))
            .min(square.map_or(u64::MAX, u64::isqrt));
        let most_acceleration = over(acceleration, slope.saturating_mul(8));
        *kept = rate_of(axis).min(most);
        let own = acceleration_of(axis).min(most_acceleration);
        rate_used = rate_used.saturating_add(part(*kept, slope));
        acceleration_used = acceleration_used.saturating_add(part(own, slope));
        set_limits(axis, most, most_acceleration);
    }
    if let Some(square) = square {
        let [x, y] = rates;
        let share = x.saturating_mul(y).checked_div(square / ONE);
        let share = share.unwrap_or(ONE).min(ONE);
        acceleration_used = acceleration_used.saturating_add(part(acceleration / 4, share));
    }
    set_limits(
        z,
        rate.saturating_sub(rate_used),
        acceleration.saturating_sub(acceleration_used),
    );
    let [lowest, highest] = map.range();
    if let Some([least, most]) = &mut z.travel {
        *least = Nm(least.0.saturating_sub(lowest));
        *most = Nm(most.0.saturating_sub(highest));
    }
}

/// Returns `whole / part` for a part in millionths.
fn over(whole: u64, part: u64) -> u64 {
    let whole = whole.saturating_mul(ONE);
    whole.checked_div(part).unwrap_or(u64::MAX)
}

/// Returns millionths of `whole`, rounded up.
fn part(whole: u64, millionths: u64) -> u64 {
    whole.saturating_mul(millionths).div_ceil(ONE)
}

/// Returns the width of a cell along an axis in nanometres, at least 1.
fn space(map: &HeightMap, axis: usize) -> i64 {
    map.line_nm(axis, 1)
        .saturating_sub(map.line_nm(axis, 0))
        .max(1)
}

/// Returns the shape along X (0) or Y (1).
fn shape(map: &HeightMap, axis: usize) -> Shape {
    let [columns, rows] = map.points;
    let (points, others) = if axis == 0 {
        (columns, rows)
    } else {
        (rows, columns)
    };
    let space = space(map, axis);
    let mut shape = Shape::default();
    for other in 0..others {
        let height = |number: u8| {
            i64::from(if axis == 0 {
                map.height(number, other)
            } else {
                map.height(other, number)
            })
        };
        let mut before = 0_i64;
        for number in 0..points {
            // The slope behind the last point is 0.
            let rise = height(number.saturating_add(1)).saturating_sub(height(number));
            let slope = rise.saturating_mul(1_000_000);
            let slope = slope.checked_div(space).unwrap_or(0);
            let bend = slope.saturating_sub(before).unsigned_abs();
            shape.slope = shape.slope.max(slope.unsigned_abs());
            shape.bend = shape.bend.max(bend);
            before = slope;
        }
    }
    shape
}

/// Returns the largest product of the rates along X and Y, in (nm/s)^2, at which the twist of a
/// cell takes one quarter of an acceleration of Z. `None` without a twist.
fn twist_square(map: &HeightMap, acceleration: u64) -> Option<u64> {
    let [columns, rows] = map.points.map(|points| points.saturating_sub(1));
    let mut twist = 0_u64;
    for row in 0..rows {
        for column in 0..columns {
            let height = |columns: u8, rows: u8| {
                let column = column.saturating_add(columns);
                i64::from(map.height(column, row.saturating_add(rows)))
            };
            let along = [1, 0].map(|rows| height(1, rows).saturating_sub(height(0, rows)));
            let [far, near] = along;
            twist = twist.max(far.saturating_sub(near).unsigned_abs());
        }
    }
    let [width, depth] = [0, 1].map(|axis| space(map, axis).unsigned_abs());
    let part = acceleration.saturating_mul(width);
    let part = part.checked_div(twist.saturating_mul(8))?;
    Some(part.saturating_mul(depth))
}

/// Returns `hz` steps per second in nanometres per second.
fn nm_of(axis: &Axis, hz: u32) -> u64 {
    let nm = u64::from(hz).wrapping_mul(axis.scale.nm().into()); // 64 bits
    nm.checked_div(axis.scale.steps().into()).unwrap_or(0)
}

fn rate_of(axis: &Axis) -> u64 {
    nm_of(axis, axis.max_rate_hz)
}

fn acceleration_of(axis: &Axis) -> u64 {
    let ramp = axis.ramp.as_ref();
    ramp.map_or(0, |ramp| nm_of(axis, ramp.acceleration_hz_per_s))
}

/// Lowers the limits of an axis to a rate in nm/s and an acceleration in nm/s^2.
fn set_limits(axis: &mut Axis, rate: u64, acceleration: u64) {
    let scale = axis.scale;
    let hz = |nm: u64| {
        let steps = nm.saturating_mul(scale.steps().into());
        let hz = steps.checked_div(scale.nm().into()).unwrap_or(0);
        u32::try_from(hz).unwrap_or(u32::MAX).max(1)
    };
    if rate < rate_of(axis) {
        axis.max_rate_hz = hz(rate);
    }
    let own = acceleration_of(axis);
    if let Some(ramp) = &mut axis.ramp {
        if acceleration < own {
            ramp.acceleration_hz_per_s = hz(acceleration);
        }
    }
}
