//! Lines from a stream of bytes, into a buffer of fixed size.

use core::fmt;

/// Collects the bytes of a line as they arrive from a port, at most `CAPACITY` of them.
///
/// A line ends with CR, LF or CR LF. It is returned, without its end, when the byte that ends it
/// arrives. Empty lines are returned, too, so that each line can be answered. A line that is too
/// long is refused at its end, and only that line: its tail is never taken for a line. NUL and form
/// feed before a line are skipped. Elsewhere they stay, and the parser refuses them.
///
/// # Examples
/// ```
/// use husillo_gcode::LineReader;
/// let mut reader = LineReader::<8>::new();
/// let mut seen = Vec::new();
/// for byte in *b"G0 X1\r\nG0 X100000\nM2" {
///     if let Some(line) = reader.push(byte) {
///         seen.push(line.map(|line| String::from_utf8_lossy(line).into_owned()));
///     }
/// }
/// assert_eq!(reader.finish().map(|line| line.map(<[u8]>::len)), Some(Ok(2)));
/// assert_eq!(seen[0].as_deref(), Ok("G0 X1"));
/// assert_eq!(seen[1].as_ref().map_err(|error| (error.at, error.end)), Err((8, 10)));
/// ```
#[derive(Clone, Debug)]
pub struct LineReader<const CAPACITY: usize> {
    bytes: [u8; CAPACITY],
    /// Length of the line, which may exceed the stored part.
    length: usize,
    /// The line was returned: the next byte starts another.
    over: bool,
    /// The last byte was a CR; a following LF belongs to it.
    carriage: bool,
}

/// A line longer than the buffer. `at..end` are the bytes that had no room, counted from 0.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LineTooLong {
    /// The first byte without room: the capacity of the buffer.
    pub at: usize,
    /// One past the last byte of the line.
    pub end: usize,
}

impl LineTooLong {
    /// The number of the message: 104 for E0104.
    pub const fn code(self) -> u16 {
        104
    }
}

impl fmt::Display for LineTooLong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line longer than the buffer of {} characters", self.at)
    }
}

impl core::error::Error for LineTooLong {}

/// The effect of a byte.
#[derive(Copy, Clone, Eq, PartialEq)]
enum Step {
    Kept,
    Ended,
}

impl<const CAPACITY: usize> LineReader<CAPACITY> {
    /// Creates an empty reader.
    pub const fn new() -> Self {
        LineReader {
            bytes: [0; CAPACITY],
            length: 0,
            over: false,
            carriage: false,
        }
    }

    /// Takes one byte. Returns the line that it ends, which stays in the buffer until the next
    /// byte.
    ///
    /// # Errors
    /// [`LineTooLong`] at the end of a line that is too long.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8], LineTooLong>> {
        match self.step(byte) {
            Step::Kept => None,
            Step::Ended => Some(self.line()),
        }
    }

    /// Takes bytes from the front of `bytes` until a line ends; `bytes` then starts at the first
    /// byte not taken. Returns `None` when all were taken. For buffers filled by DMA or USB; the
    /// boundaries of the buffers do not matter.
    ///
    /// # Errors
    /// As [`LineReader::push`].
    pub fn read(&mut self, bytes: &mut &[u8]) -> Option<Result<&[u8], LineTooLong>> {
        while let Some((&byte, rest)) = bytes.split_first() {
            *bytes = rest;
            if self.step(byte) == Step::Ended {
                return Some(self.line());
            }
        }
        None
    }

    /// Ends the input: returns a last line without a line end, if there is one. The reader is then
    /// ready for another input.
    ///
    /// # Errors
    /// As [`LineReader::push`].
    pub fn finish(&mut self) -> Option<Result<&[u8], LineTooLong>> {
        let rest = !self.over && self.length > 0;
        (self.over, self.carriage) = (true, false);
        if rest { Some(self.line()) } else { None }
    }

    #[inline]
    fn step(&mut self, byte: u8) -> Step {
        if self.over {
            (self.over, self.length) = (false, 0);
        }
        let carriage = core::mem::take(&mut self.carriage);
        match byte {
            b'\n' if carriage => Step::Kept,
            b'\r' | b'\n' => {
                (self.over, self.carriage) = (true, byte == b'\r');
                Step::Ended
            }
            0 | 0x0c if self.length == 0 => Step::Kept,
            _ => {
                if let Some(place) = self.bytes.get_mut(self.length) {
                    *place = byte;
                }
                self.length = self.length.saturating_add(1);
                Step::Kept
            }
        }
    }

    fn line(&self) -> Result<&[u8], LineTooLong> {
        self.bytes.get(..self.length).ok_or(LineTooLong {
            at: CAPACITY,
            end: self.length,
        })
    }
}

impl<const CAPACITY: usize> Default for LineReader<CAPACITY> {
    fn default() -> Self {
        LineReader::new()
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::{String, ToString};
    use std::vec::Vec;

    fn lines(text: &[u8]) -> Vec<Result<String, (usize, usize)>> {
        let mut reader = LineReader::<6>::new();
        let mut seen = Vec::new();
        let keep = |line: Result<&[u8], LineTooLong>| {
            line.map(|line| String::from_utf8_lossy(line).into_owned())
                .map_err(|error| (error.at, error.end))
        };
        for &byte in text {
            seen.extend(reader.push(byte).map(keep));
        }
        seen.extend(reader.finish().map(keep));
        assert_eq!(reader.finish(), None);
        seen
    }

    fn good(lines: &[&str]) -> Vec<Result<String, (usize, usize)>> {
        lines.iter().map(|line| Ok(line.to_string())).collect()
    }

    #[test]
    fn every_kind_of_line_end_ends_one_line() {
        assert_eq!(lines(b"a\nb\r\nc\rd"), good(&["a", "b", "c", "d"]));
        assert_eq!(lines(b"\r\n\r\n\n\r\r"), good(&["", "", "", "", ""]));
        assert_eq!(lines(b""), good(&[]));
        assert_eq!(lines(b"\0\0\x0ca\0b\n\0"), good(&["a\0b"]));
        assert_eq!(lines(b"%\nG0\n%"), good(&["%", "G0", "%"]));
    }

    #[test]
    fn the_tail_of_an_overlong_line_is_not_a_line() {
        let mut seen = good(&["123456"]);
        seen.extend([
            Err((6, 7)),
            Ok("G1 X1".into()),
            Err((6, 19)),
            Ok("M2".into()),
        ]);
        assert_eq!(
            lines(b"123456\n1234567\r\nG1 X1\nG1 X1 (G1 X2 G1 X3)\nM2"),
            seen
        );
        assert_eq!(
            LineTooLong { at: 6, end: 7 }.to_string(),
            "line longer than the buffer of 6 characters"
        );
    }
}
