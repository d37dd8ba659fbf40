//! Standard output and standard error, without control characters for the terminal.
//!
//! Names, cells, comments and answers of devices come from others. A control character in them is
//! shown as its JSON escape, so a line of JSON stays one line.

pub mod keys;
pub mod progress;
pub mod reporter;
pub mod sharing;
pub mod stop;
pub mod typed;

use husillo_simulator::text::shown::push;
use std::io::{self, IsTerminal, StderrLock, StdoutLock, Write};

pub use husillo_simulator::text::shown::{cut, is_obeyed, shown};

/// [`std::eprintln`] through [`message`]: every module of the program prints its messages with it.
macro_rules! eprintln {
    ($($part:tt)*) => {
        $crate::console::message(::std::format_args!($($part)*))
    };
}

/// A writer that escapes control characters and changes of the direction of text.
#[derive(Debug)]
pub struct Shown<W: Write> {
    out: W,
    /// The beginning of a character, or a CR that may belong to a line end.
    begun: Vec<u8>,
}

/// Standard output for text.
pub fn stdout() -> Shown<StdoutLock<'static>> {
    Shown::new(io::stdout().lock())
}

/// Standard output for commands that continue when it fails: a machine completes its work, and
/// files are still written.
pub fn lasting_stdout() -> Lasting<Shown<StdoutLock<'static>>> {
    Lasting {
        out: stdout(),
        lost: None,
    }
}

/// A writer that drops everything after its first error, and keeps the error.
#[derive(Debug)]
pub struct Lasting<W> {
    out: W,
    lost: Option<io::Error>,
}

impl<W: Write> Lasting<W> {
    fn keep(&mut self, result: io::Result<()>) {
        self.lost = self.lost.take().or(result.err());
    }

    /// Ends the output.
    ///
    /// # Errors
    ///
    /// The first error. A reader that has gone is none.
    pub fn end(mut self) -> io::Result<()> {
        let flushed = self.out.flush();
        self.keep(flushed);
        self.lost.map_or(Ok(()), of_stdout)
    }
}

impl<W: Write> Write for Lasting<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.lost.is_none() {
            let written = self.out.write_all(bytes);
            self.keep(written);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.lost.is_none() {
            let flushed = self.out.flush();
            self.keep(flushed);
        }
        Ok(())
    }
}

/// An error of standard output as a result. A reader that has gone is no error.
fn of_stdout(error: io::Error) -> io::Result<()> {
    match error.kind() {
        io::ErrorKind::BrokenPipe => Ok(()),
        kind => Err(io::Error::new(kind, format!("standard output: {error}"))),
    }
}

/// Writes what is still in the buffer of standard output.
///
/// # Errors
///
/// It cannot be written.
pub fn flush() -> io::Result<()> {
    io::stdout().flush().or_else(of_stdout)
}

/// Whether a stream is a terminal that shows colours and moves its cursor, and the user wants that.
pub fn is_smart(stream: &impl IsTerminal) -> bool {
    let is_dumb = std::env::var_os("TERM").is_some_and(|terminal| terminal == "dumb");
    stream.is_terminal() && !is_dumb
}

/// Whether text on a stream has colours.
pub fn is_coloured(stream: &impl IsTerminal) -> bool {
    // As https://no-color.org has it: an empty value does not count.
    let is_unwanted = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    is_smart(stream) && !is_unwanted
}

/// Standard error for text.
pub fn stderr() -> Shown<StderrLock<'static>> {
    Shown::new(io::stderr().lock())
}

/// Standard output for unchanged bytes. A terminal gets them as [`stdout`] shows them.
pub fn data() -> Box<dyn Write + Send> {
    let out = io::stdout();
    if out.is_terminal() {
        Box::new(Shown::new(out))
    } else {
        Box::new(out)
    }
}

/// Writes a message to standard error. Its lines are cut to a readable length.
pub fn message(text: std::fmt::Arguments<'_>) {
    let text = text.to_string();
    let lines = text.split('\n').map(|line| format!("{}\n", cut(line)));
    // Standard error itself has failed, so nothing can be reported.
    let _ = stderr().write_all(lines.collect::<String>().as_bytes());
}

