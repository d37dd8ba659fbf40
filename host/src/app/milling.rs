//! `compile` and `send` for the micro mill.

mod by_line;
mod comparison;

use super::job::Job;
use super::reporting::{MOST_PRINTED, verdict, with_some_findings};
use super::{ERRORS, Failure, OK, made_at, write};
use crate::cli::{Compile, Send, Target};
use crate::console;
use crate::console::reporter::{Reporter, report};
use crate::console::sharing::share;
use crate::console::stop::{INTERRUPTED, stop_requests, stops_asked};
use crate::console::typed::typed_line;
use crate::input;
use crate::micromill;
use comparison::compared;
use husillo_clients::micromill::{self as client, Sender, Translated};
use husillo_controllers::MicromillConfig;
use husillo_machine::Config;
use husillo_sim::text::{counted, grouped};
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_simulator::programs::setup;
use husillo_transports::micromill::{Line, State};
use serde_json::json;

/// Whether a machine is the micro mill, or the file of one, whose motors may make other steps. Such
/// a file has the same `name`.
pub(super) fn is_mill(machine: &str) -> bool {
    let is_named = || {
        MachineFile::load(machine, input::read_to_string).is_ok_and(|file| file.name == "micromill")
    };
    machine == "micromill" || (!MachineFile::is_built_in(machine) && is_named())
}

/// The simulated mill makes full steps.
pub(super) fn expect_a_port(port: &str, config: &Config<3>) -> Result<(), String> {
    let full = MicromillConfig::MICROMILL.machine.axes;
    let steps = config.axes.iter().zip(&full);
    match port == "sim"
        && steps
            .into_iter()
            .any(|(ours, full)| ours.scale != full.scale)
    {
        true => Err("the simulated mill at --port sim has steps of 140 nm, not those of -m".into()),
        false => Ok(()),
    }
}

/// Whether the machine is the micro mill.
pub(super) fn is_for(target: &Target, file: &str) -> bool {
    match target.machine.as_deref() {
        Some(name) => is_mill(name),
        None => file.to_ascii_lowercase().ends_with(".mm"),
    }
}

pub(super) fn compile(args: &Compile) -> Result<u8, Failure> {
    let path = made_at(args)?;
    let mut job = Job::new(&args.file, &args.target, "micromill")?;
    let stdout = &mut console::stdout();
    let mut out = Reporter::new(stdout, args.format, "husillo.compile/1");
    let Some(made) = translated(&mut job, &mut out)? else {
        return Ok(ERRORS);
    };
    // An empty file of strings would not show that the program does nothing.
    if made.lines.is_empty() {
        return Err(format!("{}: no command for the mill", job.name()).into());
    }
    let text = micromill::text(&made.lines);
    write(path, text.as_bytes())?;
    let count = made.lines.len();
    out.object(&json!({"kind": "file", "output": path, "lines": count}));
    if path != "-" && !out.is_json() {
        eprintln!("{path}: {}", counted(count as u64, "string"));
    }
    Ok(OK)
}

/// A program may begin where it ends. One without commands is a mistake.
fn expect_a_command(made: &Translated, job: &Job) -> Result<(), String> {
    match made.commands {
        0 => Err(format!("{}: no command for the mill", job.name())),
        _ => Ok(()),
    }
}

pub(super) fn send(args: &Send, out: &mut Reporter<'_>) -> Result<u8, Failure> {
    let (file, port) = args.alone()?;
    if by_line::is_for(file) {
        return match args.from {
            None => by_line::send(args, out),
            Some(_) => Err("--from needs a file".to_owned().into()),
        };
    }
    if args.from.is_some() && !args.no_home {
        let message = "--from continues at the present position of the mill: add --no-home";
        return Err(message.to_owned().into());
    }
    let mut job = Job::new(file, &args.target, "micromill")?;
    let mut sender = match connected(args, port, &setup::first_three(&job.config))? {
        Ok(sender) => sender,
        Err(message) => return Ok(failed_at(&job, &message, out)),
    };
    stand(&mut job, sender.start());
    let Some(made) = translated(&mut job, out)? else {
        return Ok(ERRORS);
    };
    expect_a_command(&made, &job)?;
    let start = sender.start();
    let made = match rest(args, made, start, &setup::first_three(&job.config)) {
        Ok(made) => made,
        Err(message) => return Ok(failed_at(&job, &message, out)),
    };
    if let Some(message) = unhomed(start, &made) {
        return Ok(failed_at(&job, message, out));
    }
    match all(args, port, &mut sender, &made, out).and_then(|()| sender.finish()) {
        Ok(sent) => compared(&job, args.every, &made, start, &sent, out),
        Err(message) => {
            let status = failed_at(&job, &message, out);
            if let (false, Some((number, _))) = (out.is_json(), made.lines.get(sender.made())) {
                eprintln!("line {number} is not completed; go on with --no-home --from {number}");
            }
            Ok(status)
        }
    }
}

