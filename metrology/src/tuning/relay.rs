//! The relay experiment: a relay replaces the controller.

use super::stand::{Stand, Trace};
use super::swing::{PERIOD_S, fundamental};
use crate::error::Error;
use husillo_pid::tuning::{Oscillation, Relay, Ultimate, oscillation};
use serde::Serialize;

/// Time for which the relay drives, us.
const RELAY_US: u64 = 4_000_000;
/// Part of this time at the start in which the oscillation becomes steady, us.
const START_US: u64 = 1_000_000;
/// Least number of readings per period. Fewer do not show the amplitude.
const READINGS: f64 = 6.0;
/// Settings of a relay.
#[derive(Clone, Copy, Debug)]
pub struct RelaySettings {
    /// The output, PWM.
    pub amplitude: u8,
    /// Half of its hysteresis, counts.
    pub hysteresis: u16,
}

/// Results of a relay.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct RelayFigures {
    /// The output, PWM.
    pub relay_pwm: u8,
    /// Half of the effective hysteresis, counts. Whole counts add half a count.
    pub hysteresis: f64,
    /// Amplitude of the oscillation, counts.
    pub amplitude: f64,
    /// Period of the oscillation, ms.
    pub period_ms: f64,
    /// Number of whole periods.
    pub periods: u32,
    /// Delay from a zero crossing to the change of the drive, ms: the time for reading and
    /// commanding over a line. 0 if the relay acts in every servo period.
    pub late_ms: f64,
}

/// Lets the axis oscillate. Returns the figures, and the ultimate point according to the describing
/// function. Over a line, the point is that of a loop with the delay of the line. Its gain is lower
/// and its period is longer than those of the module's own loop.
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
    let (trace, command_us) = stand.drive_by(RELAY_US, law).map_err(NoRelay::Machine)?;
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
    // The relay switches at whole counts, which adds half a count.
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
            // On average a reading shows a crossing half a sampling time later.
            (0.5 * sample_us + command_us) * 1e-3
        } else {
            0.0
        },
    };
    Ok((figures, of_loop))
}

/// A note about a relay over a line.
pub fn note(figures: &RelayFigures) -> Option<String> {
    (figures.late_ms > 0.0).then(|| {
        format!(
            "the host is the relay, and the line delays it by {:.1} ms: Ku and Tu belong to a \
             loop with this delay, so the gains are lower than the module's own loop would allow",
            figures.late_ms
        )
    })
}

/// Why a relay found no ultimate point.
#[derive(Debug)]
pub enum NoRelay {
    /// The experiment was aborted.
    Machine(Error),
    /// There is no steady oscillation.
    Still,
    /// The oscillation is no larger than the hysteresis.
    WithinHysteresis,
    /// The line gives too few readings per period.
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
            Self::Machine(error) => error.fmt(out),
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
