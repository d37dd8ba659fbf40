//! A program file walked block by block, with what every block means.

use crate::diagnostics::{Finding, Findings};
use crate::programs::blocks::{self, Given};
use crate::programs::explain::{self, At};
use crate::programs::source::{LONGEST_LINE, Source};
use husillo_gcode::{Block, Command, Compensated, Compensation, Dialect, Error, Modal, Nm};
use std::collections::VecDeque;
use std::io::{self, Write};
use std::ops::ControlFlow;

/// Most commands of a program with loops: lines are counted by the crate, but one line of a canned cycle can give 2^16.
const MOST_COMMANDS: u64 = 50_000_000;

/// How a program begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Its language.
    pub dialect: Dialect,
    /// Work zero, of every work frame: machine coordinates.
    pub zero: [Nm; 3],
    /// Where the tool is: machine coordinates.
    pub at: [Nm; 3],
}

impl From<Dialect> for Start {
    /// Homed, with work zero at machine zero.
    fn from(dialect: Dialect) -> Self {
        Self {
            dialect,
            zero: [Nm(0); 3],
            at: [Nm(0); 3],
        }
    }
}

impl Start {
    /// The state of the language.
    fn modal(&self) -> Modal<3> {
        let mut modal = Modal::new(self.dialect);
        for system in 0..WORK_FRAMES {
            modal.set_work_zero(system, self.zero);
        }
        modal.set_position(self.at);
        modal
    }
}

/// G54 to G59.3.
const WORK_FRAMES: u8 = 9;

/// One block that means something.
#[derive(Debug)]
pub struct Meaning<'a> {
    /// Where it stands.
    pub at: At<'a>,
}

/// The state between two blocks.
struct Walker {
    modal: Modal<3>,
    /// The tool's path, where a program asks for compensation; else the commands as they are.
    stage: Compensation<3>,
    /// Where the commands stood that wait in it, in their order.
    waiting: VecDeque<Held>,
    last_line: usize,
    ended: bool,
}

/// The place of a command that waits for the corner behind it.
struct Held {
    line: usize,
    bytes: Vec<u8>,
    block: usize,
    length: usize,
}

impl Held {
    fn new(at: &At<'_>) -> Self {
        Self {
            line: at.line,
            bytes: at.bytes.to_owned(),
            block: at.block,
            length: at.length,
        }
    }

    fn meaning<'a>(&'a self, file: &'a str, dialect: Dialect) -> Meaning<'a> {
        Meaning {
            at: At {
                file,
                line: self.line,
                bytes: &self.bytes,
                block: self.block,
                length: self.length,
                dialect,
            },
        }
    }
}

impl Walker {
    /// What a block means; an error changes nothing.
    fn plan(
        &mut self,
        given: &Given<'_>,
        block: Result<Block, Error>,
    ) -> Result<Compensated<3>, Error> {
        self.last_line = given.number;
        let (next, commands) = self.modal.plan(&block?)?;
        let (after, commands) = self.stage.plan(commands).map_err(|kind| Error {
            kind,
            at: 0,
            end: given.text.trim_ascii_end().len(),
        })?;
        self.modal = next;
        self.stage = after;
        Ok(commands)
    }
}

