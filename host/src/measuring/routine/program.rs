//! Measuring programs in G code: moves, probe moves, and the cycles as subroutines. A line is read when all before it are done, so
//! that it can ask for what they found.

use super::called::{self, CYCLES};
use super::failure::Failure;
use super::feature::Feature;
use super::frame::Frame;
use super::line_reader::code;
use super::runner::Runner;
use crate::diagnostics::Finding;
use crate::programs::explain::{self, At};
use husillo_excellon::lines;
use husillo_gcode::parameters::{Program, System, Value, needs_program};
use husillo_gcode::{Block, Command, Dialect, Feed, Modal, Nm, SpindleDirection, Units, words};
use husillo_metrology::Trouble;
use husillo_probe::{Edge, UnitVector};
use std::collections::HashMap;

const DIALECT: Dialect = Dialect::RS274;

/// Room for parameters and calls.
type Whole<'t> = Program<'t, 4096, 2048, 128>;

/// What expressions can ask for: the state of the program, and what was found.
struct State {
    modal: Modal<3>,
    /// Where the last probe move ended, machine frame, and whether at a contact.
    probed: ([Nm; 3], bool),
    /// Figures of the cycles by their names in capitals, without `_`: nm, or millionths of a degree.
    found: HashMap<Vec<u8>, (i64, bool)>,
}

impl System for State {
    /// #5061 to #5069 are the last probed point in the work frame, #5070 is 1 where there was a contact; the rest is the modal state's.
    fn numbered(&self, number: u16) -> Option<Value> {
        let (at, is_contact) = self.probed;
        match number {
            5061..=5069 => {
                let axis = usize::from(number - 5061);
                let zero = self.zero();
                let place = at.get(axis).zip(zero.get(axis));
                place.map_or(Some(Value::ZERO), |(at, zero)| {
                    self.length(at.0.saturating_sub(*zero))
                })
            }
            5070 => Some(Value::from(i32::from(is_contact))),
            _ => self.modal.numbered(number),
        }
    }

    fn named(&self, name: &[u8]) -> Option<Value> {
        match self.found.get(name) {
            Some((nm, true)) => self.length(*nm),
            Some((micro, false)) => Value::new(*micro, 6),
            None => self.modal.named(name),
        }
    }

    fn has_subroutine(&self, name: &[u8]) -> bool {
        called::by_name(name).is_some()
    }
}

impl State {
    /// The zero of the work frame, tool length included, nm.
    fn zero(&self) -> [i64; 3] {
        let (offset, tool) = (self.modal.work_offset(), self.modal.tool_length());
        std::array::from_fn(|axis| offset[axis].0.saturating_add(tool[axis].0))
    }

    /// A length in the units in effect; inches to 10^-9.
    fn length(&self, nm: i64) -> Option<Value> {
        match self.modal.units() {
            Units::Millimetres => Value::new(nm, 6),
            Units::Micrometres => Value::new(nm, 3),
            Units::Inches => {
                let nano = i128::from(nm) * 1_000_000_000;
                let rounded = (nano + nano.signum() * 12_700_000) / 25_400_000;
                Value::new(i64::try_from(rounded).ok()?, 9)
            }
        }
    }

    /// A value in the units in effect, nm.
    fn nm(&self, value: Value) -> Option<i64> {
        let (factor, exponent) = match self.modal.units() {
            Units::Millimetres => (1, 6),
            Units::Micrometres => (1, 3),
            Units::Inches => (254, 5),
        };
        value.to_decimal().scaled(factor, exponent)
    }
}

