//! Runs the commands, from their arguments to their exit status.

mod choice;
mod drilling;
mod explain;
mod job;
mod milling;
mod new_machine;
mod reporting;
mod reproduce;
mod rewrite;
mod schema;
mod simulate;
mod stop;

use husillo_sim::observers::AXES;
use job::{Job, displayed, load, not_loaded, whole};
pub use reporting::count;
use reporting::count as counted;
use reporting::{MOST_PRINTED, left_out, verdict, with_findings, with_some_findings};

use crate::cli::{
    Calibrate, Check, Cli, Command, Commands, Compare, Compile, DrillOrder, DrillOutput, Emulate,
    Holes, Interpolate, Jog, Listing, Machines, MachinesAction, Measure, Output, Page, Send, Shape,
    Steps, Target, Tune, What,
};
use crate::console;
use crate::console::shown;
use crate::console::told::Told;
use crate::diagnostics::{Findings, Format};
use crate::drill;
use crate::holes;
use crate::holes::drill_records::{Compiler, Refusal};
use crate::input;
use crate::lash;
use crate::machines::listing;
use crate::machines::machine_file::{MEASURING, MachineFile};
use crate::measuring::{self, Stopped};
use crate::methods::interpolate;
use crate::methods::one_move::one_move;
use crate::microfactory;
use crate::micromill;
use crate::output::Outputs;
use crate::programs::commands;
use crate::programs::program::{self, Meaning};
use crate::programs::setup;
use crate::programs::steps;
use crate::text::json::{write_found, write_line};
use crate::text::name;
use crate::tuning;
use husillo_clients::microfactory::Settings;
use husillo_gcode::Dialect;
use husillo_holes::Metric;
use husillo_methods::{Comparer, Weights, programmed};
use husillo_reports::methods;
use serde_json::json;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::Path;

/// The program has no errors.
const OK: u8 = 0;
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
        Command::Run(args) => simulate::simulate(args),
        Command::Check(args) => check_files(args),
        Command::Format(args) => rewrite::format_files(args),
        Command::Commands(args) => print_commands(args),
        Command::Steps(args) => write_steps(args),
        Command::Holes(args) => list_holes(args),
        Command::Compile(args) => compile(args),
        Command::Send(args) => driven(|out| {
            let mut told = Told::new(out, args.format, "husillo.send/1");
            send(args, &mut told)
        }),
        Command::Interpolate(args) => walk(args),
        Command::Compare(args) => compare_methods(args),
        Command::Machines(args) => show_machines(args),
        Command::Explain(args) => explain::explain(args),
        Command::Schema { name } => schema::print(name.as_deref()),
        Command::Completions { shell } => completions(*shell),
        Command::Man { folder } => man_pages(folder),
        Command::Jog(args) => driven(|out| {
            let mut told = Told::new(out, args.format, "husillo.jog/1");
            jog(args, &mut told)
        }),
        Command::Stop(args) => driven(|out| {
            let mut told = Told::new(out, args.format, "husillo.stop/1");
            stop::stop(args, &mut told)
        }),
        Command::Measure(args) => driven(|out| measure(args, out)),
        Command::Emulate(args) => emulate(args),
        Command::Tune(args) => driven(|out| tune_servo(args, out)),
        Command::Calibrate(args) => driven(|out| calibrate(args, out)),
        Command::Reproduce(args) => reproduce::reproduce(args),
    }
}

/// Prints the completions of a shell.
fn completions(shell: clap_complete::Shell) -> Result<u8, Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut crate::cli::command(), "husillo", &mut text);
    console::stdout().write_all(&text)?;
    Ok(OK)
}

/// Writes a manual page of the program and of each command.
fn man_pages(folder: &str) -> Result<u8, Failure> {
    let mut command = crate::cli::command().disable_help_subcommand(true);
    command.build();
    let mut outputs = Outputs::new();
    write_page(&command, folder, &mut outputs)?;
    outputs.finish()?;
    writeln!(
        console::stdout(),
        "Wrote      {}/husillo.1 and others",
        shown(folder)
    )?;
    Ok(OK)
}

/// Writes the manual pages of a command and of those below it.
fn write_page(command: &clap::Command, folder: &str, outputs: &mut Outputs) -> io::Result<()> {
    let man = clap_mangen::Man::new(command.clone());
    let mut page = Vec::new();
    man.render(&mut page)?;
    outputs.write(&format!("{folder}/{}", man.get_filename()), &page)?;
    let mut below = command
        .get_subcommands()
        .filter(|below| !below.is_hide_set());
    below.try_for_each(|below| write_page(below, folder, outputs))
}

