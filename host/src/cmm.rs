//! Measuring machines: `husillo measure` and `husillo emulate`.
//!
//! ```text
//! file, action ─► session ─► calibrated ─► head ─► line ─► port ─┬─► emulated     simulated time
//!                    │         servo, way, touching  ├─► serial device, socket
//! routine ─────────────┘  └─► result_row            │
//! contact, piece ─► emulated ─► terminal ─────────────┘   real time
//! ```

mod action;
mod axis_fit;
mod calibrated;
mod calibrating;
mod calibration_file;
mod contact;
mod direction;
pub mod emulated;
pub mod file;
mod head;
mod homing;
pub mod interrupt;
mod jog;
pub mod line;
#[cfg(test)]
mod noise_test;
mod piece;
mod piece_file;
pub mod port;
mod prober;
mod reference;
mod result_row;
mod routine;
mod scale;
mod servo;
mod session;
mod square_fit;
mod touching;
pub mod trouble;
mod way;

pub use calibrating::{calibrate_axis, calibrate_squareness};
pub use contact::Contact;
pub use port::{Port, read as read_port};

use crate::cli::{Emulate, Measure, Results};
use crate::machine_file::LoadError;
use calibrated::Calibrated;
use file::{CmmFile, Stylus};
use head::Head;
use interrupt::{INTERRUPTED, Interrupt};
use piece::Mounted;
use result_row::{CSV_HEAD, ResultRow};
use routine::{Ending, Routine};
use session::Session;
use std::io::Write;
use trouble::Trouble;

/// How a command on a measuring machine ended without being done.
pub enum Stopped {
    /// Bad command line or file.
    Usage(String),
    /// The machine file has mistakes, or cannot be read.
    File(LoadError),
    /// Something on the machine.
    Machine(String),
    /// All is told; this is the exit status.
    Told(u8),
}

impl From<String> for Stopped {
    fn from(message: String) -> Self {
        Self::Usage(message)
    }
}

/// Exit status of a routine that found something out of tolerance.
const OUT_OF_TOLERANCE: u8 = 1;
/// Exit status of a routine with mistakes; nothing has moved.
const WRONG: u8 = 2;
/// Exit status of a routine that stopped on the way.
const TROUBLE: u8 = 3;

/// `husillo measure`: prints the results to `out`, and what `-o` asks for to `table`.
///
/// # Errors
///
/// [`Stopped`]; the results before it are printed.
pub fn measure(args: &Measure, out: &mut dyn Write, table: &mut Vec<u8>) -> Result<(), Stopped> {
    let machine = CmmFile::load(args.machine.as_deref().unwrap_or("cmm")).map_err(Stopped::File)?;
    let interrupt = Interrupt::listen()?;
    let done = measure_by(args, &machine, &interrupt, out, table);
    match done {
        Err(Stopped::Machine(message)) if interrupt.has_stopped() => {
            eprintln!("{message}");
            Err(Stopped::Told(INTERRUPTED))
        }
        Err(Stopped::Told(TROUBLE)) if interrupt.has_stopped() => Err(Stopped::Told(INTERRUPTED)),
        done => done,
    }
}

fn measure_by(
    args: &Measure,
    machine: &CmmFile,
    interrupt: &Interrupt,
    out: &mut dyn Write,
    table: &mut Vec<u8>,
) -> Result<(), Stopped> {
    let words: Vec<&str> = args.actions.iter().map(String::as_str).collect();
    match *words.as_slice() {
        ["run", path] => return run_routine(args, machine, interrupt, path, out, table),
        ["record", path] => return record_routine(args, machine, interrupt, path, out),
        ["run" | "record", ..] => {
            let message = format!("`{0}` what? As in `{0} part.routine`, alone", words[0]);
            return Err(Stopped::Usage(message));
        }
        _ => {}
    }
    let mut session = Session::new(args, machine)?;
    let line = session::open(args, machine, mounted(args.piece.as_deref(), machine)?)?;
    let line = line.with_interrupt(interrupt.clone());
    let mut rows: Vec<ResultRow> = Vec::new();
    let scale = session.scale;
    let mut written = Ok(());
    let result = Head::start(line, machine, args.repeat).and_then(|head| {
        let mut head = Calibrated::new(head, machine.errors.clone());
        session.run(&mut head, |row| {
            if args.format == Results::Text && written.is_ok() {
                written = writeln!(out, "{}", row.text(scale)).and_then(|()| out.flush());
            }
            rows.push(row.clone());
        })
    });
    if args.format == Results::Json {
        let json = serde_json::to_string_pretty(&rows).map_err(|error| error.to_string())?;
        written = writeln!(out, "{json}");
    }
    written = written.and_then(|()| {
        writeln!(table, "{CSV_HEAD}")?;
        rows.iter()
            .try_for_each(|row| writeln!(table, "{}", row.csv()))?;
        match args.format {
            Results::Csv => out.write_all(table),
            Results::Text | Results::Json => Ok(()),
        }
    });
    result.map_err(|trouble| Stopped::Machine(told(&trouble)))?;
    written.map_err(|error| Stopped::Usage(error.to_string()))
}

