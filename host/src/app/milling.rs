//! `compile` and `send` for the micro mill.

use super::job::Job;
use super::reporting::{verdict, with_findings};
use super::{ERRORS, Failure, OK, write};
use crate::cli::{Compile, Send, Target};
use crate::console;
use crate::console::sharing::share;
use crate::console::stop::{INTERRUPTED, stop_requests, stops_asked};
use crate::console::typed::typed_line;
use crate::diagnostics::Findings;
use crate::micromill;
use crate::programs::feeder;
use crate::programs::program;
use crate::programs::setup;
use crate::programs::source::Source;
use husillo_clients::micromill::{self as client, Translated};
use husillo_gcode::Dialect;
use husillo_machine::{Config, Event};
use husillo_transports::micromill::Line;
use std::io::{self, Write};

/// Whether the machine is the micro mill.
pub(super) fn is_for(target: &Target, file: &str) -> bool {
    match target.machine.as_deref() {
        Some(name) => name == "micromill",
        None => file.to_ascii_lowercase().ends_with(".mm"),
    }
}

pub(super) fn compile(args: &Compile) -> Result<u8, Failure> {
    let mut job = Job::new(&args.file, &args.target, "micromill")?;
    let Some(made) = translated(&mut job)? else {
        return Ok(ERRORS);
    };
    expect_a_command(&made, &job)?;
    let text = micromill::text(&made.lines);
    let path = args.output.as_deref().unwrap_or("-");
    write(path, text.as_bytes())?;
    if path != "-" {
        eprintln!("{path}: {} strings", made.lines.len());
    }
    Ok(OK)
}

/// An empty file of strings would not show that the program does nothing.
fn expect_a_command(made: &Translated, job: &Job) -> Result<(), String> {
    match made.lines.is_empty() {
        true => Err(format!("{}: no command for the mill", job.name())),
        false => Ok(()),
    }
}

pub(super) fn send(args: &Send) -> Result<u8, Failure> {
    let (file, port) = args.alone()?;
    let mut job = Job::new(file, &args.target, "micromill")?;
    let Some(made) = translated(&mut job)? else {
        return Ok(ERRORS);
    };
    expect_a_command(&made, &job)?;
    let baud = args.baud.unwrap_or(client::BAUD);
    let stop = stop_requests()?;
    let wire = client::open(port, baud)?;
    share(
        args.target.machine.as_deref().unwrap_or("micromill"),
        port,
        baud,
    );
    let sending = client::Sending {
        bits_per_s: baud,
        lease_ms: args.lease.unwrap_or(client::LEASE_MS),
        streams: args.stream,
        every: args.every,
        homes: !args.no_home,
    };
    let count = made.lines.len();
    let progress = |done: usize| {
        if done == count || done.is_multiple_of(100) {
            // A closed terminal does not stop a machine in the middle of a line.
            let _ = writeln!(io::stderr(), "{done} of {count} lines");
        }
    };
    let operator = |line: &Line, string: &str| match line {
        Line::Tool(tool) if !args.yes => asks(&format!("Tool {tool}: put it in, then Enter")),
        _ if args.single_block => asks(&format!("{string} Enter sends it")),
        _ => true,
    };
    let sent = match client::send(wire, &sending, &made.lines, stop, progress, operator) {
        Ok(sent) => sent,
        Err(message) => {
            let _ = writeln!(io::stderr(), "{}: {message}", job.name());
            return Ok(failed());
        }
    };
    let expected = steps(&job, micromill::text(&made.lines))?;
    let mut out = console::stdout();
    writeln!(out, "Lines      {} made", sent.lines)?;
    let reported = sent.steps.len() as u64 * u64::from(args.every.max(1));
    if args.every != 1 {
        writeln!(
            out,
            "Steps      about {reported} reported of {}",
            expected.len()
        )?;
        return Ok(OK);
    }
    let differs = (sent.steps.iter().zip(&expected)).position(|(ours, theirs)| ours != theirs);
    if let Some(place) = differs {
        writeln!(out, "Steps      step {} is not the simulator's", place + 1)?;
        return Ok(ERRORS);
    }
    if sent.steps.len() != expected.len() {
        writeln!(
            out,
            "Steps      {} reported, {} in the simulator",
            sent.steps.len(),
            expected.len()
        )?;
        return Ok(ERRORS);
    }
    writeln!(
        out,
        "Steps      {}, each as in the simulator",
        expected.len()
    )?;
    Ok(OK)
}

/// The program as lines of the mill. Everything that is dropped or changed is reported. `None` if
/// it has errors.
fn translated(job: &mut Job) -> Result<Option<Translated>, Failure> {
    job.keep_input()?;
    let (_, findings) = with_findings(|findings| job.check(findings))?;
    if findings.errors > 0 {
        let verdict = verdict(findings.errors, findings.warnings);
        eprintln!("{}: {verdict}; nothing is made", job.name());
        return Ok(None);
    }
    let mut commands = Vec::new();
    let mut source = job.open()?;
    program::walk(
        &mut source,
        job.name(),
        job.start,
        // The check has reported the errors of the program.
        &mut Findings::new(0),
        |meaning, command, _, _| {
            commands.push((meaning.at.line, *command));
            Ok(())
        },
    )?;
    let made = client::translate(commands, &job.config);
    for (line, note) in &made.notes {
        eprintln!("{}:{line}: {note}", job.name());
    }
    for (line, error) in &made.errors {
        eprintln!("{}:{line}: error: {error}", job.name());
    }
    Ok(made.errors.is_empty().then_some(made))
}

/// The steps of the mill's strings on a simulated machine, in the order in which a controller
/// reports them: axis, and whether forward.
fn steps(job: &Job, text: String) -> Result<Vec<(u8, bool)>, Failure> {
    let config = Config {
        dialect: Dialect::MICROMILL,
        ..job.config
    };
    // The controller has one backlash value per axis.
    let mut machine = setup::with_maps(config, setup::maps(&job.machine)?);
    let mut source = Source::from_reader(Box::new(io::Cursor::new(text.into_bytes())));
    let mut steps = Vec::new();
    feeder::feed(&mut source, &mut machine, |_, event| {
        if let Event::Step(step) = event {
            for (axis, delta) in (0..3).zip(step.delta) {
                if delta != 0 {
                    steps.push((axis, delta > 0));
                }
            }
        }
        Ok(())
    })?;
    Ok(steps)
}

/// Exit status if the machine did not complete its work.
pub(super) fn failed() -> u8 {
    if stops_asked() > 0 {
        INTERRUPTED
    } else {
        ERRORS
    }
}

/// Whether the operator continues.
fn asks(what: &str) -> bool {
    let before = stops_asked();
    eprintln!("{what} (or q to end)");
    typed_line(before).is_some_and(|answer| !answer.trim().eq_ignore_ascii_case("q"))
}
