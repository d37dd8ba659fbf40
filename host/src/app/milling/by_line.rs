//! `send -` from a terminal or a pipe: each line is made when it arrives.

use super::comparison::compared;
use super::{begin, connected, expect_a_command, failed_at, print_notes, stand, unhomed};
use crate::app::job::Job;
use crate::app::reporting::{MOST_PRINTED, with_some_findings};
use crate::app::{ERRORS, Failure};
use crate::cli::Send;
use crate::console::progress::reading;
use crate::console::reporter::Reporter;
use crate::console::stop::stops_asked;
use crate::console::typed::{next_line, terminal_lines, typed_lines};
use husillo_clients::micromill::{Sender, Translated, Translator};
use husillo_sim::text::counted;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::programs::check::Checker;
use husillo_simulator::programs::program::{Lines, Meaning};
use husillo_simulator::programs::setup;
use husillo_simulator::programs::zero;
use husillo_transports::micromill::Line;
use serde_json::json;
use std::io::{self, IsTerminal};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

/// The session with the controller continues at this interval while no line arrives.
const LOOK: Duration = Duration::from_millis(20);

/// Whether standard input is no file, so that its lines may depend on what the mill does.
pub(super) fn is_for(file: &str) -> bool {
    file == "-" && !is_file()
}

#[cfg(unix)]
fn is_file() -> bool {
    use std::os::fd::AsFd;
    let input = io::stdin().as_fd().try_clone_to_owned();
    let file = input.map(std::fs::File::from);
    file.and_then(|file| file.metadata())
        .is_ok_and(|metadata| metadata.is_file())
}

#[cfg(not(unix))]
fn is_file() -> bool {
    !io::stdin().is_terminal()
}

/// Interprets and sends lines.
struct Session<'a, 'b> {
    args: &'a Send,
    job: &'a Job,
    sender: Sender,
    program: Lines<'a>,
    checker: Checker<'a>,
    translator: Translator<'a>,
    /// Everything that was sent.
    sent: Translated,
    input: Receiver<String>,
    is_terminal: bool,
    /// Answers of the operator, where standard input is a pipe.
    terminal: Option<Receiver<String>>,
    out: &'a mut Reporter<'b>,
}

/// The fate of a line.
enum Fate {
    Made,
    /// Errors were reported, and nothing has moved.
    Wrong,
    /// The controller has not made it.
    Failed(String),
}

pub(super) fn send(args: &Send, out: &mut Reporter<'_>) -> Result<u8, Failure> {
    let (file, port) = args.alone()?;
    let mut job = Job::new(file, &args.target, "micromill")?;
    if job.start.dialect.framing().is_some() {
        return Err(format!(
            "lines with numbers and checksums are not made one by one: put the program into a \
             file, or choose another --dialect than {}",
            job.start.dialect.name()
        )
        .into());
    }
    let is_terminal = io::stdin().is_terminal();
    let terminal = match is_terminal {
        true => None,
        false => terminal_lines(),
    };
    if args.single_block && !is_terminal && terminal.is_none() {
        let message = "--single-block waits for Enter at the terminal, and there is none";
        return Err(message.to_owned().into());
    }
    let config = setup::first_three(&job.config);
    let mut sender = match connected(args, port, &config)? {
        Ok(sender) => sender,
        Err(message) => return Ok(failed_at(&job, &message, out)),
    };
    let start = sender.start();
    stand(&mut job, start);
    if let Err(message) = begin(&mut sender, port, out) {
        return Ok(failed_at(&job, &message, out));
    }
    let config = setup::first_three(&job.config);
    let [zero, at] = [job.start.zero, job.start.at].map(setup::three);
    let mut session = Session {
        args,
        job: &job,
        sender,
        program: Lines::new(job.name(), job.start).with_watch(reading()),
        checker: Checker::new(&job.machine, &job.config),
        translator: Translator::new(&config, zero, at),
        sent: Translated::default(),
        input: typed_lines(),
        is_terminal,
        terminal,
        out,
    };
    let is_well = match session.all()? {
        Ok(is_well) => is_well,
        Err(message) => return Ok(failed_at(&job, &message, session.out)),
    };
    let Session {
        mut sender,
        sent,
        out,
        ..
    } = session;
    if is_well && !is_terminal {
        expect_a_command(&sent, &job)?;
    }
    match sender.finish() {
        Ok(made) => {
            let status = compared(&job, args.every, &sent, start, &made, out)?;
            Ok(if is_well { status } else { ERRORS })
        }
        Err(message) => Ok(failed_at(&job, &message, out)),
    }
}