/// Walks a whole program: every error goes to `findings`, every command to `each`, until the program ends.
///
/// A block with an error changes nothing and the walk goes on behind it. Returns the state after the last block.
///
/// # Errors
///
/// Reading or writing fails.
pub fn walk<W: Write>(
    source: &mut Source,
    file: &str,
    start: impl Into<Start>,
    findings: &mut Findings<W>,
    each: impl FnMut(&Meaning<'_>, &Command<3>, [Nm; 3], &mut Findings<W>) -> io::Result<()>,
) -> io::Result<Modal<3>> {
    walk_within(MOST_COMMANDS, source, file, start.into(), findings, each)
}

fn walk_within<W: Write>(
    mut left: u64,
    source: &mut Source,
    file: &str,
    start: Start,
    findings: &mut Findings<W>,
    mut each: impl FnMut(&Meaning<'_>, &Command<3>, [Nm; 3], &mut Findings<W>) -> io::Result<()>,
) -> io::Result<Modal<3>> {
    let dialect = start.dialect;
    let mut walker = Walker {
        modal: start.modal(),
        stage: Compensation::new(start.at),
        waiting: VecDeque::new(),
        last_line: 1,
        ended: false,
    };
    let mut from = walker.modal.position();
    blocks::each_block(
        source,
        dialect,
        &mut walker,
        |walker| &walker.modal,
        |walker, given, block| {
            let at = At {
                file,
                line: given.number,
                bytes: given.bytes,
                block: given.at,
                length: given.text.len(),
                dialect,
            };
            if given.repeats {
                findings.tell_once();
            }
            let before = walker.stage.held();
            let commands = match walker.plan(given, block) {
                Ok(commands) => commands,
                Err(error) => {
                    findings.add(&explain::finding(&error, &at))?;
                    return Ok(ControlFlow::Continue(()));
                }
            };
            let meaning = Meaning { at };
            // What waited is of the lines it stood on.
            let mut commands = commands.peekable();
            let mut freed = VecDeque::new();
            if before > 0 && commands.peek().is_some() {
                std::mem::swap(&mut freed, &mut walker.waiting);
            }
            while walker.waiting.len() < walker.stage.held() {
                walker.waiting.push_back(Held::new(&at));
            }
            for command in commands {
                if given.repeats {
                    if left == 0 {
                        let message = "program gives too many commands";
                        let finding = Finding::error("E0638", message, at.whole());
                        let finding = finding.label("an endless loop?");
                        findings.add(&finding.note("50 million commands"))?;
                        return Ok(ControlFlow::Break(()));
                    }
                    left -= 1;
                }
                match freed.pop_front() {
                    Some(held) => each(&held.meaning(file, dialect), &command, from, findings)?,
                    None => each(&meaning, &command, from, findings)?,
                }
                from = target(&command).unwrap_or(from);
                walker.ended |= matches!(command, Command::End { .. });
            }
            if walker.ended {
                return Ok(ControlFlow::Break(()));
            }
            if given.overlong {
                let place = at.place(LONGEST_LINE - 1..LONGEST_LINE);
                let message = format!("line longer than {LONGEST_LINE} characters");
                let finding = Finding::error("E0104", message, place);
                findings.add(&finding.label("the rest is not read"))?;
            }
            Ok(ControlFlow::Continue(()))
        },
    )?;
    let Walker {
        modal,
        stage,
        mut waiting,
        last_line,
        ended,
    } = walker;
    if ended {
        return Ok(modal);
    }
    if stage.is_active() {
        // A program that ends without G40: its last move, told at the end of the file.
        let meaning = Meaning {
            at: At {
                file,
                line: last_line,
                bytes: b"",
                block: 0,
                length: 0,
                dialect,
            },
        };
        for command in stage.finish() {
            match waiting.pop_front() {
                Some(held) => each(&held.meaning(file, dialect), &command, from, findings)?,
                None => each(&meaning, &command, from, findings)?,
            }
            from = target(&command).unwrap_or(from);
        }
    }
    Ok(modal)
}

/// Where a command ends, if it moves.
pub fn target(command: &Command<3>) -> Option<[Nm; 3]> {
    command.end()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostics::Format;

    fn within(most: u64, text: &'static str) -> (usize, String) {
        let mut source = Source::from_reader(Box::new(text.as_bytes()));
        let mut findings = Findings::new(Vec::new(), Format::Short, false, 50);
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
        let told = String::from_utf8(findings.writer().clone()).unwrap();
        (commands, told)
    }

    #[test]
    fn a_loop_of_cycles_ends() {
        let endless = "F9\no1 while [1]\nG91 G81 X1 Z-1 R0 L9\nG80\no1 endwhile\n";
        let told = "p:3:1: error[E0638]: program gives too many commands\n";
        assert_eq!(within(1000, endless), (1000, told.into()));
    }

    #[test]
    fn a_program_without_loops_has_as_many_commands_as_it_likes() {
        assert_eq!(within(3, "G0 X1\nX2\nX3\nX4\n"), (4, String::new()));
        assert_eq!(within(3, "#1=1\nG0 X1\nX2\nX3\n"), (3, String::new()));
    }
}
