//! Runs the commands, from their arguments to their exit status.

mod check;
mod choice;
mod commands;
mod compare;
mod drilling;
mod examples;
mod explain;
mod format;
mod grbl;
mod holes;
mod job;
mod machines;
mod manual;
mod milling;
mod reporting;
mod reproduce;
mod run;
mod schema;
mod serving;
mod steps;
mod stop;

pub use grbl::{Before, sendable_lines};
use job::{load, not_loaded};
pub use reporting::count;
pub use run::report;

use crate::backlash;
use crate::cli::{
    Calibrate, Cli, Command, Compile, Emulate, Interpolate, Jog, Measure, Output, Send, Shape,
    Target, Tune, What,
};
use crate::console;
use crate::console::reporter::Reporter;
use crate::drill;
#[cfg(unix)]
use crate::emulate;
use crate::input;
use crate::measuring::{self, Stopped};
use crate::methods::interpolate;
use crate::microfactory;
use crate::micromill;
use crate::output::Outputs;
use crate::tuning;
use husillo_clients::microfactory::Settings;
use husillo_gcode::Dialect;
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_simulator::programs::setup;
use husillo_simulator::text::json::write_line;
use serde_json::json;
use std::io::{self, Write};

/// The program has no errors.
pub const OK: u8 = 0;
/// The program has errors.
const ERRORS: u8 = 1;

/// Why there is no exit status of a command.
#[derive(Debug)]
pub enum Failure {
    /// The reader of the output has closed it.
    Gone,
    /// Bad command line or file.
    Usage(String),
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Usage(message)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::Gone,
            _ => Self::Usage(error.to_string()),
        }
    }
}

/// Runs a command.
///
/// # Errors
///
/// See [`Failure`].
pub fn run(cli: &Cli) -> Result<u8, Failure> {
    match &cli.command {
        Command::Run(args) => run::simulate(args),
        Command::Check(args) => check::check_files(args),
        Command::Format(args) => format::format_files(args),
        Command::Commands(args) => commands::print_commands(args),
        Command::Steps(args) => steps::write_steps(args),
        Command::Holes(args) => holes::list_holes(args),
        Command::Compile(args) => compile(args),
        Command::Send(args) => driven(|out| {
            let mut reporter = Reporter::new(out, args.format, "husillo.send/1");
            send(args, &mut reporter)
        }),
        Command::Interpolate(args) => walk(args),
        Command::Compare(args) => compare::compare(args),
        Command::Machines(args) => machines::show_machines(args),
        Command::Examples { action } => examples::examples(action),
        Command::Explain(args) => explain::explain(args),
        Command::Schema { name } => schema::print(name.as_deref()),
        Command::Completions { shell } => manual::completions(*shell),
        Command::Man { folder } => manual::man_pages(folder),
        Command::Jog(args) => driven(|out| {
            let mut reporter = Reporter::new(out, args.format, "husillo.jog/1");
            jog(args, &mut reporter)
        }),
        Command::Serve(args) => driven(|out| {
            let mut reporter = Reporter::new(out, args.format, "husillo.serve/1");
            let served = serving::machines(args)?;
            crate::serve::serve(args, &served, &mut reporter)
        }),
        Command::Stop(args) => driven(|out| {
            let mut reporter = Reporter::new(out, args.format, "husillo.stop/1");
            stop::stop(args, &mut reporter)
        }),
        Command::Measure(args) => driven(|out| measure(args, out)),
        Command::Emulate(args) => emulate(args),
        Command::Tune(args) => driven(|out| tune_servo(args, out)),
        Command::Calibrate(args) => driven(|out| calibrate(args, out)),
        Command::Reproduce(args) => reproduce::reproduce(args),
    }
}

/// Calls a function that drives a machine, with an output that never stops it. Its exit status
/// outranks an output that failed.
fn driven(drive: impl FnOnce(&mut dyn Write) -> Result<u8, Failure>) -> Result<u8, Failure> {
    let mut out = console::lasting_stdout();
    let code = drive(&mut out)?;
    match out.end() {
        Err(error) if code == OK => Err(error.into()),
        _ => Ok(code),
    }
}

