//! `husillo tune`: finds and tests the gains of a servo.

use crate::cli::{Output, Tune, TuneMethod, TuneRule};
use crate::console::sharing::share;
use crate::console::stop::INTERRUPTED;
use crate::measuring::interrupt::{Interrupt, User};
use crate::measuring::machine_file;
use crate::measuring::memory_file;
use crate::measuring::port::NetworkPort;
use crate::measuring::{Stopped, error_text};
use husillo_metrology::Error;
use husillo_metrology::heads::{AxisSettings, Line, Machine, Port};
use husillo_metrology::simulated::{SimulatedNetwork, SimulatedPort};
use husillo_metrology::tuning::{
    Direct, Experiment, Failed, Linked, Method, NoRelay, Outcome, RelaySettings, Rig, Stand,
};
use husillo_pid::tuning::Rule;
use husillo_reports::tuning;
use husillo_sim::text::counted;
use husillo_simulator::text::json::write_line;
use husillo_transports::nmc::Gains;
use std::io::Write;

/// Runs the experiment, prints its results to `out`, and writes the page to `page`.
///
/// # Errors
///
/// [`Stopped`]. The results before the failure are printed.
pub fn tune(args: &Tune, out: &mut dyn Write, page: &mut String) -> Result<(), Stopped> {
    let machine =
        machine_file::load(args.machine.as_deref().unwrap_or("cmm")).map_err(Stopped::File)?;
    let mut file = machine.axis(args.axis)?;
    file.gains = given(args, &file.gains)?;
    let size = step_size(args, &file)?;
    let interrupt = Interrupt::listen()?;
    let rig = open(args, &machine, &file, &interrupt)?;
    let (title, port) = (machine.title.clone(), args.port.clone());
    let mut outcome = Outcome::new(args.method.name(), title, file.letter, port);
    let mut stand = Stand::new(rig, file).map_err(|error| Stopped::Machine(error_text(&error)))?;
    let result = experiment(args, size).run(&mut stand, &mut outcome);
    // The line is free again for the command that switches the motor off.
    interrupt.see_to();
    stand.release();
    interrupt.set_moving(false);
    outcome.sample_ms = stand.sample_us() * 1e-3;
    let message = match &result {
        Ok(()) => verdict(&outcome),
        Err(failed) => Some(message(failed, &outcome)),
    };
    outcome.aborted = result.is_err().then(|| message.clone()).flatten();
    let written = match args.format {
        Output::Text => write!(out, "{}", tuning::text(&outcome)),
        Output::Json => write_line("husillo.tune/1", &outcome, &mut &mut *out),
    }
    .and_then(|()| out.flush());
    *page = tuning::html(&outcome, &stand.traces);
    match message {
        Some(message) if interrupt.has_stopped() => {
            eprintln!("error: {message}");
            Err(Stopped::Reported(INTERRUPTED))
        }
        Some(message) => Err(Stopped::Machine(format!("error: {message}"))),
        None => written.map_err(Stopped::Output),
    }
}

