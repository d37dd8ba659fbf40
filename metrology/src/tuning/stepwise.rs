//! Stepwise tuning, as by hand: derivative gain, proportional gain, integral gain, limit of the
//! integral.

use super::fit::STEP_PWM;
use super::moves;
use super::stand::{Stand, Trace};
use super::step::{StepFigures, figures};
use super::swing::Swing;
use super::trial::{LARGEST, Trial};
use crate::error::Error;
use husillo_transports::nmc::Gains;

/// The proportional gain during the search for the derivative gain. It moves the axis back to its
/// goal.
const FIRST_P: u16 = 100;
const FIRST_D: u16 = 1000;
const FIRST_I: u16 = 50;
/// The limit of the integral during the search for the integral gain.
const WIDE_LIMIT: u16 = 16_000;
/// Time for which a step of a trial is recorded, us.
const TRIAL_US: u64 = 900_000;
/// Largest accepted overshoot, per cent.
const OVERSHOOT_PERCENT: f64 = 25.0;
/// Number of moves that check a limit.
const MOVES: u32 = 9;

/// Upper bounds of the searches for gains, for an axis that does not vibrate. Beyond them, single
/// counts of the encoder would drive the motor. So higher gains do not improve a servo whose
/// friction prevents an oscillation.
#[derive(Clone, Copy)]
struct Bounds {
    derivative: u16,
    proportional: u16,
    integral: u16,
}

impl Bounds {
    /// At the bounds, a motion of one count in a sample makes a quarter of the full drive, and an
    /// error of eight counts makes the full drive. A step of the integral makes [`STEP_PWM`].
    fn new(output_limit: u8) -> Self {
        // 255 * 256 = 65280.
        let full = u16::from(output_limit) * 256;
        Self {
            derivative: (full / 4).clamp(FIRST_D, LARGEST),
            proportional: (full / 8).clamp(FIRST_P, LARGEST),
            integral: STEP_PWM as u16 * 256,
        }
    }
}

/// A gain that a search has found.
struct Raised {
    /// Half of the last gain that was tried.
    gain: u16,
    /// The largest gain that was tried, if it was not too large.
    calm_at: Option<u16>,
}

/// Results of a trial.
struct Shown {
    is_vibrating: bool,
    figures: Vec<StepFigures>,
}

impl Shown {
    fn overshoot(&self) -> f64 {
        let parts = self
            .figures
            .iter()
            .filter_map(|step| step.overshoot_percent);
        parts.fold(0.0, f64::max)
    }

    fn error(&self) -> u32 {
        let errors = self
            .figures
            .iter()
            .map(|step| step.steady_error.unsigned_abs());
        errors.max().unwrap_or(0)
    }

    fn text(&self) -> String {
        let state = if self.is_vibrating {
            "vibrates"
        } else {
            "calm"
        };
        format!(
            "{state}, overshoot {:.0} %, ends {} from the goal",
            self.overshoot(),
            super::stand::counts(self.error() as i32)
        )
    }
}