fn jog(args: &Jog, out: &mut Reporter<'_>) -> Result<u8, Failure> {
    let is_well = match args.machine.as_str() {
        "drill" => drill::jog(args, out)?,
        machine if grbl::is_grbl(Some(machine)) => {
            let is_well = crate::grbl::jog(args, out)?;
            return Ok(if is_well { OK } else { milling::failed() });
        }
        machine if milling::is_mill(machine) => {
            let file = load(machine)?;
            let config = setup::first_three(&setup::config(&file, Dialect::MICROMILL)?);
            if let [port] = &args.port[..] {
                milling::expect_a_port(port, &config)?;
            }
            let is_well = micromill::jog(args, config, out)?;
            return Ok(if is_well { OK } else { milling::failed() });
        }
        machine => {
            let settings = microfactory(machine)?.ok_or_else(|| {
                format!(
                    "{machine} cannot be moved by hand: name microfactory, drill, micromill, the \
                     file of one of them, or grbl"
                )
            })?;
            microfactory::jog(args, &settings, out)?
        }
    };
    Ok(if is_well { OK } else { ERRORS })
}

fn expect_no_single_block(args: &Send, machine: &str) -> Result<(), String> {
    match args.single_block {
        true => Err(format!(
            "--single-block is for the micro mill and Grbl, not for the {machine}"
        )),
        false => Ok(()),
    }
}

fn compile(args: &Compile) -> Result<u8, Failure> {
    if let Some(settings) = figures(&args.target, &args.file)? {
        let path = made_at(args)?;
        let text = microfactory::list(&args.file, &settings)?;
        write(path, text.as_bytes())?;
        if args.format == Output::Json {
            let lines = text.lines().count();
            let body = json!({"kind": "file", "output": path, "lines": lines});
            write_line("husillo.compile/1", &body, &mut console::stdout())?;
        }
        return Ok(OK);
    }
    if milling::is_for(&args.target, &args.file) {
        milling::compile(args)
    } else {
        drilling::compile(args)
    }
}

/// Where `compile` writes what it makes; `-` is standard output.
fn made_at(args: &Compile) -> Result<&str, Failure> {
    own_output(args.output.as_deref(), args.format)
}

/// The file that a command writes; `-` is standard output, which JSON has for itself.
fn own_output(output: Option<&str>, format: Output) -> Result<&str, Failure> {
    match (output.unwrap_or("-"), format) {
        ("-", Output::Json) => Err(Failure::Usage(
            "--format json takes standard output: name a file with -o".into(),
        )),
        (path, _) => Ok(path),
    }
}

fn send(args: &Send, out: &mut Reporter<'_>) -> Result<u8, Failure> {
    if grbl::is_grbl(args.target.machine.as_deref()) {
        return grbl::send(args, out);
    }
    if args.checked {
        let message = "--checked is for a Grbl controller: the links of the other machines have \
                       their own checks";
        return Err(Failure::Usage(message.to_owned()));
    }
    let first = args.files.first().map_or("", String::as_str);
    if let Some(settings) = figures(&args.target, first)? {
        expect_no_single_block(args, "microfactory")?;
        if args.from.is_some() {
            let message = "a microfactory cuts a figure from its start: --from is for the drill \
                           and the micro mill";
            return Err(message.to_owned().into());
        }
        let is_well = microfactory::send(args, &settings, out)?;
        return Ok(if is_well { OK } else { ERRORS });
    }
    let (file, _) = args.alone()?;
    if milling::is_for(&args.target, file) {
        milling::send(args, out)
    } else {
        expect_no_single_block(args, "drill")?;
        drilling::send(args, out)
    }
}

/// The settings of the microfactory that a file is for; `None` for another machine. A list of moves
/// is for a microfactory only.
fn figures(target: &Target, file: &str) -> Result<Option<Settings>, Failure> {
    let is_list = microfactory::is_list(file);
    let machine = target.machine.as_deref();
    let machine = machine.or(is_list.then_some("microfactory"));
    match machine.map_or(Ok(None), microfactory)? {
        None if is_list => Err(only_microfactory(file)),
        settings => Ok(settings),
    }
}

fn only_microfactory(file: &str) -> Failure {
    Failure::Usage(format!("{file}: a list of moves is for -m microfactory"))
}

/// The settings of a microfactory; `None` for another machine.
fn microfactory(machine: &str) -> Result<Option<Settings>, Failure> {
    let says_so = || input::read_to_string(machine).is_ok_and(|text| text.contains("[bytes]"));
    // A file may have the name of a machine, and a port has no file name extension.
    let is_file = || !MachineFile::is_built_in(machine) && says_so();
    if machine != "microfactory" && !is_file() {
        return Ok(None);
    }
    Ok(microfactory::settings_of(&load(machine)?))
}

fn measure(args: &Measure, out: &mut dyn Write) -> Result<u8, Failure> {
    let mut table = Vec::new();
    let result = measuring::measure(args, out, &mut table);
    if let Some(path) = args.output.as_ref().filter(|_| !table.is_empty()) {
        write(path, &table)?;
    }
    ended(result)
}

