//! `husillo commands`: lists the commands of a program, one per line.

mod json;

use crate::diagnostics::Findings;
use crate::programs::program::{self, Start};
use crate::programs::source::Source;
use crate::text::json::write_line;
use json::Line;
use std::io::{self, Write};

/// Prints the commands of a program, as text or as JSON objects.
///
/// # Errors
///
/// Reading or writing fails.
pub fn print(
    source: &mut Source,
    file: &str,
    start: Start,
    is_json: bool,
    findings: &mut Findings,
    out: &mut impl Write,
) -> io::Result<()> {
    let axes = *start.dialect.axes();
    program::walk(
        source,
        file,
        start,
        findings,
        |meaning, command, from, _| {
            if !is_json {
                let command = command.shown(axes);
                return writeln!(out, "{:>6}  {command}", meaning.at.line);
            }
            if let Some(line) = Line::new(meaning.at.line, command, from, &axes) {
                write_line("husillo.commands/1", &line, out)?;
            }
            Ok(())
        },
    )?;
    Ok(())
}