fn show_machines(args: &Machines) -> Result<u8, Failure> {
    let out = &mut console::stdout();
    match &args.action {
        None if args.format == Output::Json => {
            let list = json!({"machines": listing::machines()?});
            write_line("husillo.machines/1", &list, out)?;
        }
        None => out.write_all(listing::list()?.as_bytes())?,
        Some(MachinesAction::New(args)) => return new_machine::make(args),
        Some(MachinesAction::Write {
            machine,
            file,
            format,
        }) => return write_machine(machine, file, *format),
        Some(MachinesAction::Show { machine, format }) if MachineFile::is_measuring(machine) => {
            // Its file contains all that is known of it.
            let text = MachineFile::text_of(machine).unwrap_or_default();
            match format {
                Output::Text => out.write_all(text.as_bytes())?,
                Output::Json => {
                    let file: toml::Table =
                        toml::from_str(text).map_err(|error| error.to_string())?;
                    let shown = json!({"name": machine, "title": file.get("title"), "file": file});
                    write_line("husillo.machines.measuring/1", &shown, out)?;
                }
            }
        }
        Some(MachinesAction::Show { machine, format }) => {
            let shown = listing::show(&load(machine)?);
            match format {
                Output::Text => out.write_all(shown.text().as_bytes())?,
                Output::Json => write_line("husillo.machines.show/1", &shown, out)?,
            }
        }
    }
    Ok(OK)
}

/// Writes the file of a built-in machine. An existing file is not replaced.
fn write_machine(machine: &str, file: &Option<String>, format: Output) -> Result<u8, Failure> {
    let Some(text) = MachineFile::text_of(machine) else {
        let names = MachineFile::names().join(", ");
        let measuring = MEASURING.map(|(name, ..)| name).join(", ");
        let why = format!("no machine `{machine}`: {names}, {measuring} are built in");
        return Err(Failure::Usage(why));
    };
    let file = match file.as_deref() {
        Some(file) => file.to_owned(),
        None => format!("{machine}.toml"),
    };
    write_new(machine, &file, text, format)?;
    Ok(OK)
}