/// The piece of this file on a machine.
fn mounted(path: Option<&str>, machine: &CmmFile) -> Result<Option<Mounted>, Stopped> {
    let piece = path.map(piece_file::load).transpose();
    let piece = piece.map_err(Stopped::File)?;
    let mounted = piece.map(|piece| Mounted::new(piece, machine));
    Ok(mounted.transpose()?)
}

/// `husillo measure run`.
fn run_routine(
    args: &Measure,
    machine: &CmmFile,
    interrupt: &Interrupt,
    path: &str,
    out: &mut dyn Write,
    file: &mut Vec<u8>,
) -> Result<(), Stopped> {
    let Some(routine) = Routine::load(path)? else {
        return Err(Stopped::Told(WRONG));
    };
    let (mut head, stylus) = started(args, machine, interrupt)?;
    let ending = routine::run(&routine, args, machine, &mut head, stylus, out, file);
    ended(ending.map_err(|error| error.to_string())?)
}

/// `husillo measure record`.
fn record_routine(
    args: &Measure,
    machine: &CmmFile,
    interrupt: &Interrupt,
    path: &str,
    out: &mut dyn Write,
) -> Result<(), Stopped> {
    let (mut head, stylus) = started(args, machine, interrupt)?;
    let ending = routine::recorded(path, &mut head, stylus, out);
    ended(ending.map_err(|error| format!("{path}: {error}"))?)
}

/// The machine with its servos on, and its probe.
fn started(
    args: &Measure,
    machine: &CmmFile,
    interrupt: &Interrupt,
) -> Result<(Calibrated<Head>, Stylus), Stopped> {
    if machine.scale.unit() != "mm" {
        let message = format!(
            "{}: nobody has said what a count is worth, and a routine is in mm: `count` in the machine file, or -m cmm3",
            machine.title
        );
        return Err(Stopped::Usage(message));
    }
    let stylus = session::stylus(args, machine)?;
    let line = session::open(args, machine, mounted(args.piece.as_deref(), machine)?)?;
    let line = line.with_interrupt(interrupt.clone());
    let head = Head::start(line, machine, args.repeat);
    let head = head.map_err(|trouble| {
        eprintln!("{}", told(&trouble));
        Stopped::Told(TROUBLE)
    })?;
    Ok((Calibrated::new(head, machine.errors.clone()), stylus))
}

const fn ended(ending: Ending) -> Result<(), Stopped> {
    match ending {
        Ending::Good => Ok(()),
        Ending::OutOfTolerance => Err(Stopped::Told(OUT_OF_TOLERANCE)),
        Ending::Trouble => Err(Stopped::Told(TROUBLE)),
    }
}

/// A trouble with what to look at.
pub fn told(trouble: &Trouble) -> String {
    match trouble.help() {
        Some(help) => format!("error: {trouble}\n  help: {help}"),
        None => format!("error: {trouble}"),
    }
}

/// `husillo emulate`: runs until it is stopped.
///
/// # Errors
///
/// [`Stopped`].
#[cfg(unix)]
pub fn emulate(args: &Emulate, out: &mut dyn Write) -> Result<(), Stopped> {
    use crate::terminal::{self, Pace, Terminal};
    use std::path::Path;
    use std::time::Duration;

    let machine = CmmFile::load(&args.machine).map_err(Stopped::File)?;
    let versions = match &args.modules {
        Some(list) => emulated::versions(list)?,
        None => vec![4; usize::from(machine.modules())],
    };
    let mut emulated = emulated::Emulated::new(
        &versions,
        &args.contact,
        mounted(args.piece.as_deref(), &machine)?,
    )?
    .with_noise(args.noise);
    let pace = Pace {
        speed: args.speed,
        limit: args.seconds.map(Duration::from_secs_f64),
        is_over: terminal::stop_flag()?,
    };
    let mut terminal =
        Terminal::new(Path::new(&args.link)).map_err(|error| format!("{}: {error}", args.link))?;
    let modules = if versions.len() == 1 {
        "module"
    } else {
        "modules"
    };
    writeln!(
        out,
        "{}: {} {modules} at {}; Ctrl-C ends it\nConnect: husillo measure -m {} --port {} status\nPanel: {}",
        machine.title,
        versions.len(),
        args.link,
        args.machine,
        args.link,
        emulated::PANEL
    )
    .and_then(|()| out.flush())
    .and_then(|()| terminal.run(&mut emulated, &pace, out))
    .map_err(|error| Stopped::Machine(format!("error: {}: {error}", args.link)))
}

/// `husillo emulate`, where there are no pseudo-terminals.
///
/// # Errors
///
/// Always.
#[cfg(not(unix))]
pub fn emulate(_: &Emulate, _: &mut dyn Write) -> Result<(), Stopped> {
    Err(Stopped::Usage("this system has no pseudo-terminals".into()))
}
