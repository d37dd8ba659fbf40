//! Reads a program line by line. Memory does not grow with the program.

use crate::input;
use crate::input::BYTE_ORDER_MARK;
use crate::programs::library::Subroutines;
use crate::programs::watch::Watch;
use std::io::{self, BufRead};

/// Longest line that is read, bytes. The rest of a longer line is skipped.
pub const LONGEST_LINE: usize = 64 * 1024;

/// Appends the rest of a line to `line` and returns the line end: CR, LF or CR LF, or nothing at
/// the end of the input. Returns `None` if `line` reaches [`LONGEST_LINE`] bytes before the line
/// ends.
///
/// # Errors
///
/// Reading fails.
pub fn read_line(
    reader: &mut dyn BufRead,
    line: &mut Vec<u8>,
) -> io::Result<Option<&'static [u8]>> {
    loop {
        let buffer = fill(reader)?;
        let room = LONGEST_LINE - line.len().min(LONGEST_LINE);
        let seen = &buffer[..buffer.len().min(room + 1)];
        if seen.is_empty() {
            return Ok(Some(b""));
        }
        let end = seen.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let length = end.unwrap_or(seen.len()).min(room);
        line.extend_from_slice(&seen[..length]);
        let Some(end) = end else {
            let is_full = seen.len() > room;
            reader.consume(length);
            if is_full {
                return Ok(None);
            }
            continue;
        };
        let is_feed = seen[end] == b'\n';
        reader.consume(end + 1);
        if is_feed {
            return Ok(Some(b"\n"));
        }
        if fill(reader)?.first() != Some(&b'\n') {
            return Ok(Some(b"\r"));
        }
        reader.consume(1);
        return Ok(Some(b"\r\n"));
    }
}

/// The buffered bytes of the reader; none at the end.
fn fill(reader: &mut dyn BufRead) -> io::Result<&[u8]> {
    while let Err(error) = reader.fill_buf() {
        if error.kind() != io::ErrorKind::Interrupted {
            return Err(error);
        }
    }
    reader.fill_buf()
}

/// Reads a program.
pub struct Source {
    reader: Box<dyn BufRead>,
    buffer: Vec<u8>,
    number: usize,
    subroutines: Subroutines,
    watch: Watch,
}

/// One line without its line end.
#[derive(Debug)]
pub struct Line<'a> {
    /// Number in the file, from 1.
    pub number: usize,
    /// The bytes, at most [`LONGEST_LINE`].
    pub bytes: &'a [u8],
    /// Whether the line is longer.
    pub overlong: bool,
}

impl std::fmt::Debug for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Source")
            .field("number", &self.number)
            .finish_non_exhaustive()
    }
}

/// Checks that a program is no text in UTF-16.
///
/// # Errors
///
/// It is, or reading fails.
pub fn expect_text(reader: &mut dyn BufRead) -> io::Result<()> {
    input::expect_bytes_of_text(fill(reader)?)
}

impl Source {
    /// Reads from any reader.
    pub fn from_reader(reader: Box<dyn BufRead>) -> Self {
        Self {
            reader,
            buffer: Vec::new(),
            number: 0,
            subroutines: Subroutines::default(),
            watch: Watch::default(),
        }
    }

    /// Sets where the files of its subroutines are.
    pub fn with_subroutines(mut self, subroutines: Subroutines) -> Self {
        self.subroutines = subroutines;
        self
    }

    /// Returns where the files of its subroutines are, once.
    pub fn take_subroutines(&mut self) -> Subroutines {
        std::mem::take(&mut self.subroutines)
    }

    /// Sets what is called while the program is read.
    pub fn with_watch(mut self, watch: Watch) -> Self {
        self.watch = watch;
        self
    }

    /// Returns what is called while the program is read, once.
    pub fn take_watch(&mut self) -> Watch {
        std::mem::take(&mut self.watch)
    }

