//! A program file walked block by block, with what every block means.

use crate::diagnostics::{Finding, Findings};
use crate::explain::{self, At};
use crate::source::{LONGEST_LINE, Source};
use husillo_gcode::{Block, Command, Dialect, Modal, Nm};
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
    while let Some(line) = source.next_line()? {
        let mut failed = false;
        for (block, text) in dialect.blocks(line.bytes) {
            let at = At {
                file,
                line: line.number,
                bytes: line.bytes,
                block,
                length: text.len(),
            };
            let planned = Block::parse(text, &dialect).and_then(|block| modal.plan(&block));
            let (next, commands) = match planned {
                Ok(planned) => planned,
                Err(error) => {
                    failed = true;
                    findings.add(&explain::finding(&error, &at))?;
                    continue;
                }
            };
            let mut ended = false;
            let mut from = modal.position();
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
    Ok(modal)
}

/// Where a command ends, if it moves.
pub fn target(command: &Command<3>) -> Option<[Nm; 3]> {
    command.end()
}
