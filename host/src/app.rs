//! What each command does, from its arguments to its exit status.

use crate::check::{self, Facts, duration};
use crate::cli::{
    Check, Cli, Command, Commands, Compare, DrillOrder, DrillOutput, Emulate, FormatArgs, Holes,
    Interpolate, Measure, Output, Page, Run as RunArgs, Shape, Steps, Target,
};
use crate::cmm::{self, Stopped};
use crate::compare::{self, Bench};
use crate::decision::Weights;
use crate::diagnostics::{Findings, Format};
use crate::drill_code::Work;
use crate::drill_file::{Compiler, Refusal};
use crate::format;
use crate::holes;
use crate::machine_file::{LoadError, MachineFile, Travel};
use crate::report::{self, AxisRow, Report, length};
use crate::run::Run;
use crate::source::{self, Source};
use crate::{commands, compare_page, compare_text, feeder, grid, interpolate, setup, steps};
use husillo_gcode::Dialect;
use husillo_machine::{Config, Machine};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::fs::File;
use std::io::{self, BufWriter, IsTerminal, Read, Write};
use std::path::Path;

/// The program has no errors.
const OK: u8 = 0;
/// The program has errors.
const ERRORS: u8 = 1;

/// Why there is no exit status of a command.
#[derive(Debug)]
pub enum Failure {
    /// The reader of our output has gone away.
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
        Command::Run(args) => simulate(args),
        Command::Check(args) => check_files(args),
        Command::Format(args) => format_files(args),
        Command::Commands(args) => print_commands(args),
        Command::Steps(args) => write_steps(args),
        Command::Holes(args) => list_holes(args),
        Command::Interpolate(args) => walk(args),
        Command::Compare(args) => compare_methods(args),
        Command::Measure(args) => measure(args),
        Command::Emulate(args) => emulate(args),
    }
}

fn measure(args: &Measure) -> Result<u8, Failure> {
    let mut table = Vec::new();
    let result = cmm::measure(args, &mut io::stdout().lock(), &mut table);
    if let Some(path) = args.output.as_ref().filter(|_| !table.is_empty()) {
        create(path)?.write_all(&table)?;
    }
    ended(result)
}

fn emulate(args: &Emulate) -> Result<u8, Failure> {
    ended(cmm::emulate(args, &mut io::stdout().lock()))
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
    }
}

fn walk(args: &Interpolate) -> Result<u8, Failure> {
    match &args.shape {
        Shape::Line(shape) => interpolate::line(shape)?.print(shape.format)?,
        Shape::Arc(shape) => interpolate::arc(shape)?.print(shape.format)?,
    }
    Ok(OK)
}

fn compare_methods(args: &Compare) -> Result<u8, Failure> {
    let weights = Weights::parse(&args.weights)?;
    let mut bench = Bench::new(args.only.as_deref())?;
    let comparison = match compare::one_move(args)? {
        Some((one, title)) => {
            bench.add(&one);
            bench.finish(title, Some(one), weights)
        }
        None => {
            let mut job = Job::new(&args.job, &args.target, "free")?;
            job.keep_input()?;
            let Some(bench) = compare_program(&job, bench)? else {
                return Ok(ERRORS);
            };
            bench.finish(
                format!("{} on {}", job.name(), job.machine.title),
                None,
                weights,
            )
        }
    };
    if comparison.rows.is_empty() {
        let why = comparison.notes.first().map(String::as_str);
        let why = why.unwrap_or("no line and no arc at a feed");
        return Err(Failure::Usage(format!("{}: {why}", args.job)));
    }
    let format = args.format.unwrap_or(match &args.output {
        Some(path) if path.ends_with(".html") => Page::Html,
        Some(path) if path.ends_with(".json") => Page::Json,
        _ => Page::Text,
    });
    let mut out: Box<dyn Write> = match &args.output {
        Some(path) => Box::new(BufWriter::new(create(path)?)),
        None => Box::new(io::stdout().lock()),
    };
    match format {
        Page::Text => compare_text::print(&comparison, &mut out)?,
        Page::Json => {
            let json = serde_json::to_string_pretty(&comparison.rows).map_err(io::Error::other)?;
            writeln!(out, "{json}")?;
            for note in &comparison.notes {
                eprintln!("note: {note}");
            }
        }
        Page::Html => out.write_all(compare_page::html(&comparison).as_bytes())?,
    }
    out.flush()?;
    if let Some(path) = &args.output {
        eprintln!("{path}: {} methods", comparison.rows.len());
    }
    Ok(OK)
}

