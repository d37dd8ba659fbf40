//! A position in a line, and the parts that can be read without knowing any value.

use super::table::Capitals;
use crate::error::parameters::Fault;
use crate::error::{Error, ErrorKind};
use crate::words::comment::comment_length;

/// Moves over the bytes of a line; blanks are ignored.
#[derive(Debug)]
pub(super) struct Cursor<'t> {
    text: &'t [u8],
    at: usize,
    /// Position after the last byte taken that is not a blank.
    end: usize,
}

const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n')
}

impl<'t> Cursor<'t> {
    /// Starts reading `text` at `at`.
    pub(super) const fn new(text: &'t [u8], at: usize) -> Self {
        Cursor { text, at, end: at }
    }

    /// The next byte that is not a blank, as a capital.
    pub(super) fn peek(&mut self) -> Option<u8> {
        loop {
            let byte = self.text.get(self.at).copied()?;
            if !is_blank(byte) {
                return Some(byte.to_ascii_uppercase());
            }
            self.at = self.at.wrapping_add(1);
        }
    }

    /// Takes the byte that was peeked; the position stays at most the length.
    pub(super) fn advance(&mut self) {
        self.at = self.at.wrapping_add(1).min(self.text.len());
        self.end = self.at;
    }

    /// Takes this byte if it is the next one.
    pub(super) fn take(&mut self, byte: u8) -> bool {
        let is_next = self.peek() == Some(byte);
        if is_next {
            self.advance();
        }
        is_next
    }

    /// Position of the next byte; [`Cursor::peek`] skips blanks before it.
    pub(super) const fn at(&self) -> usize {
        self.at
    }

    /// Position after the last byte taken.
    pub(super) const fn end(&self) -> usize {
        self.end
    }

    /// An error about the bytes taken from `at` on.
    pub(super) const fn error(&self, fault: Fault, at: usize) -> Error {
        Error {
            kind: ErrorKind::Program(fault),
            at,
            end: self.end,
        }
    }

    /// An error about the next byte, or the end of the text.
    pub(super) fn error_here(&mut self, fault: Fault) -> Error {
        self.peek();
        let at = self.at.min(self.text.len());
        Error {
            kind: ErrorKind::Program(fault),
            at,
            end: at.wrapping_add(1).min(self.text.len()),
        }
    }

    /// Moves behind the comments that come next, as in `o1 (hole) call`. They are not taken.
    pub(super) fn pass_comments(&mut self) -> Result<(), Error> {
        let end = self.end;
        while self.peek() == Some(b'(') {
            self.pass_comment()?;
        }
        self.end = end;
        Ok(())
    }

    /// Skips the comment that comes next.
    pub(super) fn pass_comment(&mut self) -> Result<(), Error> {
        let rest = self.text.get(self.at..).unwrap_or_default();
        let length = comment_length(rest).ok_or(Error {
            kind: ErrorKind::UnclosedComment,
            at: self.at,
            end: self.text.len(),
        })?;
        self.at = self.at.wrapping_add(length); // inside the line
        self.end = self.at;
        Ok(())
    }

    /// The letters that come next.
    pub(super) fn letters(&mut self) -> Capitals {
        let mut letters = Capitals::default();
        while let Some(byte) = self.peek().filter(u8::is_ascii_uppercase) {
            letters.push(byte);
            self.advance();
        }
        letters
    }

    /// The name between the `<` that comes next and `>`. `from` is the start of an error.
    pub(super) fn name(&mut self, from: usize) -> Result<&'t [u8], Error> {
        self.advance();
        let start = self.at;
        let rest = self.text.get(start..).unwrap_or_default();
        let length = (0..rest.len()).zip(rest).find(|&(_, &byte)| byte == b'>');
        let Some((length, _)) = length else {
            self.at = self.text.len();
            self.end = self.at;
            return Err(self.error(Fault::MalformedName, from));
        };
        self.at = start.wrapping_add(length);
        self.advance();
        let name = rest.get(..length).unwrap_or_default();
        if name.iter().all(|&byte| is_blank(byte)) {
            return Err(self.error(Fault::MalformedName, from));
        }
        Ok(name)
    }
}
