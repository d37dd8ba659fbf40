//! `husillo tune`: the gains of a servo.
//!
//! ```text
//! method: step, ultimate, relay, stepwise ─► stand ─► rig ─┬─► direct    the simulated axis, every servo period
//!            │  swing                           limits      └─► linked    a line of modules, simulated or real
//!            └─► fit ─► moves ─► outcome, page
//! ```

mod direct;
mod fit;
#[cfg(test)]
mod linear;
mod linked;
mod moves;
mod outcome;
mod page;
mod relay;
mod rig;
mod stand;
mod step;
mod stepwise;
mod swing;
mod trial;
mod ultimate;

use crate::cli::{Output, Tune, TuneMethod, TuneRule};
use crate::measuring::interrupt::{INTERRUPTED, Interrupt, User};
use crate::measuring::{Stopped, told};
use crate::measuring::{file, port};
use husillo_metrology::Trouble;
use husillo_metrology::heads::{AxisSettings, Line, Machine, Port};
use husillo_metrology::simulated::{SimulatedChain, SimulatedPort};
use husillo_pid::tuning::{Rule, Ultimate};
use husillo_sim::DcMotorModel;
use husillo_transports::nmc::Gains;
use outcome::{Outcome, RuleRow, UltimateFigures};
use relay::{NoRelay, RelaySettings};
use rig::Rig;
use stand::{Stand, Trace};
use std::io::Write;

/// Runs the experiment, prints what it found to `out`, and puts the page into `page`.
///
/// # Errors
///
/// [`Stopped`]; what was found before is printed.
pub fn tune(args: &Tune, out: &mut dyn Write, page: &mut String) -> Result<(), Stopped> {
    let machine = file::load(args.machine.as_deref().unwrap_or("cmm")).map_err(Stopped::File)?;
    let mut file = machine.axis(args.axis)?;
    file.gains = given(args, &file.gains)?;
    let size = step_size(args, &file)?;
    let interrupt = Interrupt::listen()?;
    let rig = open(args, &machine, &file, &interrupt)?;
    let mut outcome = Outcome {
        method: args.method.name(),
        machine: machine.title.clone(),
        axis: file.letter,
        port: args.port.clone(),
        sample_ms: 0.0,
        trials: Vec::new(),
        step: None,
        relay: None,
        ultimate: None,
        rules: Vec::new(),
        toml: None,
        check: None,
        notes: Vec::new(),
        aborted: None,
    };
    let mut stand = Stand::new(rig, file).map_err(|trouble| Stopped::Machine(told(&trouble)))?;
    let result = experiment(args, size, &mut stand, &mut outcome);
    // The line is free again for what switches the motor off.
    interrupt.see_to();
    stand.release();
    interrupt.set_moving(false);
    outcome.sample_ms = stand.sample_us() * 1e-3;
    let message = match &result {
        Ok(()) => verdict(&outcome),
        Err(failed) => Some(failed.message(&outcome)),
    };
    outcome.aborted = result.is_err().then(|| message.clone()).flatten();
    match args.format {
        Output::Text => write!(out, "{}", outcome.text()),
        Output::Json => serde_json::to_string_pretty(&outcome)
            .map_err(|error| error.to_string())
            .and_then(|json| writeln!(out, "{json}").map_err(|error| error.to_string()))
            .map_err(std::io::Error::other),
    }
    .and_then(|()| out.flush())
    .map_err(|error| Stopped::Usage(error.to_string()))?;
    *page = page::html(&outcome, &stand.traces);
    match message {
        Some(message) if interrupt.has_stopped() => {
            eprintln!("error: {message}");
            Err(Stopped::Told(INTERRUPTED))
        }
        Some(message) => Err(Stopped::Machine(format!("error: {message}"))),
        None => Ok(()),
    }
}

