//! The step response.

use super::stand::{Stand, Trace};
use super::swing::PERIOD_S;
use crate::error::Error;
use husillo_pid::tuning::step_response;
use husillo_transports::nmc::Gains;
use serde::Serialize;

/// Time for which a step is recorded, us.
pub const WATCH_US: u64 = 1_500_000;

/// The figures of a step.
#[derive(Clone, Debug, Serialize)]
pub struct StepFigures {
    /// Position at the start, counts.
    pub from: i32,
    /// Commanded position, counts.
    pub goal: i32,
    /// Rise time from 10 % to 90 %, ms. `None`: it does not reach 90 %.
    pub rise_ms: Option<f64>,
    /// Overshoot beyond the goal, in percent of the step.
    pub overshoot_percent: Option<f64>,
    /// Time until it stays within 1 count of the goal, ms. `None`: it does not settle.
    pub settling_ms: Option<f64>,
    /// Goal minus position at the end, counts.
    pub steady_error: i32,
    /// Largest reading of the motor current, 0 to 255.
    pub peak_current: u8,
}

/// Commands a step of `size` counts with the servo on. Returns its figures and its trace.
///
/// # Errors
///
/// A limit is passed, or the link fails.
pub fn step(stand: &mut Stand, gains: &Gains, size: i32) -> Result<(StepFigures, Trace), Error> {
    stand.engage(gains)?;
    let from = stand.sample(true)?.position;
    // Within the travel: both are far from 2^31.
    let trace = stand.step_to(from + size, WATCH_US)?;
    Ok((figures(&trace, from), trace))
}

/// The figures of a trace that began at `from`.
pub fn figures(trace: &Trace, from: i32) -> StepFigures {
    let goal = trace.target.unwrap_or(from);
    let size = f64::from(goal - from);
    let positions = trace.positions(PERIOD_S);
    let of = |band| step_response(&positions, PERIOD_S, from.into(), goal.into(), band);
    // Positions are whole counts. With this band, 1 count from the goal is settled, and 2 counts
    // are not.
    let settled = of(1.25 / size.abs().max(1.0));
    let whole = of(f64::MAX);
    let ms = |seconds: f64| (seconds * 1e5).round() / 100.0;
    StepFigures {
        from,
        goal,
        rise_ms: whole.map(|found| ms(found.rise_s)),
        overshoot_percent: whole.map(|found| (found.overshoot * 1e4).round() / 100.0),
        settling_ms: settled.map(|found| ms(found.settling_s)),
        steady_error: trace.samples.last().map_or(0, |last| goal - last.position),
        peak_current: trace.samples.iter().map(|s| s.current).max().unwrap_or(0),
    }
}
