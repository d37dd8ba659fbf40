//! Measuring machines: `husillo measure` and `husillo emulate`.
//!
//! ```text
//! file, action ─► session ─► husillo-metrology ─► port ─► serial device, socket
//! routine ──────────┘  └─► result_row
//! piece_file ─► simulated network ─► terminal
//! ```

mod action;
mod calibrating;
mod calibration_file;
mod direction;
#[cfg(unix)]
mod emulated;
mod halt;
mod help;
pub mod interrupt;
pub mod machine_file;
pub mod memory_file;
#[cfg(unix)]
mod module_list;
mod motor_file;
mod piece_file;
pub mod port;
mod result_row;
mod routine;
mod session;

pub use calibrating::{calibrate_axis, calibrate_squareness};
#[cfg(unix)]
pub use emulated::emulate;
pub use halt::halt;
pub use routine::{Routine, now};

use crate::cli::{Measure, Results};
use crate::console::stop::INTERRUPTED;
use action::Action;
use husillo_metrology::Error;
use husillo_metrology::calibration::Calibrated;
use husillo_metrology::heads::{Head, Machine, Prober as _, Stylus};
use husillo_metrology::simulated::{Contact, Mounted, SimulatedNetwork};
use husillo_simulator::machines::machine_file::{LoadError, MachineFile};
use husillo_simulator::text::json::write_line;
use interrupt::{Interrupt, User};
use result_row::{CSV_HEAD, ResultRow};
use routine::Ending;
use session::{AnyPort, Session};
use std::io::{self, BufRead, BufReader, Write};

/// The face before the first axis of a simulation without a work piece, counts.
const FACE_TO_TRY: i64 = 3018;

/// Why a command on a measuring machine has failed.
pub enum Stopped {
    /// The command line or a file is bad.
    Usage(String),
    /// The machine file has mistakes, or cannot be read.
    File(LoadError),
    /// The machine has failed.
    Machine(String),
    /// The results cannot be written.
    Output(io::Error),
    /// The message is printed already. This is the exit status.
    Reported(u8),
}

impl From<String> for Stopped {
    fn from(message: String) -> Self {
        Self::Usage(message)
    }
}

/// Exit status of a routine that found something out of tolerance.
const OUT_OF_TOLERANCE: u8 = 1;
/// Exit status of a routine with mistakes. Nothing has moved.
const WRONG: u8 = 2;
/// Exit status of a routine that stopped before its end.
const FAILED: u8 = 3;
/// Exit status of a collision: the probe touched something during a move without a search.
const COLLISION: u8 = 4;
/// Exit status after an axis met an end switch.
const END_SWITCH: u8 = 5;

/// `husillo measure`: prints the results to `out`, and writes the file of `-o` to `table`.
///
/// # Errors
///
/// [`Stopped`]. The results before the failure are printed.
pub fn measure(args: &Measure, out: &mut dyn Write, table: &mut Vec<u8>) -> Result<(), Stopped> {
    let machine =
        machine_file::load(args.machine.as_deref().unwrap_or("cmm")).map_err(Stopped::File)?;
    let interrupt = Interrupt::listen()?;
    let done = measure_by(args, &machine, &interrupt, out, table);
    match done {
        Err(Stopped::Machine(message)) if interrupt.has_stopped() => {
            eprintln!("{message}");
            Err(Stopped::Reported(INTERRUPTED))
        }
        Err(Stopped::Reported(FAILED | COLLISION | END_SWITCH)) if interrupt.has_stopped() => {
            Err(Stopped::Reported(INTERRUPTED))
        }
        done => done,
    }
}