/// Gains of the file with what the command line says.
fn given(args: &Tune, file: &Gains) -> Result<Gains, String> {
    if args.current.is_some_and(|current| current % 2 == 0) {
        return Err("--current: the module takes even limits for a sense that shrinks with the current; give an odd one".into());
    }
    let given = [args.p, args.i, args.d, args.integral_limit];
    if args.method != TuneMethod::Step && given.iter().any(Option::is_some) {
        return Err(
            "--p, --i, --d and --integral-limit are for --method step: the others find them".into(),
        );
    }
    Ok(Gains {
        proportional: args.p.unwrap_or(file.proportional),
        integral: args.i.unwrap_or(file.integral),
        derivative: args.d.unwrap_or(file.derivative),
        integration_limit: args.integral_limit.unwrap_or(file.integration_limit),
        current_limit: args.current.unwrap_or(file.current_limit),
        error_limit: args.error_limit.unwrap_or(file.error_limit),
        dead_band: args.dead_band.unwrap_or(file.dead_band),
        ..*file
    })
}

/// The step of an experiment, which must be within what the servo takes for an error.
fn step_size(args: &Tune, file: &AxisSettings) -> Result<i32, String> {
    let size = args.size;
    let limit = i32::from(file.gains.error_limit);
    let [low, high] = file.travel;
    if size >= limit {
        return Err(format!(
            "--size {size}: a step is a position error at once, and beyond {limit} counts (error_limit) the servo goes off"
        ));
    }
    if low > -2 * size || high < 2 * size {
        return Err(format!(
            "--size {size}: the travel of {low} to {high} counts leaves no room for it"
        ));
    }
    Ok(size)
}

/// The axis at the port of the arguments.
fn open(
    args: &Tune,
    machine: &Machine,
    file: &AxisSettings,
    interrupt: &Interrupt,
) -> Result<Box<dyn Rig>, Stopped> {
    let port: Box<dyn Port> = match args.port.as_str() {
        "sim" => return Ok(Box::new(direct::Direct::new(DcMotorModel::PROTOTYPE))),
        "line" => {
            let versions = vec![4; usize::from(machine.modules())];
            Box::new(SimulatedPort::new(SimulatedChain::new(
                &versions,
                &[],
                None,
            )?))
        }
        name => {
            let port = port::Port::open(name);
            Box::new(port.map_err(|error| format!("{name}: {error}"))?)
        }
    };
    let line = Line::new(port).with_operator(User::new(interrupt, args.raw));
    let linked = linked::Linked::start(line, machine, file);
    // The motor runs in all of the experiment, with or without its servo.
    interrupt.set_moving(linked.is_ok());
    Ok(Box::new(
        linked.map_err(|trouble| Stopped::Machine(told(&trouble)))?,
    ))
}

/// Why an experiment has no end.
enum Failed {
    /// A limit was passed, or the link failed.
    Trouble(Trouble),
    /// There is nothing to find.
    Nothing(String),
}

impl From<Trouble> for Failed {
    fn from(trouble: Trouble) -> Self {
        Self::Trouble(trouble)
    }
}

impl Failed {
    /// With the trial in which it was.
    fn message(&self, outcome: &Outcome) -> String {
        match self {
            Self::Nothing(message) => message.clone(),
            Self::Trouble(trouble) => {
                let trial = outcome
                    .trials
                    .last()
                    .filter(|trial| trial.result == "aborted");
                let when = trial.map_or(String::new(), |trial| {
                    format!(" with p = {}, i = {}, d = {}", trial.p, trial.i, trial.d)
                });
                let help = match trouble {
                    Trouble::PositionError { .. } => {
                        "\n  help: the servo is off now; lower --size, or raise --error-limit if the axis has the room"
                    }
                    Trouble::OverCurrent { .. } => {
                        "\n  help: the motor is off now; lower --size or --amplitude, or raise --current if the motor bears it"
                    }
                    _ => "",
                };
                format!("{trouble}{when}: aborted{help}")
            }
        }
    }
}

/// What is wrong with the gains that were found.
fn verdict(outcome: &Outcome) -> Option<String> {
    let check = outcome.check.filter(|check| !check.is_good())?;
    Some(if check.within_1_count < check.moves {
        format!(
            "only {} of {} moves ended within 1 count, the farthest {} counts from its goal",
            check.within_1_count, check.moves, check.largest_error
        )
    } else {
        format!(
            "the axis hunts: held at its goal it goes up to {} counts from it",
            check.rest_error
        )
    })
}

