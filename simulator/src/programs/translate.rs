//! `husillo format --to`: writes a program for another controller.

use crate::diagnostics::{Finding, Findings};
use crate::programs::blocks;
use crate::programs::explain::{self, At};
use crate::programs::format::Form;
use crate::programs::reading::{Reading, Results};
use crate::programs::source::Source;
use husillo_gcode::{Axes, Command, Dialect, Translator, Untranslated};
use husillo_sim::observers::AXES;
use std::io::{self, Write};
use std::ops::ControlFlow;

/// A translation in progress.
struct Work {
    translator: Translator<AXES>,
    /// Pieces of lines, each ended by LF.
    made: Vec<u8>,
}

/// Writes the program of `source` in the language of `form` to `out`. What the language lacks is
/// reported to `findings` and left out. Loops, parameters and subroutines are written as the
/// commands that they execute. Text after the end of the program is left out.
///
/// # Errors
///
/// Reading or writing fails.
pub fn write(
    source: &mut Source,
    file: &str,
    from: Dialect,
    form: &Form,
    findings: &mut Findings,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut work = Work {
        translator: Translator::new(from, form.dialect),
        made: Vec::new(),
    };
    blocks::each_block(
        source,
        from,
        &mut work,
        |work| Reading {
            modal: work.translator.modal(),
            results: Results::NONE,
        },
        |work, given, block| {
            let at = At {
                file: given.file.unwrap_or(file),
                line: given.number,
                bytes: given.bytes,
                block: given.at,
                length: given.text.len(),
                dialect: from,
            };
            if given.repeats {
                findings.report_once();
            }
            if blocks::is_grbl_command(given.text, &from) {
                findings.add(no_command(&at, form.dialect, "a command of Grbl itself"));
                return Ok(ControlFlow::Continue(()));
            }
            let mut is_end = false;
            work.made.clear();
            let made = &mut work.made;
            let done = match block {
                Ok(block) => {
                    is_end = blocks::ends_program(given.text);
                    let mut push = |piece: &[u8]| made.extend_from_slice(piece);
                    work.translator.line(given.text, &block, &mut push)
                }
                Err(error) => Err(Untranslated::Error(error)),
            };
            match done {
                Ok(_) => {}
                Err(Untranslated::Error(error)) => findings.add(explain::finding(&error, &at)),
                Err(Untranslated::Command(command)) => {
                    findings.add(no_command(
                        &at,
                        form.dialect,
                        &shown(&command, *from.axes()),
                    ));
                }
            }
            write_lines(&work.made, form, out)?;
            Ok(match is_end {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            })
        },
    )?;
    finish(work.translator, from, form, findings, out)
}

/// Writes the moves and codes that are added at the end of the program.
fn finish(
    mut translator: Translator<AXES>,
    from: Dialect,
    form: &Form,
    findings: &mut Findings,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut last = Vec::new();
    let done = translator.finish(&mut |piece: &[u8]| last.extend_from_slice(piece));
    if let Err(Untranslated::Command(command)) = done {
        let message = format!(
            "{} cannot do this: {}",
            form.dialect.name(),
            shown(&command, *from.axes())
        );
        findings.add(Finding::general(
            crate::diagnostics::Severity::Error,
            "E0650",
            message,
        ));
    }
    write_lines(&last, form, out)
}

fn shown(command: &Command<AXES>, axes: Axes) -> String {
    command.shown(axes).to_string()
}

fn write_lines(made: &[u8], form: &Form, out: &mut dyn Write) -> io::Result<()> {
    for line in made.split_inclusive(|&byte| byte == b'\n') {
        out.write_all(line.strip_suffix(b"\n").unwrap_or(line))?;
        out.write_all(form.line_end)?;
    }
    Ok(())
}

fn no_command(at: &At<'_>, to: Dialect, what: &str) -> Finding {
    let message = format!("{} cannot do this: {what}", to.name());
    Finding::error("E0650", message, at.whole()).label("left out")
}
