//! Durations at the rates of the drill.

use super::part::{Part, Stop};
use husillo_controllers::DrillConfig;
use husillo_sim::device::drill::STROKE_STEPS;

/// Seconds of rest after a move or a drilling.
const SETTLE_S: f64 =
    DrillConfig::ORIGINAL.settle_ticks as f64 / DrillConfig::ORIGINAL.timer_hz as f64;

/// The seconds of each drilling of a part, with the move before it. The first move begins at
/// `from`.
pub fn seconds(part: &Part, mut from: [u16; 2]) -> Vec<f64> {
    part.stops()
        .map(|stop| {
            let taken = travel_s(from, stop.at) + drilling_s(stop);
            from = stop.at;
            taken
        })
        .collect()
}

/// Seconds of a move of the table. X moves before Y.
pub fn travel_s(from: [u16; 2], to: [u16; 2]) -> f64 {
    let [x_hz, y_hz, _] = DrillConfig::ORIGINAL.rate_hz.map(f64::from);
    f64::from(from[0].abs_diff(to[0])) / x_hz
        + f64::from(from[1].abs_diff(to[1])) / y_hz
        + 2.0 * SETTLE_S
}

/// Seconds of a drilling: down, up, and the rest after it.
fn drilling_s(stop: Stop) -> f64 {
    let [.., z_hz] = DrillConfig::ORIGINAL.rate_hz.map(f64::from);
    let depth = match stop.depth {
        0 => STROKE_STEPS,
        depth => depth.min(STROKE_STEPS),
    };
    2.0 * f64::from(depth) / z_hz + SETTLE_S
}

/// Steps of X and Y over all drillings of a part from home, and back.
pub fn travel_steps(part: &Part) -> u64 {
    let mut at = [0_u16; 2];
    let mut steps = 0;
    let back = std::iter::once([0_u16; 2]);
    for to in part.stops().map(|stop| stop.at).chain(back) {
        for axis in 0..2 {
            steps += u64::from(at[axis].abs_diff(to[axis]));
        }
        at = to;
    }
    steps
}

/// A duration as text, such as `3 min 20 s`.
pub fn spoken(seconds: f64) -> String {
    let whole = seconds.round().max(0.0) as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, min, s) => format!("{min} min {s} s"),
        (h, min, _) => format!("{h} h {min} min"),
    }
}