fn experiment(
    args: &Tune,
    size: i32,
    stand: &mut Stand,
    outcome: &mut Outcome,
) -> Result<(), Failed> {
    let gains = match args.method {
        TuneMethod::Step => {
            let gains = stand.file.gains;
            let (figures, trace) = step::step(stand, &gains, size)?;
            outcome.step = Some(figures);
            stand.traces.push(titled(trace, &gains));
            gains
        }
        TuneMethod::Ultimate => {
            let found = ultimate::ultimate(stand, &mut outcome.trials)?;
            let nothing = "not even p = 32767 and a rate divisor of 32 make the axis swing for ever: there is no ultimate gain to be found; try --method relay";
            let found = found.ok_or_else(|| Failed::Nothing(nothing.into()))?;
            let (found, divisor) = found;
            by_rules(args, found, divisor, stand, outcome)?
        }
        TuneMethod::Relay => {
            let settings = RelaySettings {
                amplitude: args.amplitude,
                // On a line a count of jitter would turn it over, late.
                hysteresis: args.hysteresis.unwrap_or(u16::from(args.port != "sim")),
            };
            let (figures, found) = relay::relay(stand, settings).map_err(|none| match none {
                NoRelay::Trouble(trouble) => Failed::Trouble(trouble),
                none => Failed::Nothing(none.to_string()),
            })?;
            outcome.relay = Some(figures);
            if let Some(note) = relay::note(&figures) {
                outcome.notes.push(note);
            }
            by_rules(args, found, 1, stand, outcome)?
        }
        TuneMethod::Stepwise => stepwise::stepwise(stand, size, &mut outcome.trials)?,
    };
    if args.method != TuneMethod::Step {
        outcome.conclude(&gains);
        // The picture of the result.
        let (figures, trace) = step::step(stand, &gains, size)?;
        outcome.step = Some(figures);
        stand.traces.insert(0, titled(trace, &gains));
    }
    let moves = args.moves.unwrap_or(match args.method {
        TuneMethod::Step => 0,
        _ => 20,
    });
    if moves > 0 {
        outcome.check = Some(moves::check(stand, &gains, moves)?);
    }
    Ok(())
}

fn titled(trace: Trace, gains: &Gains) -> Trace {
    let title = format!(
        "Step with p = {}, i = {}, d = {}",
        gains.proportional, gains.integral, gains.derivative
    );
    Trace { title, ..trace }
}

/// The rules for a position loop, which needs its derivative.
const RULES: [(TuneRule, Rule, &str, &str); 2] = [
    (
        TuneRule::ZieglerNichols,
        Rule::ZieglerNicholsPid,
        "Ziegler-Nichols",
        "Trans. ASME 64 (1942)",
    ),
    (
        TuneRule::TyreusLuyben,
        Rule::TyreusLuybenPid,
        "Tyreus-Luyben",
        "Luyben and Luyben, Essentials of Process Control (1997)",
    ),
];

/// The gains of all rules; those of the chosen one are returned.
fn by_rules(
    args: &Tune,
    found: Ultimate,
    divisor: u8,
    stand: &Stand,
    outcome: &mut Outcome,
) -> Result<Gains, Failed> {
    outcome.ultimate = Some(UltimateFigures::new(found, divisor));
    let mut chosen = None;
    for (name, rule, title, source) in RULES {
        let rates = found.gains(rule);
        let Some((gains, notes)) = fit::fit(rates, &stand.file.gains) else {
            continue;
        };
        outcome
            .rules
            .push(RuleRow::new(title, source, rates, &gains));
        if name == args.rule {
            outcome.notes.extend(notes);
            chosen = Some(gains);
        }
    }
    chosen.ok_or_else(|| {
        Failed::Nothing("the ultimate point gives no gains that a module has".into())
    })
}
