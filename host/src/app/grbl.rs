//! `send` for a controller that speaks Grbl's protocol.

mod resume;

pub use resume::Before;

use super::job::{Job, load, whole};
use super::milling::failed;
use super::reporting::{MOST_PRINTED, verdict, with_some_findings};
use super::{ERRORS, Failure, OK};
use crate::cli::{Send, Target};
use crate::console::keys::Keys;
use crate::console::reporter::Reporter;
use crate::console::sharing::share;
use crate::console::stop::stop_requests;
use crate::console::typed::{Typed, typed};
use husillo_clients::grbl::{BAUD, Heard, Operator, Pacing, Sender, open};
use husillo_transports::grbl::{
    Adjust, LINE_CHARACTERS, Line, LineReader, Realtime, Settings, State,
};
use serde_json::json;

/// Lines of a program with their numbers.
type Numbered = Vec<(usize, String)>;

/// Whether a machine is any controller that speaks Grbl's protocol.
pub(super) fn is_grbl(machine: Option<&str>) -> bool {
    machine == Some("grbl")
}

/// Settings of a simulated controller with the axes of a machine. It homes, as most machines do.
pub(super) fn simulated(machine: &str) -> Result<Settings, Failure> {
    let mut settings = crate::grbl::settings(&load(machine)?)?;
    let homing = [(22, "1"), (24, "100"), (25, "1000")];
    for (number, value) in homing {
        let written = settings.write(number, value.as_bytes());
        written.map_err(|error| format!("${number}={value}: {}", error.text()))?;
    }
    Ok(settings)
}

/// Checks a program, sends it, and waits until it is made.
pub(super) fn send(args: &Send, out: &mut Reporter<'_>) -> Result<u8, Failure> {
    let (file, port) = args.alone()?;
    expect_options_of_grbl(args)?;
    let Some((job, lines)) = checked(args, file, out)? else {
        return Ok(ERRORS);
    };
    let baud = args.baud.unwrap_or(BAUD);
    let stop = stop_requests()?;
    let wire = open(port, baud)?;
    share("grbl", port, baud);
    let pacing = match args.single_block {
        true => Pacing::SingleBlock,
        false => Pacing::Counted,
    };
    let mut sender = match Sender::new(wire, pacing, stop) {
        Ok(sender) => sender,
        Err(message) => {
            out.failed(port, &message);
            return Ok(failed());
        }
    };
    let lines = match args.from {
        None => lines,
        Some(from) => match resume::from(&job, lines, from as usize, &mut sender) {
            Ok(lines) if args.yes || resume::is_wanted(&lines, from as usize) => lines,
            Ok(_) => return Ok(ERRORS),
            Err(message) => {
                out.failed(job.name(), &message);
                return Ok(ERRORS);
            }
        },
    };
    if !out.is_json() {
        eprintln!(
            "{port}: if this program is killed, the controller completes the lines that it has: at \
             most 127 bytes, and {} moves before them",
            sender.queue()
        );
    }
    let mut operator = AtTerminal::new(args, lines.len(), out);
    let sent = match args.checked {
        true => sender.send_checked(&lines, &mut operator),
        false => sender.send(&lines, &mut operator),
    };
    match sent {
        Ok(sent) => {
            let (stands, count) = (sender.session().stands(), sent.lines);
            operator.end();
            let line = format!("{}: {} made; {stands}", job.name(), counted_lines(count));
            let object = json!({"kind": "done", "lines": count, "position": stands});
            out.tell(line, || object);
            Ok(OK)
        }
        Err(message) => {
            operator.end();
            out.failed(job.name(), &message);
            if let (false, Some((number, _))) = (out.is_json(), lines.get(sender.first_open())) {
                let name = job.name();
                eprintln!(
                    "{name}: all lines before line {number} are made: --from {number} goes on"
                );
            }
            Ok(failed())
        }
    }
}

/// The program, and the lines of it that the controller gets. `None`: it has errors.
fn checked(
    args: &Send,
    file: &str,
    out: &mut Reporter<'_>,
) -> Result<Option<(Job, Numbered)>, Failure> {
    let target = Target {
        machine: Some("free".into()),
        dialect: args.target.dialect.clone().or(Some("grbl".into())),
        include: args.target.include.clone(),
    };
    let mut job = Job::new(file, &target, "free")?;
    job.keep_input()?;
    let (_, findings) =
        with_some_findings(MOST_PRINTED, out.format(), |findings| job.check(findings))?;
    out.findings(job.name(), &findings);
    if findings.errors > 0 {
        if !out.is_json() {
            let verdict = verdict(findings.errors, findings.warnings);
            eprintln!("{}: {verdict}; nothing is sent", job.name());
        }
        return Ok(None);
    }
    Ok(match lines(&job)? {
        Ok(lines) => Some((job, lines)),
        Err(why) => {
            out.failed(job.name(), &why);
            None
        }
    })
}

fn counted_lines(count: usize) -> String {
    super::count(count as u64, "line")
}