/// Makes every feed move of a program; `None` when it has errors.
fn compare_program(job: &Job, mut bench: Bench) -> Result<Option<Bench>, Failure> {
    let mut findings = to_stderr(Format::Text);
    let mut source = job.open()?;
    crate::program::walk(
        &mut source,
        job.name(),
        job.dialect,
        &mut findings,
        |_, command, from, _| {
            let made = match command {
                husillo_gcode::Command::Linear { to, .. } => grid::line(&job.config, from, *to),
                husillo_gcode::Command::Arc { arc, .. } => grid::arc(&job.config, from, arc),
                _ => Ok(None),
            };
            match made {
                Ok(Some(one)) => bench.add_common(&one),
                Ok(None) => {}
                Err(why) => bench.note(why.to_owned()),
            }
            Ok(())
        },
    )?;
    if findings.errors > 0 {
        eprintln!(
            "{}: {}",
            job.name(),
            verdict(findings.errors, findings.warnings)
        );
        return Ok(None);
    }
    Ok(Some(bench))
}

/// A program and the machine it is for.
struct Job {
    file: String,
    machine: MachineFile,
    dialect: Dialect,
    config: Config<3>,
    /// Standard input is read once and kept, as a run reads its program twice.
    input: Option<Vec<u8>>,
}

impl Job {
    fn new(file: &str, target: &Target, default_machine: &str) -> Result<Self, Failure> {
        let name = target.machine.as_deref().unwrap_or(default_machine);
        let machine = load(name)?;
        let dialect = setup::dialect(target.dialect.as_deref(), file, Some(&machine))?;
        let config = setup::config(&machine, dialect)?;
        Ok(Self {
            file: file.to_owned(),
            machine,
            dialect,
            config,
            input: None,
        })
    }

    /// Keeps standard input in memory, so that it can be read twice.
    fn keep_input(&mut self) -> io::Result<()> {
        if self.file == "-" {
            let mut input = Vec::new();
            io::stdin().read_to_end(&mut input)?;
            self.input = Some(input);
        }
        Ok(())
    }

    fn open(&self) -> Result<Source, Failure> {
        match &self.input {
            Some(input) => Ok(Source::from_reader(Box::new(io::Cursor::new(
                input.clone(),
            )))),
            None => Source::open(&self.file)
                .map_err(|error| Failure::Usage(format!("{}: {error}", self.file))),
        }
    }

    /// How the file is called in messages.
    fn name(&self) -> &str {
        displayed(&self.file)
    }

    fn check<W: Write>(&self, findings: &mut Findings<W>) -> Result<Facts, Failure> {
        let mut source = self.open()?;
        Ok(check::check(
            &mut source,
            self.name(),
            self.dialect,
            &self.machine,
            &self.config,
            findings,
        )?)
    }

    fn new_machine(&self, compensation: bool) -> Machine<3> {
        let mut machine = Machine::new(self.config);
        machine.set_compensation(compensation);
        machine
    }
}

/// How a file is called in messages.
fn displayed(file: &str) -> &str {
    if file == "-" { "<input>" } else { file }
}

/// A whole file, or standard input.
fn whole(file: &str) -> Result<Vec<u8>, Failure> {
    let mut text = Vec::new();
    let read = match file {
        "-" => io::stdin().read_to_end(&mut text),
        _ => File::open(file).and_then(|mut file| file.read_to_end(&mut text)),
    };
    read.map_err(|error| Failure::Usage(format!("{file}: {error}")))?;
    Ok(text)
}

