//! Measuring programs in G-code: moves, probe moves, and the cycles as subroutines. A line is read
//! after all lines before it are carried out, so that it can use their results.

mod error;
mod state;

pub use error::{ProgramError, ProgramFault};

use super::called_cycle::{self, CYCLES};
use super::failure::Failure;
use super::feature::Feature;
use super::frame::Frame;
use super::runner::Runner;
use super::vector::{floats, length};
use crate::error::Error;
use error::At;
use husillo_excellon::lines;
use husillo_gcode::parameters::{Program, Value, needs_program};
use husillo_gcode::{Block, Command, Dialect, Feed, Modal, Nm, SpindleDirection, words};
use husillo_probe::{Edge, UnitVector};
use state::State;
use std::collections::HashMap;

/// The G-code dialect of measuring programs.
pub const DIALECT: Dialect = Dialect::RS274;

/// A program with its capacities for parameters and calls.
type Whole<'t> = Program<'t, 4096, 2048, 128>;

/// The names of the cycles that a program can call.
pub fn cycles() -> impl Iterator<Item = &'static str> {
    CYCLES.iter().map(|cycle| cycle.name)
}

/// Checks a program without carrying it out: lines without parameters, and G codes that a measuring
/// machine does not have.
///
/// # Errors
///
/// All errors.
pub fn check(text: &[u8]) -> Result<(), Vec<ProgramError>> {
    let mut errors = Vec::new();
    for (line, text) in lines(text) {
        let at = At { line, text };
        let codes = || words(text).flatten();
        if let Some(word) =
            codes().find(|word| word.letter == b'G' && is_machining(word.value.scaled(1, 1)))
        {
            let span = word.at..word.end;
            errors.push(at.error(ProgramFault::Foreign(Some(span))));
            continue;
        }
        if needs_program(text, &DIALECT) {
            continue;
        }
        match Block::parse(text, &DIALECT) {
            Err(error) => errors.push(at.error(ProgramFault::Code(error))),
            // Any text may follow the end of the program.
            Ok(_)
                if codes().any(|word| {
                    word.letter == b'M' && matches!(word.value.whole(), Some(2 | 30))
                }) =>
            {
                break;
            }
            Ok(_) => {}
        }
    }
    if errors.is_empty() {
        Ok(())
    } else {
        Err(errors)
    }
}

/// Whether a G code, in tenths, is for arcs, curves, threads or drilling.
fn is_machining(tenths: Option<i64>) -> bool {
    matches!(
        tenths,
        Some(20 | 30 | 50..=59 | 330..=331 | 410..=429 | 700..=799 | 810..=899)
    )
}

/// Runs a program to its end. Calls `begin` with every line before it, `tell` with every feature,
/// and `pause` with the line of every M0.
///
/// # Errors
///
/// A line is wrong, or failed.
pub fn run(
    text: &[u8],
    runner: &mut Runner<'_>,
    mut begin: impl FnMut(usize),
    mut tell: impl FnMut(&Feature),
    mut pause: impl FnMut(usize),
) -> Result<(), Box<ProgramError>> {
    let mut program = Box::new(Whole::new(text, DIALECT));
    let start = runner.site.machine_position();
    let start = start.map_err(|failure| At { line: 1, text: b"" }.failed(failure))?;
    let mut state = State {
        modal: Modal::new(DIALECT),
        probed: ([Nm(0); 3], false),
        found: HashMap::new(),
    };
    state.modal.set_position(start.map(Nm));
    while let Some(line) = program.next_line(&state) {
        begin(line.number);
        let at = At {
            line: line.number,
            text: line.text,
        };
        let (next, commands) = line
            .block
            .and_then(|block| state.modal.plan(&block))
            .map_err(|error| Box::new(at.error(ProgramFault::Code(error))))?;
        state.modal = next;
        for command in commands {
            match command {
                Command::Stop { optional: false } => pause(line.number),
                Command::End { .. } => return Ok(()),
                _ => carry_out(&command, &mut state, runner, &at)?,
            }
        }
        let Some((name, count)) = program.outside_call() else {
            continue;
        };
        let values: Vec<Value> = (1..=count as u16)
            .map(|number| program.parameter(number))
            .collect();
        for (name, slot) in [
            (&b"_clearance"[..], &mut runner.site.clearance_nm),
            (b"_search", &mut runner.site.search_nm),
        ] {
            let given = program
                .named_parameter(name)
                .and_then(|value| state.nm(value));
            *slot = given.filter(|nm| *nm > 0).unwrap_or(*slot);
        }
        let feature = call(name, &values, line.number, &mut state, runner, &at)?;
        tell(feature);
    }
    Ok(())
}

