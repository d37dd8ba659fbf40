//! Stepwise tuning, as by hand: derivative gain, proportional gain, integral gain, limit of the
//! integral.

use super::moves;
use super::stand::{Stand, Trace};
use super::step::{StepFigures, figures};
use super::swing::Swing;
use super::trial::{LARGEST, Trial};
use crate::trouble::Trouble;
use husillo_transports::nmc::Gains;

/// The proportional gain during the search for the derivative gain. It brings the axis back.
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

/// Finds gains with steps of `size` counts back and forth. Appends every trial to `trials`.
///
/// # Errors
///
/// A limit is passed, or the link fails.
pub fn stepwise(stand: &mut Stand, size: i32, trials: &mut Vec<Trial>) -> Result<Gains, Trouble> {
    // Derivative gain: up to vibration, then half of it.
    let mut gains = Gains {
        integration_limit: 0,
        ..stand.gains(FIRST_P, 0, FIRST_D)
    };
    gains.derivative = raise(FIRST_D, |derivative| {
        let tried = Gains {
            derivative,
            ..gains
        };
        Ok(attempt(stand, "derivative", &tried, size, trials)?.is_vibrating)
    })?;
    // Proportional gain: up to vibration or too much overshoot, then half of it.
    gains.proportional = raise(FIRST_P, |proportional| {
        let tried = Gains {
            proportional,
            ..gains
        };
        let shown = attempt(stand, "proportional", &tried, size, trials)?;
        Ok(shown.is_vibrating || shown.overshoot() > OVERSHOOT_PERCENT)
    })?;
    // Integral gain with a wide limit: up to vibration or too much overshoot, then half of it.
    gains.integration_limit = WIDE_LIMIT;
    gains.integral = raise(FIRST_I, |integral| {
        let tried = Gains { integral, ..gains };
        let shown = attempt(stand, "integral", &tried, size, trials)?;
        Ok(shown.is_vibrating || shown.overshoot() > OVERSHOOT_PERCENT)
    })?;
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

/// Doubles a gain until `is_too_much`. Returns half of that gain, or half of the largest gain.
fn raise(
    first: u16,
    mut is_too_much: impl FnMut(u16) -> Result<bool, Trouble>,
) -> Result<u16, Trouble> {
    let mut gain = first;
    loop {
        if is_too_much(gain)? || gain == LARGEST {
            return Ok(gain / 2);
        }
        gain = gain.saturating_mul(2).min(LARGEST);
    }
}

/// Makes a step and a step back.
fn attempt(
    stand: &mut Stand,
    stage: &'static str,
    gains: &Gains,
    size: i32,
    trials: &mut Vec<Trial>,
) -> Result<Shown, Trouble> {
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