fn load(machine: &str) -> Result<MachineFile, Failure> {
    match MachineFile::load(machine) {
        Ok(machine) => Ok(machine),
        Err(error) => Err(not_loaded(machine, error)?),
    }
}

/// Prints the mistakes of a machine file.
fn not_loaded(machine: &str, error: LoadError) -> io::Result<Failure> {
    Ok(Failure::Usage(match error {
        LoadError::File(message) => message,
        LoadError::Findings(found) => {
            let mut findings = to_stderr(Format::Text);
            for finding in &found {
                findings.add(finding)?;
            }
            format!("{machine}: {} errors", found.len())
        }
    }))
}

fn list_holes(args: &Holes) -> Result<u8, Failure> {
    let options = holes::Options::new(args)?;
    let work = match args.make {
        DrillOutput::Gcode => Some(Work::new(args)?),
        DrillOutput::List | DrillOutput::Drill => None,
    };
    let is_drill = args.make == DrillOutput::Drill;
    let to_file = args.output.as_ref().is_some_and(|path| path != "-");
    if is_drill && args.format == Output::Text && !to_file && io::stdout().is_terminal() {
        let message = "records are bytes, nothing for a screen: see -o and --format json";
        return Err(Failure::Usage(message.into()));
    }
    let name = displayed(&args.file);
    let text = whole(&args.file)?;
    let mut findings = to_stderr(Format::Text);
    let mut board = holes::read(&text, name, &options, &mut findings)?;
    let (errors, warnings) = (findings.errors, findings.warnings);
    if errors > 0 && args.make != DrillOutput::List {
        eprintln!("{name}: {}; nothing written", verdict(errors, warnings));
        return Ok(ERRORS);
    }
    board.apply(&options)?;
    if args.order == DrillOrder::Shortest {
        board.sort_shortest();
    }
    // All of it is made before the file is touched.
    let mut made = Vec::new();
    match (work, args.format) {
        (Some(work), _) => work.write(&board, name, &mut made)??,
        (None, format) if is_drill => {
            let compiler = Compiler::new(args);
            let tools = match compiler.compile(&board, name) {
                Ok(tools) => tools,
                Err(Refusal::Usage(message)) => return Err(Failure::Usage(message)),
                Err(Refusal::Finding(finding)) => {
                    findings.add(&finding)?;
                    return Ok(ERRORS);
                }
            };
            match format {
                Output::Text => made = compiler.bytes(&tools, name)?,
                Output::Json => compiler.print_json(&tools, &mut made)?,
            }
        }
        (None, Output::Text) => board.print(name, &mut made)?,
        (None, Output::Json) => board.print_json(errors, warnings, &mut made)?,
    }
    match &args.output {
        Some(path) if path != "-" => create(path)?.write_all(&made)?,
        _ => {
            let mut out = io::stdout().lock();
            out.write_all(&made)?;
            out.flush()?;
        }
    }
    if errors > 0 {
        eprintln!("{name}: {}", verdict(errors, warnings));
        return Ok(ERRORS);
    }
    Ok(OK)
}

fn to_stderr(format: Format) -> Findings<io::Stderr> {
    Findings::new(io::stderr(), format, colour(io::stderr().is_terminal()), 50)
}

fn colour(is_terminal: bool) -> bool {
    is_terminal && std::env::var_os("NO_COLOR").is_none()
}

