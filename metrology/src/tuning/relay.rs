//! The relay experiment: a relay in the place of the controller.

use super::stand::{Stand, Trace};
use super::swing::{PERIOD_S, fundamental};
use crate::trouble::Trouble;
use husillo_pid::tuning::{Oscillation, Relay, Ultimate, oscillation};
use serde::Serialize;

/// How long the relay drives, us.
const RELAY_US: u64 = 4_000_000;
/// Of that it may take so long until the oscillation is steady, us.
const START_US: u64 = 1_000_000;
/// Readings of a period, at least: fewer do not show its amplitude.
const READINGS: f64 = 6.0;
/// What a relay is set to.
#[derive(Clone, Copy, Debug)]
pub struct RelaySettings {
    /// The output, PWM.
    pub amplitude: u8,
    /// Half its hysteresis, counts.
    pub hysteresis: u16,
}

/// What it found.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct RelayFigures {
    /// The output, PWM.
    pub relay_pwm: u8,
    /// Half the hysteresis in effect: whole counts add a half, counts.
    pub hysteresis: f64,
    /// Amplitude of the oscillation, counts.
    pub amplitude: f64,
    /// Its period, ms.
    pub period_ms: f64,
    /// Whole periods.
    pub periods: u32,
    /// From a crossing to the drive that follows, ms: what reading and commanding through a line
    /// take; 0 where the relay acts in every servo period.
    pub late_ms: f64,
}

/// Lets the axis oscillate and returns what it found, and the ultimate point by the describing
/// function. Where a line is in between, that point belongs to a loop with the delay of the line in
/// it: a lower gain and a longer period than the module's own.
///
/// # Errors
///
/// [`NoRelay`].
pub fn relay(
    stand: &mut Stand,
    settings: RelaySettings,
) -> Result<(RelayFigures, Ultimate), NoRelay> {
    let mut relay = Relay::new(
        f64::from(settings.amplitude),
        f64::from(settings.hysteresis),
    );
    let centre = stand.centre;
    // Duties are within 255.
    let law = |position: i32| relay.update(f64::from(centre - position)) as i16;
    let (trace, command_us) = stand.drive_by(RELAY_US, law).map_err(NoRelay::Trouble)?;
    let sample_us = stand.sample_us();
    let result = evaluate(&trace, settings, centre, sample_us, command_us);
    stand.traces.push(Trace {
        title: format!("A relay of {} PWM drives the axis", settings.amplitude),
        ..trace
    });
    result
}

fn evaluate(
    trace: &Trace,
    settings: RelaySettings,
    centre: i32,
    sample_us: f64,
    command_us: f64,
) -> Result<(RelayFigures, Ultimate), NoRelay> {
    let positions = trace.positions(PERIOD_S);
    let start = (START_US as f64 * 1e-6 / PERIOD_S) as usize;
    let steady = positions.get(start..).unwrap_or_default();
    let middle = steady.iter().sum::<f64>() / steady.len().max(1) as f64;
    let found = oscillation(steady, PERIOD_S, middle).ok_or(NoRelay::Still)?;
    let about_zero: Vec<f64> = steady.iter().map(|position| position - middle).collect();
    let amplitude = fundamental(&about_zero, found.period_s);
    // An error beyond whole counts is half a count more.
    let hysteresis = f64::from(settings.hysteresis) + 0.5;
    let drift = (middle - f64::from(centre)).abs();
    if drift > 2.0 * amplitude + 3.0 || found.periods < 5 {
        return Err(NoRelay::Still);
    }
    let relay = Relay::new(f64::from(settings.amplitude), hysteresis);
    let at = Oscillation { amplitude, ..found };
    let of_loop = relay.ultimate(&at).ok_or(NoRelay::WithinHysteresis)?;
    if found.period_s * 1e6 < READINGS * sample_us {
        return Err(NoRelay::TooSlow {
            period_ms: found.period_s * 1e3,
            sample_ms: sample_us * 1e-3,
        });
    }
    let figures = RelayFigures {
        relay_pwm: settings.amplitude,
        hysteresis,
        amplitude,
        period_ms: found.period_s * 1e3,
        periods: found.periods,
        late_ms: if command_us > 0.0 {
            // A crossing is seen half a reading later in the mean.
            (0.5 * sample_us + command_us) * 1e-3
        } else {
            0.0
        },
    };
    Ok((figures, of_loop))
}

/// What is to be known of a relay through a line.
pub fn note(figures: &RelayFigures) -> Option<String> {
    (figures.late_ms > 0.0).then(|| {
        format!(
            "the host is the relay, and {:.1} ms late as it reads and drives through the line: Ku \
             and Tu are those of a loop with that in it, and the gains \
             gentler than the module's own loop would bear",
            figures.late_ms
        )
    })
}

/// Why a relay found nothing.
#[derive(Debug)]
pub enum NoRelay {
    /// The experiment was aborted.
    Trouble(Trouble),
    /// No steady oscillation.
    Still,
    /// The oscillation is no larger than the hysteresis.
    WithinHysteresis,
    /// The line gives too few readings of a period.
    TooSlow {
        /// Period of the oscillation, ms.
        period_ms: f64,
        /// Time from one reading to the next, ms.
        sample_ms: f64,
    },
}

impl std::error::Error for NoRelay {}

impl std::fmt::Display for NoRelay {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Trouble(trouble) => trouble.fmt(out),
            Self::Still => out.write_str("the relay makes no steady oscillation"),
            Self::WithinHysteresis => out.write_str("the oscillation is within the hysteresis"),
            Self::TooSlow {
                period_ms,
                sample_ms,
            } => write!(
                out,
                "the line gives a reading every {sample_ms:.1} ms, too few for a period of \
                 {period_ms:.1} ms"
            ),
        }
    }
}
