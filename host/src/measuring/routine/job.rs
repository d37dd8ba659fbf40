//! `husillo measure run` and `husillo measure record`: reads and writes their files.

use super::findings;
use super::measured::now;
use crate::cli::{Measure, Results};
use crate::output::Outputs;
use husillo_metrology::heads::Prober;
use husillo_metrology::heads::{Machine, Stylus};
use husillo_metrology::routine::{Feature, Parser, Runner, Site, Statement, program, record};
use husillo_reports::routine;
use husillo_simulator::diagnostics::{Finding, Format};
use husillo_simulator::text::json::write_line;
use std::io::{self, BufRead, BufReader, IsTerminal, Write};

/// How a routine without mistakes ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It is complete, and everything is within tolerance.
    Good,
    /// It is complete, and something is out of tolerance.
    OutOfTolerance,
    /// It stopped before its end.
    Failed,
    /// There was a collision. No result is valid.
    Collision,
}

/// A routine or a program, ready to run.
#[derive(Debug)]
pub enum Routine {
    /// Statements.
    Statements {
        name: String,
        text: String,
        statements: Vec<Statement>,
    },
    /// A G-code program.
    Program { name: String, text: Vec<u8> },
}

impl Routine {
    /// Reads and checks a file. The ending of its name marks G-code. If the file has mistakes,
    /// prints them and returns `None`.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn load(name: &str) -> Result<Option<Self>, String> {
        let text = crate::input::read(name).map_err(|error| format!("{name}: {error}"))?;
        match Self::parse(name, text) {
            Ok(routine) => Ok(Some(routine)),
            Err(findings) => {
                findings.iter().for_each(tell);
                Ok(None)
            }
        }
    }

    /// Checks a text. The ending of its name marks G-code.
    ///
    /// # Errors
    ///
    /// Its mistakes.
    pub fn parse(name: &str, text: Vec<u8>) -> Result<Self, Vec<Finding>> {
        let is_program = [".nc", ".ngc", ".gcode", ".tap", ".cnc"];
        let lower = name.to_ascii_lowercase();
        let name = name.to_owned();
        if is_program.iter().any(|end| lower.ends_with(end)) {
            return match program::check(&text) {
                Ok(()) => Ok(Self::Program { name, text }),
                Err(errors) => Err(errors
                    .iter()
                    .map(|error| findings::of_program(error, &name))
                    .collect()),
            };
        }
        let text = String::from_utf8_lossy(&text).into_owned();
        match Parser::file(&text) {
            Ok(statements) => Ok(Self::Statements {
                name,
                text,
                statements,
            }),
            Err(mistakes) => Err(mistakes
                .into_iter()
                .map(|mistake| findings::of_mistake(mistake, &name, &text))
                .collect()),
        }
    }

    /// Its statements. A program has none.
    pub fn statements(&self) -> &[Statement] {
        match self {
            Self::Statements { statements, .. } => statements,
            Self::Program { .. } => &[],
        }
    }

    /// The name of its file.
    pub fn name(&self) -> &str {
        let (Self::Statements { name, .. } | Self::Program { name, .. }) = self;
        name
    }

    /// Carries the routine out. `begin` receives each line before it is carried out, `each`
    /// receives each feature when it is measured, and `pause` waits at the M0 of a program.
    ///
    /// # Errors
    ///
    /// The finding of the line that has failed.
    pub fn carry_out(
        &self,
        runner: &mut Runner<'_>,
        mut begin: impl FnMut(usize),
        mut each: impl FnMut(&Feature),
        pause: impl FnMut(usize),
    ) -> Result<(), Box<Finding>> {
        match self {
            Self::Program { name, text } => program::run(text, runner, begin, each, pause)
                .map_err(|error| Box::new(findings::of_program(&error, name))),
            Self::Statements {
                name,
                text,
                statements,
            } => {
                let lines: Vec<&str> = text.lines().collect();
                for statement in statements {
                    begin(statement.line);
                    let done = runner.run(statement).map_err(|failure| {
                        let line = lines.get(statement.line - 1).copied().unwrap_or_default();
                        let line_number = statement.line;
                        Box::new(findings::of_failure(&failure, name, line_number, line))
                    })?;
                    done.into_iter().for_each(&mut each);
                }
                Ok(())
            }
        }
    }
}

