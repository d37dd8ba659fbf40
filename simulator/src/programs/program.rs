//! Walks a program block by block and interprets each block.

mod lines;

use crate::diagnostics::{Finding, Findings};
use crate::programs::blocks::{self, Given};
use crate::programs::explain::{self, At};
use crate::programs::reading::{Reading, Results};
use crate::programs::source::{LONGEST_LINE, Source};
use crate::programs::watch::Watch;
use husillo_gcode::{
    Block, Command, Compensated, Compensation, Dialect, Error, ErrorKind, Modal, Nm, Tool, words,
};
use husillo_sim::observers::AXES;
use std::collections::VecDeque;
use std::fmt::Write;
use std::io;
use std::ops::ControlFlow;

pub use lines::Lines;

/// Largest number of commands of a program with loops. The parser limits the number of lines, but
/// one line of a canned cycle can give 2^16 commands. At a thousand commands per second they take a
/// machine hours.
const MOST_COMMANDS: u64 = 10_000_000;

/// How a program begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Its language.
    pub dialect: Dialect,
    /// Work zero of the work frames that have none of their own, in machine coordinates.
    pub zero: [Nm; AXES],
    /// The zeros of work frames that the machine file states.
    pub frames: Frames,
    /// Position of the tool, in machine coordinates.
    pub at: [Nm; AXES],
    /// The tools of the machine, by number.
    pub tools: [Option<(u32, Tool<AXES>)>; 8],
}

impl From<Dialect> for Start {
    /// Homed, with work zero at machine zero.
    fn from(dialect: Dialect) -> Self {
        Self {
            dialect,
            zero: [Nm(0); AXES],
            frames: [None; WORK_FRAMES],
            at: [Nm(0); AXES],
            tools: [None; 8],
        }
    }
}

impl Start {
    /// The initial modal state.
    fn modal(&self) -> Modal<AXES> {
        let mut modal = Modal::new(self.dialect);
        for (system, own) in (0..).zip(self.frames) {
            modal.set_work_zero(system, own.unwrap_or(self.zero));
        }
        modal.set_position(self.at);
        for (number, tool) in self.tools.into_iter().flatten() {
            modal.set_tool(number, tool);
        }
        modal
    }
}

/// G54 to G59.3.
pub const WORK_FRAMES: usize = 9;
/// The zero of each work frame in machine coordinates, where it is stated.
pub type Frames = [Option<[Nm; AXES]>; WORK_FRAMES];

/// The origin of a command.
#[derive(Debug)]
pub struct Meaning<'a> {
    /// The block with the command.
    pub at: At<'a>,
}

/// The state between two blocks.
#[derive(Clone, Debug)]
struct Walker<'a> {
    file: &'a str,
    dialect: Dialect,
    /// Commands that are left before a program with loops reaches the limit.
    left: u64,
    modal: Modal<AXES>,
    /// The assumed results of probe and inputs.
    results: Results<AXES>,
    /// Computes the path of the tool under compensation. Otherwise it passes commands unchanged.
    stage: Compensation<AXES>,
    /// The commands of the block.
    made: Compensated<AXES>,
    /// Origins of the commands that wait in `stage`, in their order.
    waiting: VecDeque<Held>,
    /// End of the last command.
    from: [Nm; AXES],
    last_line: usize,
    has_ended: bool,
    watch: Watch,
    /// The state of a machine that begins without a motion mode, until the first motion code.
    strict: Option<Modal<AXES>>,
}

/// The origin of a command that waits for the corner after it.
#[derive(Clone, Debug)]
struct Held {
    /// The file of a subroutine.
    file: Option<String>,
    line: usize,
    bytes: Vec<u8>,
    block: usize,
    length: usize,
}

impl Held {
    fn new(at: &At<'_>, file: Option<&str>) -> Self {
        Self {
            file: file.map(str::to_owned),
            line: at.line,
            bytes: at.bytes.to_owned(),
            block: at.block,
            length: at.length,
        }
    }