impl Session<'_, '_> {
    /// Makes all lines. Whether each was right; the message of a fault.
    fn all(&mut self) -> Result<Result<bool, String>, Failure> {
        if self.is_terminal {
            eprintln!(
                "Each line is made when you end it with Enter; M30 or Ctrl-D ends the program"
            );
        }
        while !self.program.has_ended() {
            let line = match self.next() {
                Ok(Some(line)) => line,
                Ok(None) => break,
                Err(message) => return Ok(Err(message)),
            };
            match self.line(Some(&line))? {
                Fate::Made => {}
                // Whoever types may type it again. What follows in a pipe was written for a program
                // with this line.
                Fate::Wrong if self.is_terminal => {}
                Fate::Wrong => return Ok(Ok(false)),
                Fate::Failed(message) => return Ok(Err(message)),
            }
        }
        Ok(match self.line(None)? {
            Fate::Failed(message) => Err(message),
            fate => Ok(matches!(fate, Fate::Made)),
        })
    }

    /// The next line. The session with the controller continues until it arrives.
    fn next(&mut self) -> Result<Option<String>, String> {
        loop {
            match self.input.recv_timeout(LOOK) {
                Ok(line) => return Ok(Some(line)),
                Err(RecvTimeoutError::Disconnected) => return Ok(None),
                // An answer that has arrived meanwhile is taken, and Ctrl-C is noticed.
                Err(RecvTimeoutError::Timeout) => self.sender.idle(1000)?,
            }
        }
    }

    /// Checks, translates and sends one line, or what the end of the program still gives.
    fn line(&mut self, line: Option<&str>) -> Result<Fate, Failure> {
        let (mut program, mut translator) = (self.program.clone(), self.translator.clone());
        let (checker, machine) = (&mut self.checker, &self.job.machine);
        let format = self.out.format();
        let (made, findings) = with_some_findings(MOST_PRINTED, format, |findings| {
            let each = |meaning: &Meaning<'_>, command: &_, from, findings: &mut Findings| {
                checker.command(meaning, command, from, findings);
                if let Some(beyond) = checker.take_beyond() {
                    findings.add(zero::move_beyond(&beyond, machine));
                }
                translator.push_command(meaning.at.line, command);
                Ok(())
            };
            match line {
                Some(line) => program.line(line.as_bytes(), findings, each)?,
                None => program.finish(findings, each)?,
            }
            Ok(translator.take())
        })?;
        if findings.errors + findings.warnings > 0 {
            self.out.findings(self.job.name(), &findings);
        }
        print_notes(self.job, &made, self.out);
        if findings.errors > 0 || !made.errors.is_empty() {
            self.program.count();
            return Ok(Fate::Wrong);
        }
        if let Some(message) = unhomed(self.sender.start(), &made) {
            return Ok(Fate::Failed(message.into()));
        }
        self.program = program;
        self.sent.commands += made.commands;
        self.translator = translator;
        for (number, line) in made.lines {
            if let Err(message) = self.string(number, line)? {
                return Ok(Fate::Failed(message));
            }
        }
        Ok(Fate::Made)
    }

    /// Sends a string, and shows it with its echo and the number of its steps.
    fn string(&mut self, number: usize, line: Line) -> Result<Result<(), String>, Failure> {
        let (args, is_terminal) = (self.args, self.is_terminal);
        let answers = match &self.terminal {
            Some(terminal) if !is_terminal => Some(terminal),
            _ if is_terminal => Some(&self.input),
            _ => None,
        };
        let asks = |what: &str| {
            let before = stops_asked();
            eprintln!("{what} (or q to end)");
            answers
                .and_then(|answers| next_line(answers, before))
                .is_some_and(|answer| !answer.trim().eq_ignore_ascii_case("q"))
        };
        let mut shown = String::new();
        let (_, before) = self.sender.echo();
        let sent = self.sender.send(number, &line, |line, string| {
            shown = string.to_owned();
            match line {
                Line::Tool(tool) if !args.yes => {
                    asks(&format!("Tool {tool}: put it in, then Enter"))
                }
                _ if args.single_block => asks(&format!("{string} Enter sends it")),
                _ => true,
            }
        });
        if let Err(message) = sent {
            return Ok(Err(message));
        }
        let (echo, after) = self.sender.echo();
        let steps = after - before;
        self.out.tell(
            format_args!("sent {shown} echo {echo} {}", counted(steps, "step")),
            || json!({"kind": "line", "sent": shown, "echo": echo, "steps": steps}),
        );
        self.sent.lines.push((number, line));
        Ok(Ok(()))
    }
}
