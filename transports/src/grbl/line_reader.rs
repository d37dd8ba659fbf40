//! Assembly of lines.

use crate::buffer::Buffer;
use crate::grbl::LINE_CHARACTERS;

/// A complete line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line<'a> {
    /// Its characters: upper case, without blanks, control bytes, `/` and comments. A blank line is
    /// empty. It is answered, too.
    Text(&'a [u8]),
    /// The line has more than [`LINE_CHARACTERS`] characters.
    TooLong,
}

/// Assembles bytes into lines.
///
/// # Examples
///
/// ```
/// use husillo_transports::grbl::{Line, LineReader};
///
/// let mut reader = LineReader::new();
/// let text = b"g1 x1 (to the left) ;end";
/// assert!(text.iter().all(|byte| reader.push(*byte).is_none()));
/// assert_eq!(reader.push(b'\n'), Some(Line::Text(b"G1X1")));
/// ```
#[derive(Clone, Debug)]
pub struct LineReader {
    text: Buffer<LINE_CHARACTERS>,
    comment: Comment,
    is_too_long: bool,
    /// Whether the line was returned. The next byte then begins another line.
    is_complete: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Comment {
    None,
    /// In a comment that ends with `)`.
    Bracket,
    /// In a comment that ends with the line.
    Rest,
}

impl Default for LineReader {
    fn default() -> Self {
        Self::new()
    }
}

impl LineReader {
    /// Creates a reader at the start of a line.
    pub const fn new() -> Self {
        LineReader {
            text: Buffer::new(),
            comment: Comment::None,
            is_too_long: false,
            is_complete: false,
        }
    }

    /// Drops an incomplete line.
    pub fn clear(&mut self) {
        *self = LineReader::new();
    }

    /// Takes a byte. Returns the line that this byte completes.
    pub fn push(&mut self, byte: u8) -> Option<Line<'_>> {
        if self.is_complete {
            self.clear();
        }
        if matches!(byte, b'\r' | b'\n') {
            self.is_complete = true;
            return Some(if self.is_too_long {
                Line::TooLong
            } else {
                Line::Text(self.text.bytes())
            });
        }
        match (self.comment, byte) {
            (Comment::Bracket, b')') => self.comment = Comment::None,
            (Comment::None, b'(') => self.comment = Comment::Bracket,
            (Comment::None, b';') => self.comment = Comment::Rest,
            (Comment::None, 0..=b' ' | b'/') | (Comment::Bracket | Comment::Rest, _) => {}
            (Comment::None, _) if self.text.bytes().len() >= LINE_CHARACTERS => {
                self.is_too_long = true;
            }
            (Comment::None, byte) => self.text.push(byte.to_ascii_uppercase()),
        }
        None
    }
}