fn check_files(args: &Check) -> Result<u8, Failure> {
    let mut code = OK;
    let stdout = io::stdout();
    let coloured = colour(stdout.is_terminal());
    for file in &args.files {
        let out = BufWriter::new(stdout.lock());
        let mut findings = Findings::new(out, args.format, coloured, args.limit);
        let name = displayed(file);
        if holes::is_drill_file(args.target.dialect.as_deref(), file) {
            let text = whole(file)?;
            let board = holes::read(&text, name, &holes::Options::default(), &mut findings)?;
            if let Some(machine) = &args.target.machine {
                board.check_travel(name, &load(machine)?, &mut findings)?;
            }
        } else {
            Job::new(file, &args.target, "free")?.check(&mut findings)?;
        }
        let hidden = findings.hidden();
        let (errors, warnings) = (findings.errors, findings.warnings);
        let out = findings.writer();
        if args.format == Format::Text {
            if hidden > 0 {
                writeln!(out, "{hidden} more findings: see --limit\n")?;
            }
            writeln!(out, "{name}: {}", verdict(errors, warnings))?;
        }
        out.flush()?;
        if errors > 0 || (args.deny_warnings && warnings > 0) {
            code = ERRORS;
        }
    }
    Ok(code)
}

fn verdict(errors: u64, warnings: u64) -> String {
    let count = |number: u64, name: &str| match number {
        0 => format!("no {name}s"),
        1 => format!("1 {name}"),
        _ => format!("{number} {name}s"),
    };
    format!("{}, {}", count(errors, "error"), count(warnings, "warning"))
}

fn format_files(args: &FormatArgs) -> Result<u8, Failure> {
    if args.files.len() > 1 && !args.check {
        let message = "several programs are for --check only".to_owned();
        return Err(Failure::Usage(message));
    }
    let mut code = OK;
    for file in &args.files {
        if format_file(args, file)? {
            code = ERRORS;
        }
    }
    Ok(code)
}

/// Whether a program has errors or, where it is only looked at, another form.
fn format_file(args: &FormatArgs, file: &str) -> Result<bool, Failure> {
    let form = format::Form {
        dialect: setup::dialect(args.dialect.as_deref(), file, None)?,
        line_end: if args.crlf { b"\r\n" } else { b"\n" },
    };
    let name = displayed(file);
    let usage = |error| Failure::Usage(format!("{name}: {error}"));
    let mut reader = source::open(file).map_err(usage)?;
    let mut findings = to_stderr(Format::Text);
    let mut write =
        |out: &mut dyn Write| format::write(&mut *reader, name, &form, &mut findings, out);
    let changed = match args.output.as_deref() {
        _ if args.check => write(&mut io::sink())?,
        Some(path) if path != "-" => replace(path, write)?,
        _ => {
            let mut out = BufWriter::with_capacity(1 << 18, io::stdout().lock());
            let changed = write(&mut out)?;
            out.flush()?;
            changed
        }
    };
    if findings.errors > 0 {
        let lines = verdict(findings.errors, 0);
        eprintln!("{name}: {lines}; such lines stay as they are");
    }
    if args.check && changed {
        writeln!(io::stdout(), "{name}: would change")?;
    }
    Ok(findings.errors > 0 || (args.check && changed))
}

/// Writes a file beside its old self and then puts it in its place, so that it can be its own source and is whole at any time.
/// What is no plain file is written as it is.
fn replace<T>(
    path: &str,
    write: impl FnOnce(&mut dyn Write) -> io::Result<T>,
) -> Result<T, Failure> {
    let usage = |error| Failure::Usage(format!("{path}: {error}"));
    let old = std::fs::metadata(path).ok();
    if old.as_ref().is_some_and(|old| !old.is_file()) {
        let mut out = BufWriter::with_capacity(1 << 18, create(path)?);
        let made = write(&mut out)?;
        out.flush()?;
        return Ok(made);
    }
    // Behind a link, the file itself.
    let place = std::fs::canonicalize(path).unwrap_or_else(|_| path.into());
    let mut beside = place.clone().into_os_string();
    beside.push(format!(".{}.new", std::process::id()));
    let made = (|| {
        let mut out = BufWriter::with_capacity(1 << 18, create(&beside.to_string_lossy())?);
        let made = write(&mut out)?;
        out.flush()?;
        if let Some(old) = old {
            std::fs::set_permissions(&beside, old.permissions()).map_err(usage)?;
        }
        std::fs::rename(&beside, &place).map_err(usage)?;
        Ok(made)
    })();
    if made.is_err() {
        let _ = std::fs::remove_file(&beside);
    }
    made
}