/// Carries out a cycle. Its moves are at the present height of the tip.
fn call<'r>(
    name: &[u8],
    values: &[Value],
    line: usize,
    state: &mut State,
    runner: &'r mut Runner<'_>,
    at: &At<'_>,
) -> Result<&'r Feature, Box<ProgramError>> {
    let wrong = |message, expected| Box::new(at.error(ProgramFault::Call { message, expected }));
    let cycle = called_cycle::by_name(name).ok_or_else(|| wrong("no such cycle", None))?;
    let lengths: Option<Vec<i64>> = values.iter().map(|value| state.nm(*value)).collect();
    let lengths = lengths.filter(|all| all.iter().all(|nm| nm.abs() <= 10_000_000_000));
    let lengths = lengths.ok_or_else(|| wrong("a length of more than 10 m", None))?;
    let numbers: Vec<f64> = values
        .iter()
        .map(|value| value.digits() as f64 / 10_f64.powi(value.places().into()))
        .collect();
    let count = runner.features.len() + 1;
    let task = cycle.task(&lengths, &numbers, count);
    let task = task.map_err(|expected| wrong("the arguments do not fit", Some(expected)))?;
    runner.site.frame = Frame::shifted(state.zero());
    let failed = |failure: Failure| at.failed(failure);
    let [.., height] = runner.site.position().map_err(failed)?;
    runner.site.safe_nm = Some(height);
    let feature = runner.measure(&task, line).map_err(failed)?;
    for dimension in &feature.dimensions {
        let name = format!("{}_{}", feature.keyword, dimension.figure.name()).to_ascii_uppercase();
        let is_length = dimension.figure.unit() == "mm";
        state
            .found
            .insert(name.into_bytes(), (dimension.actual_micro, is_length));
    }
    let here = runner.site.machine_position().map_err(failed)?;
    state.modal.set_position(here.map(Nm));
    runner.features.push(feature);
    runner
        .features
        .last()
        .ok_or_else(|| wrong("nothing measured", None))
}

fn carry_out(
    command: &Command<3>,
    state: &mut State,
    runner: &mut Runner<'_>,
    at: &At<'_>,
) -> Result<(), Box<ProgramError>> {
    let prober = runner.site.prober();
    match *command {
        Command::Rapid { to } => {
            let reached = prober.go_to(to.map(|nm| nm.0));
            reached.map_err(|error| at.failed(error))?;
        }
        Command::Linear { to, feed } => {
            let goal = to.map(|nm| nm.0);
            let from = prober.position();
            let from = from.map_err(|error| at.failed(error))?;
            let speed = nm_per_min(feed, displacement(from, goal)).ok_or_else(|| at.foreign())?;
            let reached = prober.feed_to(goal, speed);
            reached.map_err(|error| at.failed(error))?;
        }
        Command::Probe {
            to,
            feed,
            away,
            must,
        } => {
            let goal = to.map(|nm| nm.0);
            let from = prober.position().map_err(|error| at.failed(error))?;
            let displacement = displacement(from, goal);
            let travel =
                UnitVector::new(displacement).ok_or_else(|| at.failed(Failure::NoDirection))?;
            let speed = nm_per_min(feed, displacement).ok_or_else(|| at.foreign())?;
            // When the contact opens, the stylus is still bent by the travel towards the surface.
            let (until, approach) = if away {
                (Edge::Broken, travel.reversed())
            } else {
                (Edge::Made, travel)
            };
            let probed = prober.probe_to(goal, speed, until);
            let probed = probed.map_err(|error| at.failed(error))?;
            let here = probed.at_nm.map(Nm);
            state.probed = match probed.changed_nm {
                Some(latched) => (runner.site.tip.centre_nm(latched, &approach).map(Nm), true),
                None if must => {
                    let [from, to] = [from, probed.at_nm].map(place_text);
                    let error = match until {
                        Edge::Made => Error::NoContact { from, to },
                        Edge::Broken => Error::Kept { from, to },
                    };
                    return Err(at.failed(error));
                }
                None => (here, false),
            };
            state.modal.set_position(here);
        }
        // The axes are at rest before every line, so these commands have no effect.
        Command::Dwell { .. }
        | Command::Path { .. }
        | Command::ToolLength { .. }
        | Command::ToolIs { .. }
        | Command::Tool { .. }
        | Command::Switch { .. }
        | Command::Compensation { side: None, .. }
        | Command::Stop { optional: true }
        | Command::Spindle {
            direction: SpindleDirection::Off,
            ..
        }
        | Command::Coolant {
            mist: false,
            flood: false,
        } => {}
        _ => return Err(at.foreign()),
    }
    Ok(())
}

fn displacement(from: [i64; 3], to: [i64; 3]) -> [i64; 3] {
    std::array::from_fn(|axis| to[axis].saturating_sub(from[axis]))
}

/// The speed of a move over this distance, nm per minute. `None`: it depends on a spindle.
fn nm_per_min(feed: Feed, displacement: [i64; 3]) -> Option<u64> {
    match feed {
        Feed::PerMinute(nm) => Some(nm.0.unsigned_abs()),
        Feed::InverseTime { micro_per_minute } => {
            let length = length(floats(displacement));
            // The cast saturates, which is faster than any machine.
            Some((length * micro_per_minute as f64 / 1e6) as u64)
        }
        Feed::PerRevolution(_) => None,
    }
}

/// A position of the machine as text.
fn place_text(place_nm: [i64; 3]) -> String {
    let [x, y, z] = place_nm.map(|nm| nm as f64 / 1e6);
    format!("X {x:.4} mm, Y {y:.4} mm, Z {z:.4} mm")
}