fn tune_servo(args: &Tune, out: &mut dyn Write) -> Result<u8, Failure> {
    let mut page = String::new();
    let result = tuning::tune(args, out, &mut page);
    if let Some(path) = args.output.as_ref().filter(|_| !page.is_empty()) {
        write(path, page.as_bytes())?;
    }
    ended(result)
}

#[cfg(unix)]
fn emulate(args: &Emulate) -> Result<u8, Failure> {
    let out = &mut console::stdout();
    // It is complete however the emulation ends.
    let mut outputs = Outputs::record();
    let done = emulate_into(args, &mut outputs, out);
    outputs.finish()?;
    done
}

#[cfg(not(unix))]
fn emulate(_: &Emulate) -> Result<u8, Failure> {
    ended(Err(Stopped::Usage(
        "this system has no pseudo-terminals".into(),
    )))
}

/// Emulates a machine. The file of its events is one of `outputs`.
#[cfg(unix)]
fn emulate_into(args: &Emulate, outputs: &mut Outputs, out: &mut dyn Write) -> Result<u8, Failure> {
    let microfactory = microfactory(&args.machine)?;
    match (&microfactory, args.machine.as_str()) {
        (Some(_), _) => args.expect_microfactory()?,
        (None, "micromill" | "grbl" | "grblhal") => args.expect_micromill()?,
        (None, "drill") => args.expect_drill()?,
        _ => args.expect_network()?,
    }
    let made = match &args.steps {
        Some(path) => Some(Box::new(outputs.create(path)?) as Box<dyn Write>),
        None => None,
    };
    let served = match (&microfactory, args.machine.as_str()) {
        (Some(settings), _) => emulate::microfactory::emulate(args, settings, made, out),
        (None, "micromill") => emulate::micromill::emulate(args, made, out),
        (None, "grbl" | "grblhal") => {
            let settings = match &args.mechanics {
                Some(name) => crate::grbl::settings(&load(name)?)?,
                None => husillo_transports::grbl::Settings::DEFAULT,
            };
            emulate::grbl::emulate(args, settings, made, out)
        }
        (None, "drill") => emulate::drill::emulate(args, made, out),
        _ => return ended(measuring::emulate(args, out)),
    };
    Ok(served.map(|()| OK)?)
}

fn calibrate(args: &Calibrate, out: &mut dyn Write) -> Result<u8, Failure> {
    let reporter = |format, schema, out| Reporter::new(out, format, schema);
    ended(match &args.what {
        What::Backlash(args) => {
            let mut out = reporter(args.format, "husillo.calibrate.backlash/1", out);
            let made = backlash::calibrate_backlash(args, &load(&args.machine)?, &mut out)?;
            let mut outputs = Outputs::new();
            for (path, text) in [(&args.report, made.page), (&args.output, made.machine)] {
                if let Some(path) = path {
                    outputs.write(path, text.as_bytes())?;
                }
            }
            Ok(outputs.finish()?)
        }
        What::Circles(args) => {
            let mut out = reporter(args.format, "husillo.calibrate.circles/1", out);
            Ok(backlash::print_circles(
                args,
                &load(&args.machine)?,
                &mut out,
            )?)
        }
        What::Axis(args) => {
            let mut out = reporter(args.format, "husillo.calibrate.axis/1", out);
            measuring::calibrate_axis(args, &mut out)
        }
        What::Squareness(args) => {
            let mut out = reporter(args.format, "husillo.calibrate.squareness/1", out);
            measuring::calibrate_squareness(args, &mut out)
        }
    })
}

/// The exit status of a command on a measuring machine.
fn ended(result: Result<(), Stopped>) -> Result<u8, Failure> {
    match result {
        Ok(()) => Ok(OK),
        Err(Stopped::Usage(message)) => Err(Failure::Usage(message)),
        Err(Stopped::File(error)) => Err(not_loaded("the machine", error)?),
        Err(Stopped::Machine(message)) => {
            eprintln!("{message}");
            Ok(ERRORS)
        }
        Err(Stopped::Output(error)) => Err(error.into()),
        Err(Stopped::Reported(status)) => Ok(status),
    }
}

fn walk(args: &Interpolate) -> Result<u8, Failure> {
    match &args.shape {
        Shape::Line(shape) => interpolate::print(&interpolate::line(shape)?, shape.format)?,
        Shape::Arc(shape) => interpolate::print(&interpolate::arc(shape)?, shape.format)?,
    }
    Ok(OK)
}

/// Writes the only output of a command; `-` is standard output.
fn write(path: &str, bytes: &[u8]) -> io::Result<()> {
    let mut outputs = Outputs::new();
    outputs.write(path, bytes)?;
    outputs.finish()
}