/// Writes a machine file that does not exist yet; `-` is standard output.
fn write_new(machine: &str, file: &str, text: &str, format: Output) -> Result<(), Failure> {
    if own_output(Some(file), format)? == "-" {
        console::stdout().write_all(text.as_bytes())?;
        return Ok(());
    }
    if std::fs::symlink_metadata(name::path(Path::new(file))).is_ok() {
        let why = "exists already, and nothing is written: name another file";
        return Err(Failure::Usage(format!("{file} {why}")));
    }
    write(file, text.as_bytes())?;
    if format == Output::Json {
        let body = json!({"name": machine, "file": file});
        write_line("husillo.machines.file/1", &body, &mut console::stdout())?;
        return Ok(());
    }
    writeln!(
        console::stdout(),
        "Wrote      {} - use it with -m",
        shown(file)
    )?;
    Ok(())
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

fn jog(args: &Jog, out: &mut Told<'_>) -> Result<u8, Failure> {
    let is_well = match args.machine.as_str() {
        "drill" => drill::jog(args, out)?,
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
                    "{machine} cannot be moved by hand: name microfactory, drill, micromill, or \
                     the file of one of them"
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
            "--single-block is for the micro mill, not for the {machine}"
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

fn send(args: &Send, out: &mut Told<'_>) -> Result<u8, Failure> {
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

fn emulate(args: &Emulate) -> Result<u8, Failure> {
    let out = &mut console::stdout();
    // It is complete however the emulation ends.
    let mut outputs = Outputs::record();
    let done = emulate_into(args, &mut outputs, out);
    outputs.finish()?;
    done
}

/// Emulates a machine. The file of its events is one of `outputs`.
fn emulate_into(args: &Emulate, outputs: &mut Outputs, out: &mut dyn Write) -> Result<u8, Failure> {
    #[cfg(unix)]
    {
        let microfactory = microfactory(&args.machine)?;
        match (&microfactory, args.machine.as_str()) {
            (Some(_), _) => args.expect_microfactory()?,
            (None, "micromill" | "grbl") => args.expect_micromill()?,
            (None, "drill") => args.expect_drill()?,
            _ => args.expect_chain()?,
        }
        let made = match &args.steps {
            Some(path) => Some(Box::new(outputs.create(path)?) as Box<dyn Write>),
            None => None,
        };
        let served = match (&microfactory, args.machine.as_str()) {
            (Some(settings), _) => microfactory::emulate(args, settings, made, out),
            (None, "micromill") => micromill::emulate(args, made, out),
            (None, "grbl") => {
                let settings = match &args.mechanics {
                    Some(name) => crate::grbl::settings(&load(name)?)?,
                    None => husillo_transports::grbl::Settings::DEFAULT,
                };
                crate::grbl::emulate(args, settings, made, out)
            }
            (None, "drill") => drill::emulate(args, made, out),
            _ => return ended(measuring::emulate(args, out)),
        };
        Ok(served.map(|()| OK)?)
    }
    #[cfg(not(unix))]
    {
        args.expect_chain()?;
        ended(measuring::emulate(args, out))
    }
}

fn calibrate(args: &Calibrate, out: &mut dyn Write) -> Result<u8, Failure> {
    let told = |format, schema, out| Told::new(out, format, schema);
    ended(match &args.what {
        What::Backlash(args) => {
            let mut out = told(args.format, "husillo.calibrate.backlash/1", out);
            let made = lash::calibrate_backlash(args, &load(&args.machine)?, &mut out)?;
            let mut outputs = Outputs::new();
            for (path, text) in [(&args.report, made.page), (&args.output, made.machine)] {
                if let Some(path) = path {
                    outputs.write(path, text.as_bytes())?;
                }
            }
            Ok(outputs.finish()?)
        }
        What::Circles(args) => {
            let mut out = told(args.format, "husillo.calibrate.circles/1", out);
            Ok(lash::print_circles(args, &load(&args.machine)?, &mut out)?)
        }
        What::Axis(args) => {
            let mut out = told(args.format, "husillo.calibrate.axis/1", out);
            measuring::calibrate_axis(args, &mut out)
        }
        What::Squareness(args) => {
            let mut out = told(args.format, "husillo.calibrate.squareness/1", out);
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
        Err(Stopped::Told(status)) => Ok(status),
    }
}

fn walk(args: &Interpolate) -> Result<u8, Failure> {
    match &args.shape {
        Shape::Line(shape) => interpolate::print(&interpolate::line(shape)?, shape.format)?,
        Shape::Arc(shape) => interpolate::print(&interpolate::arc(shape)?, shape.format)?,
    }
    Ok(OK)
}

fn compare_methods(args: &Compare) -> Result<u8, Failure> {
    let weights = Weights::parse(&args.weights).ok_or_else(|| {
        format!(
            "--weights: `{}` is not four numbers from 0 up, one of them above 0",
            args.weights
        )
    })?;
    let mut comparer = Comparer::new(args.only.as_deref())?;
    let comparison = match one_move(args)? {
        Some((one, title)) => {
            comparer.add(&one);
            comparer.finish(title, Some(one), weights)
        }
        None => {
            let mut job = Job::new(&args.job, &args.target, "free")?;
            job.keep_input()?;
            let Some(comparer) = compare_program(&job, comparer)? else {
                return Ok(ERRORS);
            };
            comparer.finish(
                format!("{} on {}", job.name(), job.machine.title),
                None,
                weights,
            )
        }
    };
    if comparison.rows.is_empty() {
        let why = comparison.notes.first().map(String::as_str);
        let why = why.unwrap_or("no line and no arc at a feed, so there is nothing to compare");
        return Err(Failure::Usage(format!("{}: {why}", args.job)));
    }
    let format = args.format.unwrap_or(match &args.output {
        Some(path) if path.ends_with(".html") => Page::Html,
        Some(path) if path.ends_with(".json") => Page::Json,
        _ => Page::Text,
    });
    let mut outputs = Outputs::new();
    let mut out: Box<dyn Write> = match &args.output {
        Some(path) => Box::new(outputs.create(path)?),
        None => Box::new(console::stdout()),
    };
    match format {
        Page::Text => methods::print(&comparison, &mut out)?,
        Page::Json => {
            let body = json!({"methods": comparison.rows, "notes": comparison.notes});
            write_line("husillo.compare/1", &body, &mut out)?;
        }
        Page::Html => out.write_all(methods::html(&comparison).as_bytes())?,
    }
    out.flush()?;
    outputs.finish()?;
    if let Some(path) = &args.output {
        eprintln!("{path}: {}", count(comparison.rows.len() as u64, "method"));
    }
    Ok(OK)
}

/// Makes every feed move of a program; `None` if it has errors.
fn compare_program(job: &Job, mut comparer: Comparer) -> Result<Option<Comparer>, Failure> {
    let mut make = |command: &husillo_gcode::Command<AXES>, from| {
        let made = match command {
            husillo_gcode::Command::Linear { to, .. } => programmed::line(&job.config, from, *to),
            husillo_gcode::Command::Arc { arc, .. } => programmed::arc(&job.config, from, arc),
            _ => Ok(None),
        };
        match made {
            Ok(Some(one)) => comparer.add_common(&one),
            Ok(None) => {}
            Err(why) => comparer.note(why.to_owned()),
        }
    };
    let mut source = job.open()?;
    let (_, findings) = with_findings(|findings| {
        let each = |_: &Meaning<'_>, command: &_, from, _: &mut Findings| {
            make(command, from);
            Ok(())
        };
        Ok(program::walk(
            &mut source,
            job.name(),
            job.start,
            findings,
            each,
        )?)
    })?;
    if findings.errors > 0 {
        eprintln!(
            "{}: {}",
            job.name(),
            verdict(findings.errors, findings.warnings)
        );
        return Ok(None);
    }
    Ok(Some(comparer))
}

fn list_holes(args: &Holes) -> Result<u8, Failure> {
    let options = holes::Options::new(&args.layout)?;
    let work = match args.make {
        DrillOutput::Gcode => Some(holes::work(args)?),
        DrillOutput::List | DrillOutput::Drill => None,
    };
    let is_drill = args.make == DrillOutput::Drill;
    let to_file = args.output.as_ref().is_some_and(|path| path != "-");
    if is_drill && args.format == Output::Text && !to_file && io::stdout().is_terminal() {
        let message = "records are bytes and not for a terminal: see -o and --format json";
        return Err(Failure::Usage(message.into()));
    }
    // A list has the findings in it. Other forms may not be written for them.
    let printed = match args.make {
        DrillOutput::List => args.format,
        DrillOutput::Gcode | DrillOutput::Drill => Output::Text,
    };
    let name = displayed(&args.file);
    let text = whole(&args.file)?;
    let (mut board, findings) = with_some_findings(MOST_PRINTED, printed, |findings| {
        Ok(holes::read(&text, name, &options, findings))
    })?;
    let (errors, warnings) = (findings.errors, findings.warnings);
    if errors > 0 && args.make != DrillOutput::List {
        eprintln!("{name}: {}; nothing written", verdict(errors, warnings));
        return Ok(ERRORS);
    }
    if let Some(fit) = holes::apply(&mut board, &options)? {
        eprintln!("{name}: {fit}");
    }
    if args.layout.order == DrillOrder::Shortest {
        board.sort_shortest(Metric::Straight);
    }
    // Everything is computed before the file is written.
    let mut made = Vec::new();
    match (work, args.format) {
        (Some(work), _) => {
            work.check(&board).map_err(|error| holes::uncut(&error))?;
            work.write(&board, name, &mut made)?;
        }
        (None, format) if is_drill => {
            let compiler = Compiler::new(&args.layout);
            let tools = match compiler.compile(&board, name) {
                Ok(tools) => tools,
                Err(Refusal::Usage(message)) => return Err(Failure::Usage(message)),
                Err(Refusal::Finding(finding)) => {
                    reporting::print(&[*finding])?;
                    return Ok(ERRORS);
                }
            };
            match format {
                Output::Text => made = compiler.bytes(&tools, name)?,
                Output::Json => compiler.print_json(&tools, &mut made)?,
            }
        }
        (None, Output::Text) => holes::listing::print(&board, name, &mut made)?,
        (None, Output::Json) => holes::listing::print_json(&board, &findings, &mut made)?,
    }
    match args.output.as_deref().unwrap_or("-") {
        // A list is text or one line of JSON; the other forms are bytes for a machine.
        "-" if args.make == DrillOutput::List => console::stdout().write_all(&made)?,
        path => write(path, &made)?,
    }
    if errors > 0 {
        eprintln!("{name}: {}", verdict(errors, warnings));
        return Ok(ERRORS);
    }
    Ok(OK)
}

fn check_files(args: &Check) -> Result<u8, Failure> {
    let mut code = OK;
    for file in &args.files {
        let mut findings = Findings::new(args.limit);
        let checked = check_file(args, file, &mut findings);
        print_checked(args, file, &findings, checked.is_ok())?;
        checked?;
        if findings.errors > 0 || (args.deny_warnings && findings.warnings > 0) {
            code = ERRORS;
        }
    }
    Ok(code)
}

/// Checks a program or a drill file. Returns the findings.
fn check_file(args: &Check, file: &str, findings: &mut Findings) -> Result<(), Failure> {
    if holes::is_drill_file(args.target.dialect.as_deref(), file) {
        let name = displayed(file);
        let board = holes::read(&whole(file)?, name, &holes::Options::default(), findings);
        if let Some(machine) = &args.target.machine {
            holes::check_travel(&board, name, &load(machine)?, findings);
        }
    } else {
        let mut job = Job::new(file, &args.target, "free")?;
        job.place(args.place.zero)?;
        job.check(findings)?;
    }
    Ok(())
}

/// Prints the findings and, as text, the verdict about a file that was checked to its end.
fn print_checked(args: &Check, file: &str, findings: &Findings, is_whole: bool) -> io::Result<()> {
    let stdout = io::stdout();
    let is_coloured = console::is_coloured(&stdout);
    if args.format == Format::Json {
        let body = json!({
            "file": displayed(file),
            "errors": findings.errors,
            "warnings": findings.warnings,
        });
        return write_found("husillo.check/1", &body, findings, &mut console::stdout());
    }
    let mut out = BufWriter::new(stdout.lock());
    findings.print(args.format, is_coloured, &mut out)?;
    if is_whole && args.format == Format::Text {
        if let Some(left_out) = left_out(findings) {
            writeln!(out, "{left_out}\n")?;
        }
        let verdict = verdict(findings.errors, findings.warnings);
        writeln!(out, "{}: {verdict}", shown(displayed(file)))?;
    }
    out.flush()
}

fn print_commands(args: &Commands) -> Result<u8, Failure> {
    if args.file.to_ascii_lowercase().ends_with(".cod") {
        return drilling::list(&args.file, args.format);
    }
    if args.format == Listing::Gcode {
        let message = "--format gcode is for records of the drill, *.cod";
        return Err(Failure::Usage(message.into()));
    }
    let mut job = Job::new(&args.file, &args.target, "free")?;
    job.place(args.place.zero)?;
    let mut source = job.open()?;
    let mut out = BufWriter::with_capacity(1 << 18, console::stdout());
    let json = args.format == Listing::Json;
    let format = if json { Output::Json } else { Output::Text };
    let ((), findings) = with_some_findings(args.limit, format, |findings| {
        commands::print(&mut source, job.name(), job.start, json, findings, &mut out)?;
        Ok(out.flush()?)
    })?;
    if json {
        let body = json!({
            "kind": "findings",
            "errors": findings.errors,
            "warnings": findings.warnings,
        });
        write_found(
            "husillo.commands/1",
            &body,
            &findings,
            &mut console::stdout(),
        )?;
    }
    Ok(if findings.errors > 0 { ERRORS } else { OK })
}

fn write_steps(args: &Steps) -> Result<u8, Failure> {
    let path = own_output(Some(&args.output), args.format)?;
    let mut job = choice::job(&args.file, &args.target, args.place.zero, args.limit)?;
    let (_, findings) =
        with_some_findings(args.limit, args.format, |findings| job.check(findings))?;
    let print = |job: &Job, count: Option<u64>| {
        let body = json!({
            "file": job.name(),
            "machine": job.machine.name,
            "output": count.map(|_| path),
            "step_events": count,
            "errors": findings.errors,
            "warnings": findings.warnings,
        });
        write_found("husillo.steps/1", &body, &findings, &mut console::stdout())
    };
    if findings.errors > 0 {
        if args.format == Output::Json {
            print(&job, None)?;
            return Ok(ERRORS);
        }
        eprintln!(
            "{}: {}; nothing moves",
            job.name(),
            verdict(findings.errors, findings.warnings)
        );
        choice::suggest(&job, &args.target, args.place.zero, &findings)?;
        return Ok(ERRORS);
    }
    let mut source = job.open()?;
    let mut machine = job.new_machine(!args.no_compensation)?;
    let motors = args
        .levels
        .then(|| setup::motors(&job.machine))
        .transpose()?;
    let mut outputs = Outputs::new();
    let mut out = outputs.create(path)?;
    let count = steps::write(&mut source, &mut machine, &job.piece(), motors, &mut out)?;
    out.flush()?;
    outputs.finish()?;
    if args.format == Output::Json {
        print(&job, Some(count))?;
    } else if path != "-" {
        eprintln!("{path}: {}", counted(count, "step event"));
    }
    Ok(OK)
}

/// Writes the only output of a command; `-` is standard output.
fn write(path: &str, bytes: &[u8]) -> io::Result<()> {
    let mut outputs = Outputs::new();
    outputs.write(path, bytes)?;
    outputs.finish()
}
