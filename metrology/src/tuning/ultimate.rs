//! The ultimate gain, by raising the proportional gain until the axis swings for ever.

use super::stand::{Stand, Trace};
use super::swing::Swing;
use super::trial::{LARGEST, Trial};
use crate::trouble::Trouble;
use husillo_pid::tuning::Ultimate;
use husillo_transports::nmc::Gains;

/// The kick that a trial begins with, counts.
const KICK: i32 = 10;
/// How long a trial takes, us.
const TRIAL_US: u64 = 1_800_000;
/// First gain, and what it is multiplied by until the axis swings.
const FIRST: u16 = 256;
const FACTOR: f64 = 1.5;
/// The gain is found to this part.
const EXACT: f64 = 1.02;
/// The slowest servo that is tried, as its rate divisor.
const SLOWEST: u8 = 32;

/// Looks for the ultimate point with the rate divisor of the machine file. Where not even the
/// largest gain makes the axis swing - an encoder with few counts and friction leave it no room -
/// the divisor is doubled until one does: a slower loop swings at a lower gain. Every trial goes to
/// `trials`; `None`: no luck. With the point comes the divisor.
///
/// # Errors
///
/// A limit is passed, or the link fails.
pub fn ultimate(
    stand: &mut Stand,
    trials: &mut Vec<Trial>,
) -> Result<Option<(Ultimate, u8)>, Trouble> {
    let mut divisor = stand.settings.gains.rate_divisor.max(1);
    let mut first = FIRST;
    loop {
        if let Some(found) = at_divisor(stand, divisor, first, trials)? {
            return Ok(Some((found, divisor)));
        }
        // Twice the hold takes half the gain at most, and a margin.
        first = LARGEST / 4;
        divisor = divisor.saturating_mul(2);
        if divisor > SLOWEST {
            return Ok(None);
        }
    }
}

/// Raises the gain, then halves the interval in which swinging begins.
fn at_divisor(
    stand: &mut Stand,
    divisor: u8,
    first: u16,
    trials: &mut Vec<Trial>,
) -> Result<Option<Ultimate>, Trouble> {
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
            // The geometric mean, and never one of both ends.
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
        title: format!("Proportional gain {gain}, rate divisor {divisor}: the axis swings"),
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
) -> Result<(Trace, Swing), Trouble> {
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
                "swings by {:.1} counts, {:.1} ms",
                swing.amplitude,
                found.period_s * 1e3
            ),
            None => format!(
                "does not go on swinging: {:.1} counts at the end",
                swing.amplitude
            ),
        },
    );
    Ok((trace, swing))
}
