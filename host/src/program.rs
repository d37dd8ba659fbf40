//! A program file walked block by block, with what every block means.

use crate::diagnostics::{Finding, Findings};
use crate::explain::{self, At};
use crate::source::{LONGEST_LINE, Source};
use husillo_gcode::{Block, Command, Compensation, Dialect, Error, Modal, Nm};
use std::io::{self, Write};

/// One block that means something.
#[derive(Debug)]
pub struct Meaning<'a> {
    /// Where it stands.
    pub at: At<'a>,
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
    dialect: Dialect,
    findings: &mut Findings<W>,
    mut each: impl FnMut(&Meaning<'_>, &Command<3>, [Nm; 3], &mut Findings<W>) -> io::Result<()>,
) -> io::Result<Modal<3>> {
    let mut modal = Modal::<3>::new(dialect);
    // The tool's path, where a program asks for compensation; else the commands as they are.
    let mut stage = Compensation::new(modal.position());
    let mut from = modal.position();
    let mut last_line = 1;
    while let Some(line) = source.next_line()? {
        last_line = line.number;
        let mut failed = false;
        for (block, text) in dialect.blocks(line.bytes) {
            let at = At {
                file,
                line: line.number,
                bytes: line.bytes,
                block,
                length: text.len(),
            };
            let planned = Block::parse(text, &dialect)
                .and_then(|block| modal.plan(&block))
                .and_then(|(next, commands)| {
                    let (after, commands) = stage.plan(commands).map_err(|kind| Error {
                        kind,
                        at: 0,
                        end: text.trim_ascii_end().len(),
                    })?;
                    stage = after;
                    Ok((next, commands))
                });
            let (next, commands) = match planned {
                Ok(planned) => planned,
                Err(error) => {
                    failed = true;
                    findings.add(&explain::finding(&error, &at))?;
                    continue;
                }
            };
            let mut ended = false;
            let meaning = Meaning { at };
            for command in commands {
                each(&meaning, &command, from, findings)?;
                from = target(&command).unwrap_or(from);
                ended |= matches!(command, Command::End { .. });
            }
            modal = next;
            if ended {
                return Ok(modal);
            }
        }
        if line.overlong && !failed {
            let at = At {
                file,
                line: line.number,
                bytes: line.bytes,
                block: 0,
                length: line.bytes.len(),
            };
            let place = at.place(LONGEST_LINE - 1..LONGEST_LINE);
            let message = format!("line longer than {LONGEST_LINE} characters");
            findings.add(&Finding::error("E0104", message, place).label("the rest is not read"))?;
        }
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
            },
        };
        for command in stage.finish() {
            each(&meaning, &command, from, findings)?;
            from = target(&command).unwrap_or(from);
        }
    }
    Ok(modal)
}

/// Where a command ends, if it moves.
pub fn target(command: &Command<3>) -> Option<[Nm; 3]> {
    command.end()
}