    /// Sets the number of lines that were read elsewhere before.
    pub const fn after(mut self, lines: usize) -> Self {
        self.number = lines;
        self
    }

    /// Returns the next line, or `None` at the end of the file. CR, LF and CR LF end a line. The
    /// last line needs no end.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn next_line(&mut self) -> io::Result<Option<Line<'_>>> {
        self.buffer.clear();
        let mut end = read_line(&mut *self.reader, &mut self.buffer)?;
        if self.buffer.is_empty() && end == Some(b"") {
            return Ok(None);
        }
        self.number += 1;
        if self.number == 1 && self.buffer.starts_with(BYTE_ORDER_MARK) {
            self.buffer.drain(..BYTE_ORDER_MARK.len());
        }
        let overlong = end.is_none();
        let mut skipped = Vec::new();
        while end.is_none() {
            skipped.clear();
            end = read_line(&mut *self.reader, &mut skipped)?;
        }
        Ok(Some(Line {
            number: self.number,
            bytes: &self.buffer,
            overlong,
        }))
    }
}

impl Source {
    /// The text from the last returned line to the end.
    ///
    /// # Errors
    ///
    /// The file cannot be read.
    pub fn rest(&mut self) -> io::Result<Vec<u8>> {
        let mut text = std::mem::take(&mut self.buffer);
        text.push(b'\n');
        let mut rest = input::to_end(input::bounded(&mut self.reader))?;
        text.append(&mut rest);
        Ok(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    fn lines(bytes: &'static [u8]) -> Vec<(usize, usize, bool)> {
        let mut source = Source::from_reader(Box::new(bytes));
        let mut lines = Vec::new();
        while let Some(line) = source.next_line().unwrap() {
            lines.push((line.number, line.bytes.len(), line.overlong));
        }
        lines
    }

    #[test]
    fn all_line_ends_are_recognized() {
        assert_eq!(
            lines(b"G1\r\n%\n\nM2"),
            [(1, 2, false), (2, 1, false), (3, 0, false), (4, 2, false)]
        );
        assert_eq!(lines(b""), []);
        assert_eq!(
            lines(b"G0 X1\rY2\r\n\n\rZ3\r"),
            [
                (1, 5, false),
                (2, 2, false),
                (3, 0, false),
                (4, 0, false),
                (5, 2, false)
            ]
        );
    }

    #[test]
    fn the_buffer_size_does_not_matter() {
        let text: &'static [u8] = b"G1\r\n\rG2\n\r\n\nG3";
        for size in 1..8 {
            let reader = BufReader::with_capacity(size, text);
            let mut source = Source::from_reader(Box::new(reader));
            let mut found = Vec::new();
            while let Some(line) = source.next_line().unwrap() {
                found.push(line.bytes.to_vec());
            }
            let expected: [&[u8]; 6] = [b"G1", b"", b"G2", b"", b"", b"G3"];
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn the_rest_begins_with_the_last_returned_line() {
        let mut source = Source::from_reader(Box::new(&b"G1\r\nG2\r\nG3"[..]));
        assert_eq!(source.next_line().unwrap().unwrap().number, 1);
        assert_eq!(source.next_line().unwrap().unwrap().number, 2);
        assert_eq!(source.rest().unwrap(), b"G2\nG3");
    }

    #[test]
    fn a_line_that_is_too_long_is_cut_and_the_next_one_is_whole() {
        let text: &'static [u8] =
            Box::leak(([vec![b'x'; 200_000], b"\nG1\n".to_vec()].concat()).into_boxed_slice());
        assert_eq!(lines(text), [(1, LONGEST_LINE, true), (2, 2, false)]);
        let text: &'static [u8] =
            Box::leak(([vec![b'x'; LONGEST_LINE], b"\rG1\n".to_vec()].concat()).into_boxed_slice());
        assert_eq!(lines(text), [(1, LONGEST_LINE, false), (2, 2, false)]);
    }
}