    fn meaning<'a>(&'a self, file: &'a str, dialect: Dialect) -> Meaning<'a> {
        Meaning {
            at: At {
                file: self.file.as_deref().unwrap_or(file),
                line: self.line,
                bytes: &self.bytes,
                block: self.block,
                length: self.length,
                dialect,
            },
        }
    }
}

/// Receives each command with its origin and the position of the tool before it.
type Each<'e> =
    &'e mut dyn FnMut(&Meaning<'_>, &Command<AXES>, [Nm; AXES], &mut Findings) -> io::Result<()>;

impl<'a> Walker<'a> {
    fn new(left: u64, file: &'a str, start: Start) -> Self {
        let modal = start.modal();
        let starts_in_rapid = modal.motion().is_some();
        Self {
            file,
            dialect: start.dialect,
            left,
            from: modal.position(),
            modal,
            results: Results::NONE,
            stage: Compensation::new(start.at),
            made: Compensated::new(),
            waiting: VecDeque::new(),
            last_line: 1,
            has_ended: false,
            watch: Watch::default(),
            strict: (starts_in_rapid && start.dialect.name() != Dialect::GRBL.name())
                .then(|| Modal::new(start.dialect.with_rapid_start(false))),
        }
    }

    /// Whether this is the first motion and has no motion code. It is then taken as G0.
    fn assumes_rapid(&mut self, block: &Block) -> bool {
        let Some(strict) = &self.strict else {
            return false;
        };
        let planned = strict.plan(block).map(|(next, _)| next);
        let kind = planned.as_ref().err().map(|error| error.kind);
        let assumes =
            kind == Some(ErrorKind::AxisWordsWithoutMotion) && self.modal.motion().is_some();
        match planned {
            Ok(next) => self.strict = Some(next).filter(|next| next.motion().is_none()),
            Err(_) if assumes => self.strict = None,
            Err(_) => {}
        }
        assumes
    }