fn expect_options_of_grbl(args: &Send) -> Result<(), Failure> {
    let other = [
        (args.detach, "--detach"),
        (args.lease.is_some(), "--lease"),
        (args.stream, "--stream"),
        (args.without_answers, "--without-answers"),
    ];
    match other.into_iter().find(|(is_given, _)| *is_given) {
        Some((_, option)) => Err(Failure::Usage(format!(
            "{option} is not for a Grbl controller"
        ))),
        None => Ok(()),
    }
}

/// The lines of a program as the controller reads them: without comments, blanks, and `%`. The
/// error is a line that it does not take.
fn lines(job: &Job) -> Result<Result<Numbered, String>, Failure> {
    let text = match &job.input {
        Some(input) => input.to_vec(),
        None => whole(&job.file)?,
    };
    Ok(sendable_lines(&text))
}

/// The same for a text.
pub fn sendable_lines(text: &[u8]) -> Result<Numbered, String> {
    let mut lines = Vec::new();
    for (number, line) in (1..).zip(text.split(|byte| *byte == b'\n')) {
        let mut reader = LineReader::new();
        for byte in line.iter().filter(|byte| **byte != b'\r') {
            reader.push(*byte);
        }
        match reader.push(b'\n') {
            Some(Line::Text(text)) if !text.is_empty() && !text.starts_with(b"%") => {
                lines.push((number, String::from_utf8_lossy(text).into_owned()));
            }
            Some(Line::TooLong) => {
                return Err(format!(
                    "line {number} has more than {LINE_CHARACTERS} characters, which Grbl does not \
                     take: shorten it"
                ));
            }
            _ => {}
        }
    }
    Ok(lines)
}

/// The operator at the terminal of this program.
struct AtTerminal<'a, 'b> {
    keys: Option<Keys>,
    count: usize,
    shown: usize,
    /// Whether the line of the present question was printed.
    is_asking: bool,
    out: &'a mut Reporter<'b>,
}

const HELP: &str = "keys: ! holds, ~ resumes, + and - change the feed by 10 %, = restores it, \
                    q stops and ends";

impl<'a, 'b> AtTerminal<'a, 'b> {
    fn new(args: &Send, count: usize, out: &'a mut Reporter<'b>) -> Self {
        // Standard input may be the program, or the answers of --single-block.
        let is_free = !args.single_block && args.files.first().is_none_or(|file| file != "-");
        let keys = if is_free { Keys::new() } else { None };
        if keys.is_some() {
            eprintln!("{HELP}");
        }
        Self {
            keys,
            count,
            shown: 0,
            is_asking: false,
            out,
        }
    }

    /// Gives the terminal back.
    fn end(self) {
        drop(self.keys);
    }
}

impl Operator for AtTerminal<'_, '_> {
    fn hear(&mut self, heard: &Heard) {
        match heard {
            Heard::Status(status) => {
                let state = status.state.name();
                self.out.object(&json!({"kind": "state", "state": state}));
                let advice = match status.state {
                    State::Hold(false) if self.keys.is_none() => {
                        "the machine is held: its start button resumes it, Ctrl-C ends the program"
                    }
                    State::Hold(false) => "the machine is held: ~ resumes",
                    State::Door(0) => "the door is closed again: ~ resumes",
                    State::Door(1) => "the door is open",
                    _ => return,
                };
                if !self.out.is_json() {
                    eprintln!("{advice}");
                }
            }
            Heard::Text(text) => self.out.tell(
                format!("  {text}"),
                || json!({"kind": "text", "text": text}),
            ),
            _ => {}
        }
    }

    fn progress(&mut self, lines: usize) {
        if lines == self.count || lines >= self.shown + 100 {
            self.shown = lines;
            if !self.out.is_json() {
                eprintln!("{lines} of {}", counted_lines(self.count));
            }
            let object = json!({"kind": "progress", "lines": lines, "of": self.count});
            self.out.object(&object);
        }
    }

    fn command(&mut self) -> Option<Realtime> {
        Some(match self.keys.as_ref()?.next()? {
            b'!' | b' ' => Realtime::Hold,
            b'~' | b'\n' => Realtime::Resume,
            b'+' => Realtime::Feed(Adjust::By(10)),
            b'-' => Realtime::Feed(Adjust::By(-10)),
            b'=' => Realtime::Feed(Adjust::Reset),
            b'q' => Realtime::Reset,
            _ => {
                eprintln!("{HELP}");
                return None;
            }
        })
    }

    fn agrees(&mut self, line: &str) -> Option<bool> {
        if !std::mem::replace(&mut self.is_asking, true) {
            eprintln!("{line} Enter sends it (or q to end)");
        }
        let agrees = match typed() {
            Typed::Nothing => return None,
            Typed::Line(answer) => !answer.trim().eq_ignore_ascii_case("q"),
            Typed::End => false,
        };
        self.is_asking = false;
        Some(agrees)
    }
}