/// The gains of the file, replaced by those of the command line.
fn given(args: &Tune, file: &Gains) -> Result<Gains, String> {
    if args.current.is_some_and(|current| current % 2 == 0) {
        return Err(
            "--current: use an odd limit. With an even one the module expects a sense signal that \
             falls with the current"
                .into(),
        );
    }
    let given = [args.p, args.i, args.d, args.integral_limit];
    if args.method != TuneMethod::Step && given.iter().any(Option::is_some) {
        return Err(
            "--p, --i, --d and --integral-limit are for --method step: the other methods find them"
                .into(),
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

/// The step of an experiment. It must be below the error limit of the servo, and fit the travel.
fn step_size(args: &Tune, file: &AxisSettings) -> Result<i32, String> {
    let size = args.size;
    let limit = i32::from(file.gains.error_limit);
    let [low, high] = file.travel;
    if size >= limit {
        return Err(format!(
            "--size {size}: a step is a position error at once, and beyond {limit} counts \
             (error_limit) the servo switches off"
        ));
    }
    if low > -2 * size || high < 2 * size {
        return Err(format!(
            "--size {size}: too large for the travel of {low} to {high} counts"
        ));
    }
    Ok(size)
}

/// Opens the axis at the port of the arguments.
fn open(
    args: &Tune,
    machine: &Machine,
    file: &AxisSettings,
    interrupt: &Interrupt,
) -> Result<Box<dyn Rig>, Stopped> {
    let port: Box<dyn Port> = match args.port.as_str() {
        "sim" => return Ok(Box::new(Direct::new(file.motor))),
        "line" => Box::new(SimulatedPort::new(SimulatedNetwork::of_machine(
            machine,
            &[],
            None,
        )?)),
        name => {
            let port = NetworkPort::open(name);
            let port = port.map_err(|error| format!("{name}: {error}"))?;
            share(
                args.machine.as_deref().unwrap_or("cmm"),
                name,
                machine.baud.bits_per_s(),
            );
            // The start-up resets the modules.
            memory_file::forget(name);
            Box::new(port)
        }
    };
    let line = Line::new(port).with_operator(User::new(interrupt, args.raw));
    let linked = Linked::start(line, machine, file);
    // The motor runs during the whole experiment, with or without its servo.
    interrupt.set_moving(linked.is_ok());
    Ok(Box::new(
        linked.map_err(|error| Stopped::Machine(error_text(&error)))?,
    ))
}

/// Why an experiment was aborted, with its last trial and a hint.
fn message(failed: &Failed, outcome: &Outcome) -> String {
    let error = match failed {
        Failed::Machine(error) => error,
        Failed::NoUltimate => return format!("{failed}; try --method relay"),
        Failed::NoRelay(none) => return no_relay(none),
        Failed::NoGains => return failed.to_string(),
    };
    let trial = outcome
        .trials
        .last()
        .filter(|trial| trial.result == "aborted");
    let when = trial.map_or(String::new(), |trial| {
        format!(" with p = {}, i = {}, d = {}", trial.p, trial.i, trial.d)
    });
    let help = match error {
        Error::PositionError { .. } => {
            "\n  help: the servo is off now; lower --size, or raise --error-limit if the travel \
             allows it"
        }
        Error::OverCurrent { .. } => {
            "\n  help: the motor is off now; lower --size or --amplitude, or raise --current if \
             the motor allows it"
        }
        _ => "",
    };
    format!("{error}{when}: aborted{help}")
}

/// Why a relay experiment found nothing, and the options that change it.
fn no_relay(none: &NoRelay) -> String {
    match none {
        NoRelay::Still => {
            format!("{none}: raise --amplitude above the PWM that overcomes friction")
        }
        NoRelay::WithinHysteresis => {
            format!("{none}: lower --hysteresis or raise --amplitude")
        }
        NoRelay::TooSlow { .. } => format!("{none}: raise `baud`, or use --method ultimate"),
        NoRelay::Machine(error) => error.to_string(),
    }
}

/// The fault of the gains that were found, if they have one.
fn verdict(outcome: &Outcome) -> Option<String> {
    let check = outcome.check.filter(|check| !check.is_good())?;
    Some(if check.within_1_count < check.moves {
        format!(
            "only {} of {} moves ended within 1 count, the farthest {} from its goal",
            check.within_1_count,
            check.moves,
            counted(check.largest_error, "count")
        )
    } else {
        format!(
            "the axis hunts: while it is held, it moves up to {} away from its goal",
            counted(check.rest_error, "count")
        )
    })
}

/// The experiment of the arguments.
fn experiment(args: &Tune, size: i32) -> Experiment {
    Experiment {
        method: match args.method {
            TuneMethod::Step => Method::Step,
            TuneMethod::Ultimate => Method::Ultimate,
            TuneMethod::Relay => Method::Relay,
            TuneMethod::Stepwise => Method::Stepwise,
        },
        rule: match args.rule {
            TuneRule::ZieglerNichols => Rule::ZieglerNicholsPid,
            TuneRule::TyreusLuyben => Rule::TyreusLuybenPid,
        },
        size,
        relay: RelaySettings {
            amplitude: args.amplitude,
            // On a line, one count of jitter would switch a relay without hysteresis.
            hysteresis: args.hysteresis.unwrap_or(u16::from(args.port != "sim")),
        },
        moves: args.moves.unwrap_or(match args.method {
            TuneMethod::Step => 0,
            _ => 20,
        }),
    }
}