impl<W: Write> Shown<W> {
    /// Writes to `out`.
    pub const fn new(out: W) -> Self {
        Self {
            out,
            begun: Vec::new(),
        }
    }

    /// Writes the complete characters of `begun`; at the end everything.
    fn pass(&mut self, is_end: bool) -> io::Result<()> {
        let bytes = std::mem::take(&mut self.begun);
        let mut rest = bytes.as_slice();
        let mut all = String::with_capacity(rest.len());
        while !rest.is_empty() {
            let (good, bad) = match std::str::from_utf8(rest) {
                Ok(text) => (text, None),
                Err(error) => {
                    let (good, _) = rest.split_at(error.valid_up_to());
                    (std::str::from_utf8(good).unwrap_or_default(), Some(error))
                }
            };
            let mut chars = good.chars().peekable();
            while let Some(one) = chars.next() {
                match (one, chars.peek()) {
                    ('\r', Some('\n')) => all.push('\r'),
                    ('\r', None) if bad.is_none() && !is_end => self.begun.push(b'\r'),
                    _ => push(&mut all, one),
                }
            }
            rest = &rest[good.len()..];
            match bad.map(|error| error.error_len()) {
                None => break,
                Some(None) if !is_end => {
                    self.begun.extend_from_slice(rest);
                    break;
                }
                Some(length) => {
                    all.push(char::REPLACEMENT_CHARACTER);
                    rest = &rest[length.unwrap_or(rest.len())..];
                }
            }
        }
        self.out.write_all(all.as_bytes())
    }
}

impl<W: Write> Write for Shown<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let is_plain = |byte: &u8| matches!(byte, b'\n' | b'\t' | b' '..=b'~');
        if self.begun.is_empty() && bytes.iter().all(is_plain) {
            self.out.write_all(bytes)?;
        } else {
            self.begun.extend_from_slice(bytes);
            self.pass(false)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl<W: Write> Drop for Shown<W> {
    fn drop(&mut self) {
        // An incomplete character at the end of the output: its loss cannot be reported.
        let _ = self.pass(true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// What comes out of pieces.
    fn written(pieces: &[&[u8]]) -> String {
        let mut out = Vec::new();
        let mut shown = Shown::new(&mut out);
        for piece in pieces {
            shown.write_all(piece).unwrap();
        }
        drop(shown);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn what_a_terminal_obeys_is_shown() {
        let text = "a\x1b[31mb\u{9b}c\x7fd\u{202e}e\u{2066}f\x07g\rh\r\ni\tj \u{b5}m\n";
        let expected =
            "a\\u001b[31mb\\u009bc\\u007fd\\u202ee\\u2066f\\u0007g\\u000dh\r\ni\tj \u{b5}m\n";
        assert_eq!(written(&[text.as_bytes()]), expected);
        assert_eq!(shown("x\x1by"), "x\\u001by");
    }

    #[test]
    fn bytes_that_are_no_text_are_replaced() {
        assert_eq!(
            written(&[b"a\x9b31mb\xff\xe2\x80"]),
            "a\u{fffd}31mb\u{fffd}\u{fffd}"
        );
    }

    #[test]
    fn an_escaped_string_of_json_is_the_same_string() {
        let name = "\u{9b}31m\u{202e}\x7f\u{b5}";
        let json = serde_json::to_string(name).unwrap();
        let back: String = serde_json::from_str(&written(&[json.as_bytes()])).unwrap();
        assert_eq!(back, name);
    }

    proptest! {
        /// Where writes end does not matter, and nothing that is obeyed gets through.
        #[test]
        fn pieces_make_the_same(
            bytes in prop::collection::vec(
                prop::sample::select(b"\x1b\r\n\x9b\xc2\xe2\x80\xaea[\x7f".to_vec()), 0..40),
            at in 0_usize..40,
        ) {
            let at = at.min(bytes.len());
            let whole = written(&[&bytes]);
            prop_assert_eq!(&whole, &written(&[&bytes[..at], &bytes[at..]]));
            let mut chars = whole.chars().peekable();
            while let Some(one) = chars.next() {
                let is_line_end = one == '\r' && chars.peek() == Some(&'\n');
                prop_assert!(is_line_end || !is_obeyed(one));
            }
        }
    }
}