fn print_commands(args: &Commands) -> Result<u8, Failure> {
    let job = Job::new(&args.file, &args.target, "free")?;
    let mut source = job.open()?;
    let mut findings = to_stderr(Format::Text);
    let mut out = BufWriter::with_capacity(1 << 18, io::stdout().lock());
    let json = args.format == Output::Json;
    commands::print(
        &mut source,
        job.name(),
        job.dialect,
        json,
        &mut findings,
        &mut out,
    )?;
    out.flush()?;
    if findings.hidden() > 0 {
        eprintln!(
            "{} more errors: see husillo check --limit",
            findings.hidden()
        );
    }
    Ok(if findings.errors > 0 { ERRORS } else { OK })
}

fn write_steps(args: &Steps) -> Result<u8, Failure> {
    let mut job = Job::new(&args.file, &args.target, "micromill")?;
    job.keep_input()?;
    let mut findings = to_stderr(Format::Text);
    job.check(&mut findings)?;
    if findings.errors > 0 {
        eprintln!(
            "{}: {}; nothing moves",
            job.name(),
            verdict(findings.errors, findings.warnings)
        );
        return Ok(ERRORS);
    }
    let mut source = job.open()?;
    let mut machine = job.new_machine(!args.no_compensation);
    if args.output == "-" {
        let mut out = BufWriter::with_capacity(1 << 18, io::stdout().lock());
        steps::write(&mut source, &mut machine, &mut out)?;
        out.flush()?;
    } else {
        let mut out = BufWriter::with_capacity(1 << 18, create(&args.output)?);
        let count = steps::write(&mut source, &mut machine, &mut out)?;
        out.flush()?;
        eprintln!("{}: {count} step events", args.output);
    }
    Ok(OK)
}

fn create(path: &str) -> Result<File, Failure> {
    if let Some(folder) = Path::new(path)
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::Usage(format!("{}: {error}", folder.display())))?;
    }
    File::create(path).map_err(|error| Failure::Usage(format!("{path}: {error}")))
}

/// What `run --format json` prints.
#[derive(Debug, Default, Serialize)]
struct Results {
    events: u64,
    duration_s: f64,
    end_nm: [i64; 3],
    min_nm: [i64; 3],
    max_nm: [i64; 3],
    max_deviation_nm: f64,
    rms_deviation_nm: f64,
    reversals: [u64; 3],
    lost_steps: u64,
    feed_nm: i64,
    rapid_nm: i64,
    errors: u64,
    warnings: u64,
}