    /// What expressions can read.
    const fn reading(&self) -> Reading<'_, AXES> {
        Reading {
            modal: &self.modal,
            results: self.results,
        }
    }

    /// Interprets a block; its commands are then in `made`. An error leaves the state unchanged.
    fn plan(&mut self, given: &Given<'_>, block: &Block) -> Result<(), Error> {
        self.modal.apply(block, self.made.commands())?;
        self.stage.apply(&mut self.made).map_err(|kind| {
            self.modal.revert(self.made.commands());
            Error {
                kind,
                at: 0,
                end: given.text.trim_ascii_end().len(),
            }
        })
    }

    /// The end position according to the axis words of a refused move. `None` without axis words,
    /// and in a block whose axis words are not the end of a move.
    fn end_of(&self, given: &Given<'_>, block: &Block) -> Option<[Nm; AXES]> {
        let mut line = String::from("G0");
        // Codes for units and distance mode in this line apply.
        for word in words(given.text).map_while(Result::ok) {
            let number = word.value.to_string();
            match (word.letter, &number[..]) {
                (b'G', "20" | "21" | "53" | "90" | "91") => {
                    let _ = write!(line, " G{number}");
                }
                (b'G', "4" | "10" | "28" | "28.1" | "30" | "30.1" | "43.1" | "50" | "51") => {
                    return None;
                }
                (b'G', "52" | "92" | "92.1" | "92.2" | "92.3") => return None,
                _ => {}
            }
        }
        let modes = line.len();
        for (axis, letter) in self.dialect.axes().letters().enumerate() {
            if let Some(value) = block.axis(axis) {
                let _ = write!(line, " {}{value}", char::from(letter));
            }
        }
        let block = Block::parse(line.as_bytes(), &self.dialect).ok()?;
        let (next, _) = self.modal.plan(&block).ok()?;
        (line.len() > modes).then(|| next.position())
    }

    /// Continues after a refused move as if it had been made, so that one error is reported once.
    fn assume(&mut self, end: [Nm; AXES]) {
        if !self.stage.is_active() {
            self.modal.set_position(end);
            self.stage = Compensation::new(end);
            self.from = end;
        }
    }

    /// Takes a block. Passes on the commands that waited for it, and its own.
    fn block(
        &mut self,
        given: &Given<'_>,
        block: Result<Block, Error>,
        findings: &mut Findings,
        each: Each<'_>,
    ) -> io::Result<ControlFlow<()>> {
        let at = At {
            file: given.file.unwrap_or(self.file),
            line: given.number,
            bytes: given.bytes,
            block: given.at,
            length: given.text.len(),
            dialect: self.dialect,
        };
        if given.repeats {
            findings.report_once();
        }
        if given.file.is_none() {
            self.last_line = given.number;
        }
        self.watch.step();
        if blocks::is_grbl_command(given.text, &self.dialect) {
            findings.add(grbl_command(&at));
            return Ok(ControlFlow::Continue(()));
        }
        let held = self.stage.held();
        let planned = match &block {
            Ok(block) => self.plan(given, block),
            Err(error) => Err(*error),
        };
        let assumes_rapid = block.as_ref().is_ok_and(|block| self.assumes_rapid(block));
        match planned {
            Ok(()) => {
                if assumes_rapid {
                    findings.add(rapid_assumed(&at));
                }
            }
            Err(error) => {
                findings.add(explain::finding(&error, &at));
                if let Some(end) = block.ok().and_then(|block| self.end_of(given, &block)) {
                    self.assume(end);
                }
                return Ok(ControlFlow::Continue(()));
            }
        }
        let meaning = Meaning { at };
        // Commands that waited keep the origins of their own lines.
        let mut command = self.made.next();
        let mut freed = VecDeque::new();
        if held > 0 && command.is_some() {
            std::mem::swap(&mut freed, &mut self.waiting);
        }
        while self.waiting.len() < self.stage.held() {
            self.waiting.push_back(Held::new(&at, given.file));
        }
        while let Some(made) = command {
            if given.repeats && !self.may_go_on() {
                findings.add(too_many_commands(&at));
                return Ok(ControlFlow::Break(()));
            }
            self.give(freed.pop_front(), &meaning, &made, findings, each)?;
            self.results.assume(&made, &self.modal);
            self.has_ended |= matches!(made, Command::End { .. });
            command = self.made.next();
        }
        if self.has_ended {
            return Ok(ControlFlow::Break(()));
        }
        if given.overlong {
            findings.add(overlong(&at));
        }
        Ok(ControlFlow::Continue(()))
    }

    /// Counts a command. Returns `false` if the limit was reached before it.
    const fn may_go_on(&mut self) -> bool {
        let may = self.left > 0;
        self.left = self.left.saturating_sub(1);
        may
    }

    /// Passes on a command. One that waited keeps its own origin.
    fn give(
        &mut self,
        waited: Option<Held>,
        meaning: &Meaning<'_>,
        command: &Command<AXES>,
        findings: &mut Findings,
        each: Each<'_>,
    ) -> io::Result<()> {
        self.watch.step();
        match waited {
            Some(held) => {
                let meaning = held.meaning(self.file, self.dialect);
                each(&meaning, command, self.from, findings)?;
            }
            None => each(meaning, command, self.from, findings)?,
        }
        self.from = command.end().unwrap_or(self.from);
        Ok(())
    }

    /// Passes on the last move of a program that ends without G40. Its origin is the end of the
    /// file.
    fn finish(&mut self, findings: &mut Findings, each: Each<'_>) -> io::Result<()> {
        if self.has_ended || !self.stage.is_active() {
            return Ok(());
        }
        let end = Meaning {
            at: At {
                file: self.file,
                line: self.last_line,
                bytes: b"",
                block: 0,
                length: 0,
                dialect: self.dialect,
            },
        };
        for command in self.stage.clone().finish() {
            let waited = self.waiting.pop_front();
            self.give(waited, &end, &command, findings, each)?;
        }
        Ok(())
    }
}

