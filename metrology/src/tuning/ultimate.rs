//! The ultimate gain: the proportional gain is raised until the axis oscillates steadily.

use super::stand::{Stand, Trace};
use super::swing::Swing;
use super::trial::{LARGEST, Trial};
use crate::error::Error;
use husillo_pid::tuning::Ultimate;
use husillo_transports::nmc::Gains;

/// Length of the step at the start of a trial, counts.
const KICK: i32 = 10;
/// Duration of a trial, us.
const TRIAL_US: u64 = 1_800_000;
/// First gain, and the factor by which it is raised until the axis oscillates.
const FIRST: u16 = 256;
const FACTOR: f64 = 1.5;
/// The search ends when the interval of the gain is at most this ratio.
const EXACT: f64 = 1.02;
/// Rate divisor of the slowest servo that is tried.
const SLOWEST: u8 = 32;

/// Searches the ultimate point with the rate divisor of the machine file. Friction and a coarse
/// encoder may prevent an oscillation even at the largest gain. Then the divisor is doubled, as a
/// slower loop oscillates at a lower gain. Returns the point and the divisor. `None`: no divisor
/// gives an oscillation. Appends every trial to `trials`.
///
/// # Errors
///
/// A limit is passed, or the link fails.
pub fn ultimate(
    stand: &mut Stand,
    trials: &mut Vec<Trial>,
) -> Result<Option<(Ultimate, u8)>, Error> {
    let mut divisor = stand.settings.gains.rate_divisor.max(1);
    let mut first = FIRST;
    loop {
        if let Some(found) = at_divisor(stand, divisor, first, trials)? {
            return Ok(Some((found, divisor)));
        }
        // With twice the period the ultimate gain is at most half as large. The search begins at a
        // quarter, which leaves a margin.
        first = LARGEST / 4;
        divisor = divisor.saturating_mul(2);
        if divisor > SLOWEST {
            return Ok(None);
        }
    }
}

/// Raises the gain, then bisects the interval in which the oscillation begins.
fn at_divisor(
    stand: &mut Stand,
    divisor: u8,
    first: u16,
    trials: &mut Vec<Trial>,
) -> Result<Option<Ultimate>, Error> {
    let (mut calm, mut swinging) = (0_u16, None);
    let mut proportional = first;
    loop {
        let (trace, swing) = attempt(stand, proportional, divisor, trials)?;
        if swing.is_sustained() {
            swinging = Some((proportional, trace, swing));
        } else {
            calm = proportional;
        }
        let top = swinging.as_ref().map(|(gain, ..)| *gain);
        proportional = match top {
            Some(top) if f64::from(top) <= f64::from(calm.max(1)) * EXACT => break,
            // The geometric mean of both ends of the interval.
            Some(top) => (f64::from(calm.max(1)) * f64::from(top)).sqrt() as u16,
            None if calm == LARGEST => break,
            None => (f64::from(calm) * FACTOR).min(LARGEST.into()) as u16,
        };
        if proportional <= calm {
            break;
        }
    }
    let Some((gain, trace, swing)) = swinging else {
        return Ok(None);
    };
    stand.traces.push(Trace {
        title: format!("Proportional gain {gain}, rate divisor {divisor}: the axis oscillates"),
        ..trace
    });
    Ok(swing.oscillation.map(|found| Ultimate {
        gain: f64::from(gain) / 256.0,
        period_s: found.period_s,
    }))
}

fn attempt(
    stand: &mut Stand,
    proportional: u16,
    rate_divisor: u8,
    trials: &mut Vec<Trial>,
) -> Result<(Trace, Swing), Error> {
    let gains = Gains {
        integration_limit: 0,
        rate_divisor,
        ..stand.gains(proportional, 0, 0)
    };
    let number = Trial::begin(trials, "ultimate", &gains);
    stand.engage(&gains)?;
    let [_, target] = stand.there_and_back(KICK)?;
    let trace = stand.step_to(target, TRIAL_US)?;
    let swing = Swing::of_trace(&trace);
    Trial::end(
        trials,
        number,
        match swing.oscillation.filter(|_| swing.is_sustained()) {
            Some(found) => format!(
                "oscillates with {:.1} counts, {:.1} ms",
                swing.amplitude,
                found.period_s * 1e3
            ),
            None => format!(
                "no sustained oscillation: {:.1} counts at the end",
                swing.amplitude
            ),
        },
    );
    Ok((trace, swing))
}