fn simulate(args: &RunArgs) -> Result<u8, Failure> {
    let mut job = Job::new(&args.file, &args.target, "micromill")?;
    job.keep_input()?;
    let text = args.format == Output::Text;
    let mut drawn = to_stderr(Format::Text);
    // The warnings are drawn now and listed in the report.
    let mut listed = Findings::new(Vec::new(), Format::Short, false, 50);
    let facts = job.check(&mut drawn)?;
    let (errors, warnings) = (drawn.errors, drawn.warnings);
    if errors > 0 {
        eprintln!(
            "{}: {}; nothing moves",
            job.name(),
            verdict(errors, warnings)
        );
        if !text {
            print_json(&Results {
                errors,
                warnings,
                ..Results::default()
            })?;
        }
        return Ok(ERRORS);
    }
    if warnings > 0 {
        job.check(&mut listed)?;
    }
    if text {
        writeln!(
            io::stdout(),
            "Checked    {} for {}: {}",
            job.name(),
            job.machine.name,
            verdict(errors, warnings)
        )?;
    }
    let trace = match &args.trace {
        Some(path) => {
            Some(Box::new(BufWriter::with_capacity(1 << 18, create(path)?)) as Box<dyn Write>)
        }
        None => None,
    };
    let mut run = Run::new(&job.machine, trace)?;
    let mut source = job.open()?;
    let mut machine = job.new_machine(!args.no_compensation);
    let bar = progress(facts.events);
    let mut countdown = PROGRESS_EVENTS;
    feeder::feed(&mut source, &mut machine, |machine, event| {
        countdown -= 1;
        if countdown == 0 {
            countdown = PROGRESS_EVENTS;
            bar.inc(PROGRESS_EVENTS);
        }
        run.event(machine, event)
    })?;
    bar.finish_and_clear();
    run.finish()?;

    let offset = machine.modal().work_offset().map(|nm| nm.0);
    let results = results(&job, &run, &facts, offset, [errors, warnings]);
    let output = match (&args.output, text) {
        (Some(path), _) => Some(path.clone()),
        (None, true) => Some(default_report(&job.file)),
        (None, false) => None,
    };
    if text {
        summary(&job, &run, &results, &facts)?;
    } else {
        print_json(&results)?;
    }
    if let Some(path) = output {
        let warnings = String::from_utf8_lossy(listed.writer())
            .lines()
            .map(str::to_owned)
            .collect();
        let figures = figures(
            &results,
            &facts,
            run.take_up_ticks as f64 / f64::from(job.machine.timer_hz),
            args.no_compensation,
        );
        let page = report::html(&make_report(
            &job, &mut run, &results, figures, offset, warnings,
        ));
        let size = page.len();
        create(&path)?.write_all(page.as_bytes())?;
        if text {
            writeln!(
                io::stdout(),
                "Wrote      {path} ({} kB) - open it in any browser",
                size.div_ceil(1000)
            )?;
        }
    }
    Ok(OK)
}

/// Events between two updates of the progress bar.
const PROGRESS_EVENTS: u64 = 1 << 20;