fn too_many_commands(at: &At<'_>) -> Finding {
    Finding::error("E0638", "the program does not end", at.whole())
        .label("10 million commands so far: an endless loop?")
        .note("the limit holds for programs with parameters or O-words")
}

fn grbl_command(at: &At<'_>) -> Finding {
    Finding::warning("W0604", "command of Grbl is left out", at.whole())
        .label("settings and homing are no part of a program")
}

fn rapid_assumed(at: &At<'_>) -> Finding {
    let message = "axis words before the first motion code are taken as G0";
    Finding::warning("W0605", message, at.whole())
        .label("the first motion of the program")
        .note("Grbl and grblHAL begin in G0; LinuxCNC refuses this line")
        .help("write G0 or G1 before the axis words")
}

fn overlong(at: &At<'_>) -> Finding {
    let place = at.place(LONGEST_LINE - 1..LONGEST_LINE);
    let message = format!("line longer than {LONGEST_LINE} characters");
    Finding::error("E0104", message, place).label("the rest is not read")
}

/// Walks a whole program to its end. `findings` receives every error, and `each` every command.
///
/// A block with an error changes no mode, and the walk continues at the end of its move. Returns
/// the state after the last block.
///
/// # Errors
///
/// Reading fails, or `each` does.
pub fn walk(
    source: &mut Source,
    file: &str,
    start: impl Into<Start>,
    findings: &mut Findings,
    each: impl FnMut(&Meaning<'_>, &Command<AXES>, [Nm; AXES], &mut Findings) -> io::Result<()>,
) -> io::Result<Modal<AXES>> {
    walk_within(MOST_COMMANDS, source, file, start.into(), findings, each)
}

fn walk_within(
    left: u64,
    source: &mut Source,
    file: &str,
    start: Start,
    findings: &mut Findings,
    mut each: impl FnMut(&Meaning<'_>, &Command<AXES>, [Nm; AXES], &mut Findings) -> io::Result<()>,
) -> io::Result<Modal<AXES>> {
    let mut walker = Walker::new(left, file, start);
    walker.watch = source.take_watch();
    blocks::each_block(
        source,
        start.dialect,
        &mut walker,
        Walker::reading,
        |walker, given, block| {
            let flow = walker.block(given, block, findings, &mut each)?;
            Ok(match findings.is_decided() {
                true => ControlFlow::Break(()),
                false => flow,
            })
        },
    )?;
    walker.finish(findings, &mut each)?;
    Ok(walker.modal)
}

#[cfg(test)]
mod tests {
    use super::*;
    fn within(most: u64, text: &'static str) -> (usize, String) {
        let mut source = Source::from_reader(Box::new(text.as_bytes()));
        let mut findings = Findings::new(50);
        let mut commands = 0;
        let dialect = Dialect::RS274;
        walk_within(
            most,
            &mut source,
            "p",
            dialect.into(),
            &mut findings,
            |_, _, _, _| {
                commands += 1;
                Ok(())
            },
        )
        .unwrap();
        (commands, findings.short().concat())
    }

    #[test]
    fn an_endless_loop_of_cycles_is_stopped() {
        let endless = "F9\no1 while [1]\nG91 G81 X1 Z-1 R0 L9\nG80\no1 endwhile\n";
        let reported = "p:3:1: error[E0638]: the program does not end";
        assert_eq!(within(1000, endless), (1000, reported.into()));
    }

    #[test]
    fn the_limit_does_not_apply_to_programs_without_loops() {
        assert_eq!(within(3, "G0 X1\nX2\nX3\nX4\n"), (4, String::new()));
        assert_eq!(within(3, "#1=1\nG0 X1\nX2\nX3\n"), (3, String::new()));
    }
}
