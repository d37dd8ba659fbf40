//! A servo axis on the simulated test stand.

use super::{Answer, Failed};
use husillo_metrology::simulated::one_axis;
use husillo_metrology::tuning::{self, Direct, Method, Outcome, RelaySettings, Stand};
use husillo_pid::tuning::Rule;
use serde::Deserialize;
use serde_json::{Value, json};

/// Most points of a drawn trace.
const MOST_POINTS: usize = 2000;

/// An experiment with the axis of the prototype. Gains that are missing are those of its file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    #[serde(default)]
    method: Finding,
    p: Option<u16>,
    i: Option<u16>,
    d: Option<u16>,
    integral_limit: Option<u16>,
    /// Length of the step, counts.
    #[serde(default = "size")]
    size: i32,
}

/// How gains are found.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Finding {
    /// They are given.
    #[default]
    Step,
    Ultimate,
    Relay,
    Stepwise,
}

impl Finding {
    const fn method(self) -> (&'static str, Method) {
        match self {
            Self::Step => ("step", Method::Step),
            Self::Ultimate => ("ultimate", Method::Ultimate),
            Self::Relay => ("relay", Method::Relay),
            Self::Stepwise => ("stepwise", Method::Stepwise),
        }
    }
}

const fn size() -> i32 {
    100
}

/// Makes the experiment: its figures, and the traces in us and counts.
///
/// # Errors
///
/// A gain or the length of the step is out of range.
pub fn tune(of: &Experiment) -> Result<Answer, Failed> {
    let machine = one_axis();
    let mut settings = machine.axis('X')?;
    let gains = &mut settings.gains;
    for (gain, given) in [
        (&mut gains.proportional, of.p),
        (&mut gains.integral, of.i),
        (&mut gains.derivative, of.d),
        (&mut gains.integration_limit, of.integral_limit),
    ] {
        let given = given.unwrap_or(*gain);
        if given > 0x7fff {
            return Err(format!("a gain of {given} is above 32767").into());
        }
        *gain = given;
    }
    let most = i32::from(gains.error_limit) - 1;
    if !(1..=most).contains(&of.size) {
        return Err(format!("a step of {} counts is not from 1 to {most}", of.size).into());
    }
    let (name, method) = of.method.method();
    let experiment = tuning::Experiment {
        method,
        rule: Rule::TyreusLuybenPid,
        size: of.size,
        relay: RelaySettings {
            amplitude: 200,
            hysteresis: 0,
        },
        moves: if method == Method::Step { 0 } else { 20 },
    };
    let mut outcome = Outcome::new(name, machine.title, 'X', "sim".to_owned());
    let rig = Box::new(Direct::new(settings.motor));
    let mut stand = Stand::new(rig, settings).map_err(|error| error.to_string())?;
    let result = experiment.run(&mut stand, &mut outcome);
    stand.release();
    outcome.sample_ms = stand.sample_us() * 1e-3;
    outcome.aborted = result.err().map(|failed| failed.to_string());
    let traces: Vec<Value> = stand.traces.iter().map(trace).collect();
    Answer::listed(
        "husillo.tune/1",
        &json!({"outcome": outcome, "traces": traces}),
    )
}

fn trace(of: &tuning::Trace) -> Value {
    let every = of.samples.len().div_ceil(MOST_POINTS).max(1);
    let points = of.samples.iter().step_by(every);
    let points: Vec<_> = points
        .map(|sample| (sample.us - of.start_us, sample.position))
        .collect();
    json!({"title": of.title, "target": of.target, "points": points})
}