fn progress(events: f64) -> ProgressBar {
    if events < 4.0 * PROGRESS_EVENTS as f64 || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(events as u64);
    if let Ok(style) =
        ProgressStyle::with_template("Simulating [{bar:36}] {percent} % {human_pos} steps")
    {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

fn default_report(file: &str) -> String {
    let stem = Path::new(file)
        .file_stem()
        .map_or("report".into(), |stem| stem.to_string_lossy());
    let stem = if stem == "-" { "report".into() } else { stem };
    format!("out/{stem}.html")
}

fn print_json(results: &Results) -> io::Result<()> {
    let json = serde_json::to_string(results).map_err(io::Error::other)?;
    writeln!(io::stdout(), "{json}")
}

fn results(
    job: &Job,
    run: &Run<'_>,
    facts: &Facts,
    offset: [i64; 3],
    [errors, warnings]: [u64; 2],
) -> Results {
    let nm = |steps: [i32; 3]| {
        [0, 1, 2].map(|axis| {
            let step = job.machine.axes[axis].step;
            let exact = i128::from(steps[axis]) * i128::from(step.num);
            let nearest = (2 * exact + i128::from(step.den)).div_euclid(2 * i128::from(step.den));
            i64::try_from(nearest).unwrap_or(i64::MAX) - offset[axis]
        })
    };
    Results {
        events: run.events,
        duration_s: run.ticks as f64 / f64::from(job.machine.timer_hz),
        end_nm: nm(run.tool_steps()),
        min_nm: nm(run.low),
        max_nm: nm(run.high),
        max_deviation_nm: rounded(run.deviation.largest_nm()),
        rms_deviation_nm: rounded(run.deviation.rms_nm()),
        reversals: run.reversals,
        lost_steps: run.lost_steps().iter().sum(),
        feed_nm: facts.feed_nm.round() as i64,
        rapid_nm: facts.rapid_nm.round() as i64,
        errors,
        warnings,
    }
}

/// Thousandths of a nanometre are more than enough.
fn rounded(nm: f64) -> f64 {
    (nm * 1e3).round() / 1e3
}

fn summary(job: &Job, run: &Run<'_>, results: &Results, facts: &Facts) -> io::Result<()> {
    let mut out = io::stdout().lock();
    writeln!(
        out,
        "Simulated  {} step events, {}",
        results.events,
        duration(results.duration_s)
    )?;
    writeln!(
        out,
        "           path {} feed, {} rapid",
        length(facts.feed_nm),
        length(facts.rapid_nm)
    )?;
    writeln!(
        out,
        "           deviation {} at most, {} RMS",
        length(results.max_deviation_nm),
        length(results.rms_deviation_nm)
    )?;
    let lost = run.lost_steps();
    for (axis, facts) in job.machine.axes.iter().enumerate() {
        let [low, high, end] = [results.min_nm, results.max_nm, results.end_nm]
            .map(|nm| report::millimetres(nm[axis] as f64));
        write!(
            out,
            "           {} {low} to {high} mm, ends at {end}, {} take-ups",
            char::from(facts.letter),
            results.reversals[axis]
        )?;
        match lost[axis] {
            0 => writeln!(out)?,
            lost => writeln!(out, ", {lost} STEPS LOST")?,
        }
    }
    Ok(())
}

fn figures(
    results: &Results,
    facts: &Facts,
    take_up_s: f64,
    uncompensated: bool,
) -> Vec<(&'static str, String)> {
    vec![
        ("time", duration(results.duration_s)),
        ("step events", results.events.to_string()),
        ("feed path", length(facts.feed_nm)),
        ("rapid path", length(facts.rapid_nm)),
        ("largest deviation", length(results.max_deviation_nm)),
        ("RMS deviation", length(results.rms_deviation_nm)),
        (
            "reversals",
            results.reversals.iter().sum::<u64>().to_string(),
        ),
        (
            "backlash",
            if uncompensated {
                "not compensated".to_owned()
            } else {
                format!("taken up in {}", duration(take_up_s))
            },
        ),
        ("lost steps", results.lost_steps.to_string()),
    ]
}

fn make_report(
    job: &Job,
    run: &mut Run<'_>,
    results: &Results,
    figures: Vec<(&'static str, String)>,
    offset: [i64; 3],
    warnings: Vec<String>,
) -> Report {
    let travel = |axis: usize| match job.machine.axes[axis].travel {
        Travel::Range(range) => Some(range.map(|at| (at - offset[axis]) as f64)),
        Travel::Unknown | Travel::Unlimited => None,
    };
    let lost = run.lost_steps();
    let axes = (0..3)
        .map(|axis| AxisRow {
            letter: char::from(job.machine.axes[axis].letter),
            extent_nm: [results.min_nm[axis] as f64, results.max_nm[axis] as f64],
            travel_nm: travel(axis),
            end_nm: results.end_nm[axis] as f64,
            reversals: results.reversals[axis],
            lost_steps: lost[axis],
        })
        .collect();
    let machine_frame = |axis: usize| match job.machine.axes[axis].travel {
        Travel::Range(range) => Some(range.map(|at| at as f64)),
        Travel::Unknown | Travel::Unlimited => None,
    };
    let area = machine_frame(0)
        .zip(machine_frame(1))
        .map(|([x0, x1], [y0, y1])| [[x0, y0], [x1, y1]]);
    Report {
        program: job.name().to_owned(),
        machine: job.machine.title.clone(),
        figures,
        axes,
        phases: run.motors(),
        drawing: std::mem::replace(&mut run.drawing, crate::drawing::Drawing::new()),
        ideal: std::mem::take(&mut run.ideal),
        ideal_is_whole: run.ideal_is_whole,
        area,
        largest_nm: results.max_deviation_nm,
        speed: run.speed.clone(),
        has_ramps: job
            .machine
            .axes
            .iter()
            .any(|axis| axis.acceleration.is_some()),
        warnings,
    }
}