/// Runs a routine, prints the features to `out`, and writes the report of `-o` to `file`.
///
/// # Errors
///
/// `out` cannot be written.
pub fn run(
    routine: &Routine,
    args: &Measure,
    machine: &Machine,
    prober: &mut dyn Prober,
    stylus: Stylus,
    out: &mut dyn Write,
    file: &mut Vec<u8>,
) -> io::Result<Ending> {
    let mut runner = Runner::new(Site::new(prober, stylus));
    let mut written = Ok(());
    let each = |feature: &Feature| {
        if args.format == Results::Text && written.is_ok() {
            written = writeln!(out, "{}", routine::text(feature)).and_then(|()| out.flush());
        }
    };
    let done = routine.carry_out(&mut runner, |_| (), each, pause);
    written?;
    let has_collided = runner.site.has_collided();
    if has_collided {
        runner.features.iter_mut().for_each(Feature::spoil);
    }
    let features = &runner.features;
    let heading = routine::Heading {
        routine: routine.name(),
        part: args.part.as_deref(),
        machine: &machine.title,
        measured: now(),
    };
    let error = done.as_ref().err().map(|finding| finding.message.clone());
    let json = || {
        let error = error.as_deref();
        routine::json(&heading, features, error, has_collided)
    };
    match args.format {
        Results::Text => writeln!(out, "{}", routine::summary(features))?,
        Results::Json => write_line("husillo.measure.run/1", &json(), &mut &mut *out)?,
        Results::Csv => write!(out, "{}", routine::csv(features))?,
    }
    if let Some(path) = &args.output {
        let lower = path.to_ascii_lowercase();
        let text = if lower.ends_with(".html") || lower.ends_with(".htm") {
            routine::html(&heading, features, &runner.site, error.as_deref())
        } else if lower.ends_with(".json") {
            let mut line = Vec::new();
            write_line("husillo.measure.run/1", &json(), &mut line)?;
            String::from_utf8_lossy(&line).into_owned()
        } else {
            routine::csv(features)
        };
        file.extend(text.into_bytes());
    }
    out.flush()?;
    if let Err(finding) = &done {
        tell(finding);
    }
    Ok(match done {
        _ if has_collided => Ending::Collision,
        Err(_) => Ending::Failed,
        Ok(()) if features.iter().all(Feature::is_good) => Ending::Good,
        Ok(()) => Ending::OutOfTolerance,
    })
}

/// Carries out the lines from standard input and writes the routine that repeats them.
///
/// # Errors
///
/// Reading or writing fails.
pub fn recorded(
    path: &str,
    prober: &mut dyn Prober,
    stylus: Stylus,
    out: &mut dyn Write,
) -> io::Result<Ending> {
    let mut runner = Runner::new(Site::new(prober, stylus));
    // The file has the lines so far, however the session ends.
    let mut outputs = Outputs::record();
    let mut routine = outputs.create(path)?;
    let mut input = BufReader::new(crate::input::bounded(io::stdin()));
    let each = |feature: &Feature| {
        writeln!(out, "{}", routine::text(feature))?;
        out.flush()
    };
    let refuse = |refused: &_| tell(&findings::of_refused(refused));
    let refused = record(&mut input, &mut routine, &mut runner, each, refuse);
    drop(routine);
    outputs.finish()?;
    let refused = refused?;
    let has_collided = runner.site.has_collided();
    if has_collided {
        runner.features.iter_mut().for_each(Feature::spoil);
    }
    writeln!(out, "{path}: {}", routine::summary(&runner.features))?;
    Ok(match refused {
        _ if has_collided => Ending::Collision,
        0 => Ending::Good,
        _ => Ending::Failed,
    })
}

/// M0: waits for Enter if standard input is a terminal.
fn pause(line: usize) {
    let input = io::stdin();
    if input.is_terminal() {
        eprintln!("line {line}: M0; press Enter to go on");
        // The end of the input continues, too.
        let _ = input.lock().read_line(&mut String::new());
    } else {
        eprintln!("line {line}: M0");
    }
}

fn tell(finding: &Finding) {
    let is_colour = crate::console::is_coloured(&io::stderr());
    // If standard error is closed, no message can be shown.
    let _ = finding.print(Format::Text, is_colour, &mut io::stderr());
}
