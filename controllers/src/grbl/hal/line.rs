//! Raw lines: `$` commands keep their case and blanks.

use super::LINE;

/// A line as it was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum RawLine<'a> {
    Text(&'a [u8]),
    /// It has more than 255 characters, comments included.
    TooLong,
}

/// Assembles bytes into lines. A line ends with CR, LF, or CR LF.
#[derive(Clone, Debug)]
pub(in super::super) struct RawReader {
    text: [u8; LINE],
    length: usize,
    is_too_long: bool,
    is_complete: bool,
    /// The last byte was CR, so that an LF ends no further line.
    is_after_cr: bool,
}

impl RawReader {
    pub(in super::super) const fn new() -> Self {
        RawReader {
            text: [0; LINE],
            length: 0,
            is_too_long: false,
            is_complete: false,
            is_after_cr: false,
        }
    }

    pub(in super::super) const fn clear(&mut self) {
        self.length = 0;
        self.is_too_long = false;
        self.is_complete = false;
    }

    /// Takes a byte. Returns the line that this byte completes.
    pub(in super::super) fn push(&mut self, byte: u8) -> Option<RawLine<'_>> {
        if self.is_complete {
            self.clear();
        }
        let was_cr = core::mem::replace(&mut self.is_after_cr, byte == b'\r');
        match byte {
            b'\n' if was_cr => None,
            b'\r' | b'\n' => {
                self.is_complete = true;
                Some(match self.text.get(..self.length) {
                    Some(text) if !self.is_too_long => RawLine::Text(text),
                    _ => RawLine::TooLong,
                })
            }
            0..b' ' => None,
            byte => {
                match self.text.get_mut(self.length) {
                    Some(slot) => {
                        *slot = byte;
                        self.length = self.length.wrapping_add(1); // it was below 255
                    }
                    None => self.is_too_long = true,
                }
                None
            }
        }
    }
}

/// Returns the characters of a block: upper case, without blanks and comments. The result has the
/// length of the second value.
pub(super) fn block_of(raw: &[u8]) -> ([u8; LINE], usize) {
    let (mut text, mut length) = ([0; LINE], 0_usize);
    let mut is_comment = false;
    for byte in raw {
        match byte {
            b';' if !is_comment => break,
            b'(' => is_comment = true,
            b')' if is_comment => is_comment = false,
            b' ' => {}
            _ if is_comment => {}
            byte => {
                if let Some(slot) = text.get_mut(length) {
                    *slot = byte.to_ascii_uppercase();
                    length = length.wrapping_add(1); // it was below 255
                }
            }
        }
    }
    (text, length)
}

/// Returns the text of a comment `(MSG,text)`.
pub(super) fn message_of(raw: &[u8]) -> Option<&[u8]> {
    let at = raw.windows(5).position(|part| {
        part.split_first()
            .is_some_and(|(first, rest)| *first == b'(' && rest.eq_ignore_ascii_case(b"MSG,"))
    })?;
    let text = raw.get(at.wrapping_add(5)..)?; // there are 5 bytes from `at` on
    let end = text.iter().position(|byte| *byte == b')');
    text.get(..end.unwrap_or(text.len()))
}