/// Everything that can be known without carrying out the program: lines without parameters, G codes that no measuring machine has.
///
/// # Errors
///
/// All that is wrong.
pub fn check(file: &str, text: &[u8]) -> Result<(), Vec<Finding>> {
    let mut findings = Vec::new();
    for (number, line) in lines(text) {
        let at = at_line(file, number, line);
        let codes = || words(line).flatten();
        if let Some(word) =
            codes().find(|word| word.letter == b'G' && is_machining(word.value.scaled(1, 1)))
        {
            findings.push(foreign(at.place(word.at..word.end)));
            continue;
        }
        if needs_program(line, &DIALECT) {
            continue;
        }
        match Block::parse(line, &DIALECT) {
            Err(error) => findings.push(explain::finding(&error, &at)),
            // Behind it any text may stand.
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
    if findings.is_empty() {
        Ok(())
    } else {
        Err(findings)
    }
}

/// Arcs, curves, threads, drilling: G codes by tenths.
fn is_machining(tenths: Option<i64>) -> bool {
    matches!(
        tenths,
        Some(20 | 30 | 50..=59 | 330..=331 | 410..=429 | 700..=799 | 810..=899)
    )
}

/// Runs a program to its end; every feature goes to `tell`, every M0 to `pause`.
///
/// # Errors
///
/// What is wrong with a line, or went wrong at it.
pub fn run(
    file: &str,
    text: &[u8],
    runner: &mut Runner<'_>,
    mut tell: impl FnMut(&Feature),
    mut pause: impl FnMut(usize),
) -> Result<(), Box<Finding>> {
    let mut program = Box::new(Whole::new(text, DIALECT));
    let start = runner.site.machine_position();
    let start = start.map_err(|failure| failed(&failure, &at_line(file, 1, b"")))?;
    let mut state = State {
        modal: Modal::new(DIALECT),
        probed: ([Nm(0); 3], false),
        found: HashMap::new(),
    };
    state.modal.set_position(start.map(Nm));
    while let Some(line) = program.next_line(&state) {
        let at = at_line(file, line.number, line.text);
        let (next, commands) = line
            .block
            .and_then(|block| state.modal.plan(&block))
            .map_err(|error| Box::new(explain::finding(&error, &at)))?;
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

/// A cycle. Its ways go at the height where the tip is.
fn call<'r>(
    name: &[u8],
    values: &[Value],
    line: usize,
    state: &mut State,
    runner: &'r mut Runner<'_>,
    at: &At<'_>,
) -> Result<&'r Feature, Box<Finding>> {
    let wrong = |message: &str| Finding::error(code::MISSING, message, at.whole());
    let cycle = called::by_name(name).ok_or_else(|| wrong("no such cycle"))?;
    let lengths: Option<Vec<i64>> = values.iter().map(|value| state.nm(*value)).collect();
    let lengths = lengths.filter(|all| all.iter().all(|nm| nm.abs() <= 10_000_000_000));
    let lengths = lengths.ok_or_else(|| wrong("a length of more than 10 m"))?;
    let numbers: Vec<f64> = values
        .iter()
        .map(|value| value.digits() as f64 / 10_f64.powi(value.places().into()))
        .collect();
    let count = runner.features.len() + 1;
    let task = cycle.task(&lengths, &numbers, count).map_err(|message| {
        let names: Vec<_> = CYCLES.iter().map(|cycle| cycle.name).collect();
        wrong("the arguments do not fit")
            .label(message)
            .note(format!("cycles: {}", names.join(", ")))
    });
    let task = task.map_err(Box::new)?;
    runner.site.frame = Frame::shifted(state.zero());
    let failed = |failure: Failure| failed(&failure, at);
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
        .ok_or_else(|| Box::new(wrong("nothing measured")))
}

fn carry_out(
    command: &Command<3>,
    state: &mut State,
    runner: &mut Runner<'_>,
    at: &At<'_>,
) -> Result<(), Box<Finding>> {
    let failed = |failure: Failure| failed(&failure, at);
    let prober = runner.site.prober();
    match *command {
        Command::Rapid { to } => {
            let reached = prober.go_to(to.map(|nm| nm.0));
            reached.map_err(|trouble| failed(trouble.into()))?;
        }
        Command::Linear { to, feed } => {
            let goal = to.map(|nm| nm.0);
            let from = prober.position();
            let from = from.map_err(|trouble| failed(trouble.into()))?;
            let speed = nm_per_min(feed, way(from, goal)).ok_or_else(|| foreign(at.whole()))?;
            let reached = prober.feed_to(goal, speed);
            reached.map_err(|trouble| failed(trouble.into()))?;
        }
        Command::Probe {
            to,
            feed,
            away,
            must,
        } => {
            let goal = to.map(|nm| nm.0);
            let from = prober
                .position()
                .map_err(|trouble| failed(trouble.into()))?;
            let way = way(from, goal);
            let travel = UnitVector::new(way).ok_or_else(|| failed(Failure::NoDirection))?;
            let speed = nm_per_min(feed, way).ok_or_else(|| foreign(at.whole()))?;
            // Where contact ends, the stylus is bent as it was when it began: by the way there.
            let (until, approach) = if away {
                (Edge::Broken, travel.reversed())
            } else {
                (Edge::Made, travel)
            };
            let probed = prober.probe_to(goal, speed, until);
            let probed = probed.map_err(|trouble| failed(trouble.into()))?;
            let here = probed.at_nm.map(Nm);
            state.probed = match probed.changed_nm {
                Some(latched) => (runner.site.tip.centre_nm(latched, &approach).map(Nm), true),
                None if must => {
                    let [from, to] = [from, probed.at_nm].map(place_text);
                    let trouble = match until {
                        Edge::Made => Trouble::NoContact { from, to },
                        Edge::Broken => Trouble::Kept { from, to },
                    };
                    return Err(failed(trouble.into()));
                }
                None => (here, false),
            };
            state.modal.set_position(here);
        }
        // The axes stand before every line as it is.
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
        _ => return Err(Box::new(foreign(at.whole()))),
    }
    Ok(())
}

fn way(from: [i64; 3], to: [i64; 3]) -> [i64; 3] {
    std::array::from_fn(|axis| to[axis].saturating_sub(from[axis]))
}

/// The speed of a move along this way, nm a minute; `None` where it depends on a spindle.
fn nm_per_min(feed: Feed, way: [i64; 3]) -> Option<u64> {
    match feed {
        Feed::PerMinute(nm) => Some(nm.0.unsigned_abs()),
        Feed::InverseTime { micro_per_minute } => {
            let length = super::frame::length(super::frame::floats(way));
            // Saturates, which is faster than any machine.
            Some((length * micro_per_minute as f64 / 1e6) as u64)
        }
        Feed::PerRevolution(_) => None,
    }
}

/// A place of the machine for people.
fn place_text(place_nm: [i64; 3]) -> String {
    let [x, y, z] = place_nm.map(|nm| nm as f64 / 1e6);
    format!("X {x:.4} mm, Y {y:.4} mm, Z {z:.4} mm")
}

fn at_line<'a>(file: &'a str, line: usize, bytes: &'a [u8]) -> At<'a> {
    At {
        file,
        line,
        bytes,
        block: 0,
        length: bytes.len(),
        dialect: DIALECT,
    }
}

/// Something that machines with spindles do.
fn foreign(place: crate::diagnostics::Place) -> Finding {
    Finding::error(code::MACHINE, "not on a measuring machine", place)
        .label("nothing here can do it")
        .help("there are G0, G1, G38.2 to G38.5, frames, M0, M2, M30, O-words, parameters and the measuring cycles")
}

/// A failure at a line.
fn failed(failure: &Failure, at: &At<'_>) -> Box<Finding> {
    let finding = Finding::error(code::MACHINE, failure.to_string(), at.whole());
    Box::new(match failure.help() {
        Some(help) => finding.help(help),
        None => finding,
    })
}