/// Finds gains with steps of `size` counts back and forth. Appends every trial to `trials`, and a
/// sentence to `notes` for every search that ended without an oscillation.
///
/// # Errors
///
/// A limit is passed, or the link fails.
pub fn stepwise(
    stand: &mut Stand,
    size: i32,
    trials: &mut Vec<Trial>,
    notes: &mut Vec<String>,
) -> Result<Gains, Error> {
    // Derivative gain: half of the gain at which the axis vibrates.
    let mut gains = Gains {
        integration_limit: 0,
        ..stand.gains(FIRST_P, 0, FIRST_D)
    };
    let bounds = Bounds::new(gains.output_limit);
    let found = raise(FIRST_D, bounds.derivative, |derivative| {
        let tried = Gains {
            derivative,
            ..gains
        };
        Ok(attempt(stand, "derivative", &tried, size, trials)?.is_vibrating)
    })?;
    let reason = "a motion of one count in a sample makes a quarter of the full drive";
    notes.extend(found.note("derivative", "oscillates", reason));
    gains.derivative = found.gain;
    // Proportional gain: half of the gain at which the axis vibrates or overshoots too much.
    let found = raise(FIRST_P, bounds.proportional, |proportional| {
        let tried = Gains {
            proportional,
            ..gains
        };
        let shown = attempt(stand, "proportional", &tried, size, trials)?;
        Ok(shown.is_vibrating || shown.overshoot() > OVERSHOOT_PERCENT)
    })?;
    let reason = "an error of eight counts makes the full drive";
    notes.extend(found.note("proportional", SWINGS, reason));
    gains.proportional = found.gain;
    // Integral gain, with a wide limit: half of the gain at which the axis vibrates or overshoots
    // too much.
    gains.integration_limit = WIDE_LIMIT;
    let found = raise(FIRST_I, bounds.integral, |integral| {
        let tried = Gains { integral, ..gains };
        let shown = attempt(stand, "integral", &tried, size, trials)?;
        Ok(shown.is_vibrating || shown.overshoot() > OVERSHOOT_PERCENT)
    })?;
    let reason = format!("a step of the integral makes {STEP_PWM} PWM");
    notes.extend(found.note("integral", SWINGS, &reason));
    gains.integral = found.gain;
    // The limit is halved as long as all moves end at their goals.
    let mut limit = WIDE_LIMIT;
    while limit >= 512 {
        let tried = Gains {
            integration_limit: limit,
            ..gains
        };
        let number = Trial::begin(trials, "limit", &tried);
        let result = moves::check(stand, &tried, MOVES)?;
        Trial::end(
            trials,
            number,
            format!(
                "{} of {} moves end within 1 count",
                result.within_1_count, result.moves
            ),
        );
        if !result.is_good() {
            break;
        }
        gains.integration_limit = limit;
        limit /= 2;
    }
    Ok(gains)
}

/// The event that ends the searches for the proportional and for the integral gain.
const SWINGS: &str = "oscillates or overshoots by more than 25 %";

impl Raised {
    /// Returns the sentence about a search without a result. `reason` describes the bound.
    fn note(&self, stage: &str, event: &str, reason: &str) -> Option<String> {
        let calm_at = self.calm_at?;
        Some(format!(
            "no {stage} gain up to {calm_at} {event}: the search ends there, where {reason}, and \
             half of it is taken"
        ))
    }
}

/// Doubles a gain until it `is_too_much`, or reaches `bound`. Finds half of the last gain.
fn raise(
    first: u16,
    bound: u16,
    mut is_too_much: impl FnMut(u16) -> Result<bool, Error>,
) -> Result<Raised, Error> {
    let mut gain = first;
    loop {
        let is_found = is_too_much(gain)?;
        if is_found || gain >= bound {
            return Ok(Raised {
                gain: gain / 2,
                calm_at: (!is_found).then_some(gain),
            });
        }
        gain = gain.saturating_mul(2).min(bound);
    }
}

/// Makes a step and a step back.
fn attempt(
    stand: &mut Stand,
    stage: &'static str,
    gains: &Gains,
    size: i32,
    trials: &mut Vec<Trial>,
) -> Result<Shown, Error> {
    let number = Trial::begin(trials, stage, gains);
    stand.engage(gains)?;
    let mut shown = Shown {
        is_vibrating: false,
        figures: Vec::new(),
    };
    let [from, there] = stand.there_and_back(size)?;
    let mut last = None;
    for (from, to) in [(from, there), (there, from)] {
        let trace = stand.step_to(to, TRIAL_US)?;
        shown.is_vibrating |= Swing::of_trace(&trace).is_sustained();
        shown.figures.push(figures(&trace, from));
        last = Some(trace);
    }
    Trial::end(trials, number, shown.text());
    // Only the last trace of each stage is kept. It shows why the stage ended.
    let title = format!(
        "The last step of the search for the {stage} gain: p {}, i {}, d {}",
        gains.proportional, gains.integral, gains.derivative
    );
    if trials
        .get(number.wrapping_sub(1))
        .is_some_and(|before| before.stage == stage)
    {
        stand.traces.pop();
    }
    stand
        .traces
        .extend(last.map(|trace| Trace { title, ..trace }));
    Ok(shown)
}
