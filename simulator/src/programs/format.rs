//! `husillo format`: rewrites a program in a uniform form, one line at a time.

use crate::diagnostics::{Finding, Findings};
use crate::input::BYTE_ORDER_MARK;
use crate::programs::blocks;
use crate::programs::explain::{self, At};
use crate::programs::source::{LONGEST_LINE, read_line};
use husillo_gcode::{Dialect, Error, Receiver, formatted};
use std::io::{self, BufRead, Write};

/// The form of the lines.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The language of the program.
    pub dialect: Dialect,
    /// The line end: LF or CR LF.
    pub line_end: &'static [u8],
}

/// Writes the program of `reader` to `out` in the uniform form. Lines with errors are reported to
/// `findings` and stay unchanged. Returns whether anything changed.
///
/// A byte order mark stays. Memory does not grow with the program. A line longer than
/// [`LONGEST_LINE`] is copied unchanged. Every line gets a line end, also the last one. Any text
/// may follow the end of a program (M2, M30); it is no error there.
///
/// # Errors
///
/// Reading or writing fails.
pub fn write(
    reader: &mut dyn BufRead,
    file: &str,
    form: &Form,
    findings: &mut Findings,
    out: &mut dyn Write,
) -> io::Result<bool> {
    let (mut text, mut made) = (Vec::new(), Vec::new());
    let (mut changed, mut is_over) = (false, false);
    let mut receiver = form.dialect.framing().map(Receiver::new);
    for number in 1.. {
        text.clear();
        let end = read_line(reader, &mut text)?;
        if number == 1 && text.starts_with(BYTE_ORDER_MARK) {
            text.drain(..BYTE_ORDER_MARK.len());
            out.write_all(BYTE_ORDER_MARK)?;
        }
        if text.is_empty() && end == Some(b"") {
            break;
        }
        let text = &text[..];
        let Some(end) = end else {
            let at = at(file, number, text, form.dialect);
            let place = at.place(LONGEST_LINE - 1..LONGEST_LINE);
            let message = format!("line longer than {LONGEST_LINE} characters");
            findings.add(Finding::error("E0104", message, place).label("the line stays unchanged"));
            out.write_all(text)?;
            changed |= copy_rest(reader, out)?;
            continue;
        };
        made.clear();
        let formed = match &mut receiver {
            None if blocks::is_grbl_command(text, &form.dialect) => {
                made.extend_from_slice(text);
                Ok(())
            }
            None => match blocks::before_percent(text) {
                Some(before) => formed(before, &form.dialect, &mut made).map(|()| made.push(b'%')),
                None => formed(text, &form.dialect, &mut made),
            },
            Some(receiver) => blocks::unframed(receiver, text).and_then(|inside| {
                if blocks::is_numbering(inside) {
                    // M110 is for the receiver, not for the machine.
                    made.extend_from_slice(text);
                    return Ok(());
                }
                formed(inside, &form.dialect, &mut made)?;
                if inside.len() < text.len() {
                    let sum = made.iter().fold(0, |sum, byte| sum ^ byte);
                    made.extend_from_slice(format!("*{sum}").as_bytes());
                    made.extend_from_slice(comment_of(text));
                }
                Ok(())
            }),
        };
        match formed {
            Ok(()) => is_over |= made.contains(&b'M') && blocks::ends_program(&made),
            Err(error) => {
                if !is_over {
                    let at = at(file, number, text, form.dialect);
                    findings.add(explain::finding(&error, &at));
                }
                made.clear();
                made.extend_from_slice(text);
            }
        }
        if made.len() > LONGEST_LINE {
            // `husillo` could not read a longer line.
            made.clear();
            made.extend_from_slice(text);
        }
        changed |= made != text || end != form.line_end;
        made.extend_from_slice(form.line_end);
        out.write_all(&made)?;
    }
    Ok(changed)
}

/// Writes a block in the uniform form to `made`.
fn formed(text: &[u8], dialect: &Dialect, made: &mut Vec<u8>) -> Result<(), Error> {
    formatted(text, dialect)?.for_each(|piece| made.extend_from_slice(piece));
    Ok(())
}

/// The comment after the checksum of a line, with the blanks before it.
fn comment_of(line: &[u8]) -> &[u8] {
    let star = line.iter().rposition(|&byte| byte == b'*').unwrap_or(0);
    let behind = line.get(star + 1..).unwrap_or_default();
    let digits = |byte: &u8| byte.is_ascii_digit() || byte.is_ascii_whitespace();
    let start = behind.iter().position(|byte| !digits(byte));
    start.map_or(b"", |start| behind.get(start..).unwrap_or_default())
}

/// Copies the rest of a line with its end. Returns whether it had to add a line end.
fn copy_rest(reader: &mut dyn BufRead, out: &mut dyn Write) -> io::Result<bool> {
    let mut part = Vec::new();
    loop {
        part.clear();
        let end = read_line(reader, &mut part)?;
        out.write_all(&part)?;
        match end {
            None => {}
            Some(b"") => {
                out.write_all(b"\n")?;
                return Ok(true);
            }
            Some(end) => {
                out.write_all(end)?;
                return Ok(false);
            }
        }
    }
}

fn at<'a>(file: &'a str, line: usize, bytes: &'a [u8], dialect: Dialect) -> At<'a> {
    At {
        file,
        line,
        bytes,
        block: 0,
        length: bytes.len(),
        dialect,
    }
}