/// The program, or what is left of it from the line of `--from` on.
fn rest(
    args: &Send,
    made: Translated,
    start: Option<State>,
    config: &Config<3>,
) -> Result<Translated, String> {
    let Some(number) = args.from else {
        return Ok(made);
    };
    let start = start.ok_or("--from: the controller does not report where it is")?;
    made.resumed_at(number as usize, &start, config)
}

/// A controller at rest, and its state.
fn connected(
    args: &Send,
    port: &str,
    config: &Config<3>,
) -> Result<Result<Sender, String>, Failure> {
    expect_a_port(port, config)?;
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
    Ok(Sender::new(wire, sending, stop))
}

/// The program begins where the controller says that it is. Without such a report, it begins at
/// machine zero.
fn stand(job: &mut Job, start: Option<State>) {
    let Some(start) = start else { return };
    if !start.is_homed {
        // Its moves are refused, wherever they end.
        for axis in &mut job.config.axes {
            axis.travel = None;
        }
        return;
    }
    let at = client::position(&start, &setup::first_three(&job.config));
    job.stand(setup::padded(client::work_zero(&start)), setup::padded(at));
}

/// Why a mill that is not homed cannot make these lines.
fn unhomed(start: Option<State>, made: &Translated) -> Option<&'static str> {
    let moves = |line: &Line| {
        matches!(
            line,
            Line::Rapid(_) | Line::Linear(..) | Line::Arc { .. } | Line::MachineZero { .. }
        )
    };
    let is_homed = start.is_none_or(|start| start.is_homed);
    (!is_homed && made.lines.iter().any(|(_, line)| moves(line))).then_some(
        "the mill is not homed, so its position is unknown: leave out --no-home, or home it first",
    )
}

/// Homes where that is asked for, and warns if that shows lost steps.
pub(super) fn begin(sender: &mut Sender, port: &str, out: &mut Reporter<'_>) -> Result<(), String> {
    if let Some(lost) = sender.begin()? {
        eprintln!("warning: {lost}");
        out.object(&report(1, port, &lost));
    }
    Ok(())
}

/// Sends all lines.
fn all(
    args: &Send,
    port: &str,
    sender: &mut Sender,
    made: &Translated,
    out: &mut Reporter<'_>,
) -> Result<(), String> {
    begin(sender, port, out)?;
    let count = made.lines.len();
    for (done, (number, line)) in made.lines.iter().enumerate() {
        sender.send(*number, line, |line, string| match line {
            Line::Tool(tool) if !args.yes => asks(&format!("Tool {tool}: put it in, then Enter")),
            _ if args.single_block => asks(&format!("{string} Enter sends it")),
            _ => true,
        })?;
        let done = done + 1;
        if done == count || done.is_multiple_of(100) {
            eprintln!("{} of {}", grouped(done), counted(count as u64, "line"));
            out.object(&json!({"kind": "progress", "lines": done, "of": count}));
        }
    }
    Ok(())
}

/// Prints a failure of the controller.
fn failed_at(job: &Job, message: &str, out: &mut Reporter<'_>) -> u8 {
    out.failed(job.name(), message);
    failed()
}

/// The program as lines of the mill. Everything that is dropped or changed is reported. `None` if
/// it has errors.
fn translated(job: &mut Job, out: &mut Reporter<'_>) -> Result<Option<Translated>, Failure> {
    job.keep_input()?;
    let (_, findings) =
        with_some_findings(MOST_PRINTED, out.format(), |findings| job.check(findings))?;
    out.findings(job.name(), &findings);
    if findings.errors > 0 {
        if !out.is_json() {
            let verdict = verdict(findings.errors, findings.warnings);
            eprintln!("{}: {verdict}; nothing is made", job.name());
        }
        return Ok(None);
    }
    let made = micromill::translated(job, job.open()?)?;
    print_notes(job, &made, out);
    Ok(made.errors.is_empty().then_some(made))
}

/// Prints what of a program is dropped or changed, and what cannot be made.
fn print_notes(job: &Job, made: &Translated, out: &mut Reporter<'_>) {
    let notes = made.notes.iter().map(|note| (note, "note"));
    let errors = made.errors.iter().map(|error| (error, "error"));
    for ((line, text), severity) in notes.chain(errors) {
        let file = job.name();
        match (out.is_json(), severity) {
            (true, _) => out.object(&json!({
                "kind": "note", "severity": severity, "file": file, "line": line, "message": text,
            })),
            (false, "note") => eprintln!("{file}:{line}: {text}"),
            (false, _) => eprintln!("error: {file}:{line}: {text}"),
        }
    }
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