/// What follows the actions.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Last<'a> {
    /// Run a routine.
    Run(&'a str),
    /// Record a routine.
    Record(&'a str),
    /// Read actions from standard input.
    Session,
    /// Nothing.
    None,
}

impl<'a> Last<'a> {
    /// The actions before the last one, and the last one.
    fn split(actions: &'a [String]) -> Result<(&'a [String], Self), String> {
        let is_last = |word: &String| matches!(word.as_str(), "run" | "record" | "session");
        let begin = actions.iter().position(is_last);
        let (before, last) = actions.split_at(begin.unwrap_or(actions.len()));
        let words: Vec<&str> = last.iter().map(String::as_str).collect();
        let last = match *words.as_slice() {
            ["run", path] => Last::Run(path),
            ["record", path] => Last::Record(path),
            ["session"] => Last::Session,
            [] => Last::None,
            ["session", ..] => {
                return Err(
                    "`session` is the last action: further actions come from standard input".into(),
                );
            }
            [verb, ..] => {
                let message = format!(
                    "`{verb}` is the last action and needs a file, as in `{verb} part.routine`"
                );
                return Err(message);
            }
        };
        Ok((before, last))
    }
}

/// Writes all results: JSON or CSV to `out`, and CSV to `table` in every format. Text is already
/// written.
fn write_rows(
    format: Results,
    rows: &[ResultRow],
    out: &mut dyn Write,
    table: &mut Vec<u8>,
) -> std::io::Result<()> {
    if format == Results::Json {
        let body = serde_json::json!({"results": rows});
        write_line("husillo.measure/1", &body, &mut &mut *out)?;
    }
    writeln!(table, "{CSV_HEAD}")?;
    rows.iter()
        .try_for_each(|row| writeln!(table, "{}", row.csv()))?;
    match format {
        Results::Csv => out.write_all(table),
        Results::Text | Results::Json => Ok(()),
    }
}

fn measure_by(
    args: &Measure,
    machine: &Machine,
    interrupt: &Interrupt,
    out: &mut dyn Write,
    table: &mut Vec<u8>,
) -> Result<(), Stopped> {
    let (before, last) = Last::split(&args.actions).map_err(Stopped::Usage)?;
    let mut session = Session::new(args, machine)?;
    let actions = session.actions(before)?;
    let before = (&mut session, actions.as_slice());
    match last {
        Last::Run(path) => {
            return run_routine(args, machine, interrupt, path, before, out, table);
        }
        Last::Record(path) => return record_routine(args, machine, interrupt, path, before, out),
        Last::Session | Last::None => {}
    }
    let line = session::open(args, machine, mounted(args.piece.as_deref(), machine)?)?;
    let line = line.with_operator(User::new(interrupt, args.raw));
    let mut rows: Vec<ResultRow> = Vec::new();
    let scale = session.scale;
    let mut written = Ok(());
    let (mut is_refused, mut mishap) = (false, None);
    let result = session.begin(line, args).and_then(|mut head| {
        let mut report = |row: &ResultRow| {
            if args.format == Results::Text && written.is_ok() {
                written = writeln!(out, "{}", row.text(scale)).and_then(|()| out.flush());
            }
            rows.push(row.clone());
        };
        let done = session.run(&actions, &mut head, &mut report);
        let done = done.and_then(|()| match last == Last::Session {
            true => typed(&mut session, &mut head, interrupt, report),
            false => Ok(false),
        });
        mishap = mishap_of(&mut head);
        session.end(&mut head);
        is_refused = done?;
        Ok(())
    });
    let written = written.and_then(|()| write_rows(args.format, &rows, out, table));
    match (result, mishap) {
        (Err(error), Some(status)) => {
            eprintln!("{}", error_text(&error));
            return Err(Stopped::Reported(status));
        }
        (result, _) => result.map_err(|error| Stopped::Machine(error_text(&error)))?,
    }
    // The state of the machine matters more than a failed output, for example a closed pipe.
    if let Some(status) = mishap {
        return Err(Stopped::Reported(status));
    }
    if is_refused {
        return Err(Stopped::Reported(FAILED));
    }
    written.map_err(Stopped::Output)
}

/// The exit status after a collision or an end switch. `None` without either.
fn mishap_of(head: &mut Calibrated<Head<AnyPort>>) -> Option<u8> {
    if head.has_collided() {
        return Some(COLLISION);
    }
    head.inner().has_met_end().then_some(END_SWITCH)
}

/// Carries out actions as they are typed, one line at a time, until `end` or the end of the input.
/// A line that is not understood, or fails, is reported, and the session continues. Returns whether
/// a line failed.
///
/// # Errors
///
/// Standard input cannot be read, or the user pressed Ctrl-C.
fn typed(
    session: &mut Session,
    head: &mut Calibrated<Head<AnyPort>>,
    interrupt: &Interrupt,
    mut report: impl FnMut(&ResultRow),
) -> Result<bool, Error> {
    let mut is_refused = false;
    for line in BufReader::new(crate::input::bounded(std::io::stdin())).lines() {
        let line = line?;
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        if matches!(line.trim(), "end" | "quit") {
            break;
        }
        let message = match session.actions(&words) {
            Err(message) => format!("error: {message}"),
            Ok(actions) => match session.run(&actions, head, &mut report) {
                Ok(()) => {
                    // Ctrl-C ends the program at once while nothing moves.
                    session.keep(head);
                    continue;
                }
                Err(error) if interrupt.has_stopped() => return Err(error),
                Err(error) => error_text(&error),
            },
        };
        is_refused = true;
        eprintln!("{message}");
    }
    Ok(is_refused)
}

/// Carries out the actions before a routine. Returns the probe.
///
/// # Errors
///
/// [`Stopped`]. An error is printed.
fn prepared(
    args: &Measure,
    (session, actions): (&mut Session, &[Action]),
    head: &mut Calibrated<Head<AnyPort>>,
    out: &mut dyn Write,
) -> Result<Stylus, Stopped> {
    let scale = session.scale;
    let mut written = Ok(());
    let result = session.run(actions, head, |row| {
        // JSON and CSV hold the features of the routine only.
        if args.format == Results::Text && written.is_ok() {
            written = writeln!(out, "{}", row.text(scale)).and_then(|()| out.flush());
        }
    });
    result.map_err(|error| {
        eprintln!("{}", error_text(&error));
        Stopped::Reported(mishap_of(head).unwrap_or(FAILED))
    })?;
    written.map_err(Stopped::Output)?;
    Ok(session.stylus())
}

/// Whether this is the name of a measuring machine, or the path of the file of one.
pub fn is_measuring(name: &str) -> bool {
    let is_kind = |text: String| {
        let table: Option<toml::Table> = text.parse().ok();
        table.is_some_and(|table| table.get("kind").and_then(|kind| kind.as_str()) == Some("cmm"))
    };
    MachineFile::is_measuring(name)
        || (!MachineFile::is_built_in(name)
            && crate::input::read_to_string(name).is_ok_and(is_kind))
}

/// The modules of a machine with a work piece, for a simulation that a page operates: the piece of
/// this file, or one to try the machine with.
///
/// # Errors
///
/// The file cannot be read, or does not fit the machine.
pub fn network_to_try(path: Option<&str>, machine: &Machine) -> Result<SimulatedNetwork, Stopped> {
    let piece = match (path, machine.scale.count_mm()) {
        (Some(_), _) => mounted(path, machine)?,
        (None, Some(_)) => {
            let piece = piece_file::to_try().map_err(Stopped::File)?;
            Some(Mounted::new(piece, machine)?)
        }
        // The length of a count is not known.
        (None, None) => None,
    };
    let face = match (&piece, machine.axes.first()) {
        (None, Some(axis)) => Some(format!("{}:{FACE_TO_TRY}", axis.module).parse()?),
        _ => None,
    };
    let faces: Vec<Contact> = face.into_iter().collect();
    Ok(SimulatedNetwork::of_machine(machine, &faces, piece)?)
}

/// The work piece of this file, mounted on a machine.
fn mounted(path: Option<&str>, machine: &Machine) -> Result<Option<Mounted>, Stopped> {
    let piece = path.map(piece_file::load).transpose();
    let piece = piece.map_err(Stopped::File)?;
    let mounted = piece.map(|piece| Mounted::new(piece, machine));
    Ok(mounted.transpose()?)
}

/// `husillo measure run`.
fn run_routine(
    args: &Measure,
    machine: &Machine,
    interrupt: &Interrupt,
    path: &str,
    before: (&mut Session, &[Action]),
    out: &mut dyn Write,
    file: &mut Vec<u8>,
) -> Result<(), Stopped> {
    let Some(routine) = Routine::load(path)? else {
        return Err(Stopped::Reported(WRONG));
    };
    let (session, actions) = before;
    let mut head = started(args, machine, interrupt, session)?;
    let ending = prepared(args, (session, actions), &mut head, out)
        .map(|stylus| routine::run(&routine, args, machine, &mut head, stylus, out, file));
    session.end(&mut head);
    let has_met_end = head.inner().has_met_end();
    let ending = ending?;
    ended(ending.map_err(|error| error.to_string())?, has_met_end)
}

/// `husillo measure record`.
fn record_routine(
    args: &Measure,
    machine: &Machine,
    interrupt: &Interrupt,
    path: &str,
    before: (&mut Session, &[Action]),
    out: &mut dyn Write,
) -> Result<(), Stopped> {
    let (session, actions) = before;
    let mut head = started(args, machine, interrupt, session)?;
    let ending = prepared(args, (session, actions), &mut head, out)
        .map(|stylus| routine::recorded(path, &mut head, stylus, out));
    session.end(&mut head);
    let has_met_end = head.inner().has_met_end();
    let ending = ending?;
    ended(
        ending.map_err(|error| format!("{path}: {error}"))?,
        has_met_end,
    )
}

/// Switches the servos on. Returns the machine.
fn started(
    args: &Measure,
    machine: &Machine,
    interrupt: &Interrupt,
    session: &Session,
) -> Result<Calibrated<Head<AnyPort>>, Stopped> {
    if machine.scale.unit() != "mm" {
        let message = format!(
            "{}: a routine is in mm, and the machine file has no `count` (the length of a count). \
             Add it, or use -m cmm3",
            machine.title
        );
        return Err(Stopped::Usage(message));
    }
    let line = session::open(args, machine, mounted(args.piece.as_deref(), machine)?)?;
    let line = line.with_operator(User::new(interrupt, args.raw));
    session.begin(line, args).map_err(|error| {
        eprintln!("{}", error_text(&error));
        Stopped::Reported(FAILED)
    })
}

const fn ended(ending: Ending, has_met_end: bool) -> Result<(), Stopped> {
    match ending {
        Ending::Failed if has_met_end => Err(Stopped::Reported(END_SWITCH)),
        Ending::Good => Ok(()),
        Ending::OutOfTolerance => Err(Stopped::Reported(OUT_OF_TOLERANCE)),
        Ending::Failed => Err(Stopped::Reported(FAILED)),
        Ending::Collision => Err(Stopped::Reported(COLLISION)),
    }
}

/// An error and its hint, as a sentence.
pub fn sentence(error: &Error) -> String {
    match help::help(error) {
        Some(help) => format!("{error}; {help}"),
        None => error.to_string(),
    }
}

/// The error message of an error, with its hint.
pub fn error_text(error: &Error) -> String {
    match help::help(error) {
        Some(help) => format!("error: {error}\n  help: {help}"),
        None => format!("error: {error}"),
    }
}
