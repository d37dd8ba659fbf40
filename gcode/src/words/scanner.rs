//! The scanner of `words` and `tokens`: the text around words.

use crate::error::{Error, ErrorKind};
use crate::features::EXTENDED;
use crate::values::decimal::Decimal;
use crate::words::comment::comment_within;
use crate::words::numeral::{
    LINE_FEED, QUICK, WINDOW, alphabet, is_blank, number, short_number, window_at, window_number,
};
use crate::words::word::{Token, Word};
use core::ops::ControlFlow;

/// The text before this position in the line, as far as it matters for `/` and `%`.
#[derive(Copy, Clone, Eq, PartialEq, PartialOrd, Debug)]
pub(crate) enum Before {
    /// Nothing; the line has just begun.
    Nothing,
    /// Blanks and comments.
    Blanks,
    /// Only an `N` word.
    Number,
    /// A word or a `/`.
    Words,
    /// A `%`: only blanks and comments may follow.
    Percent,
    /// An error: the rest of the line is skipped.
    Fault,
}

/// The scanner of one line, or (`LINES`) of all lines of a text.
#[derive(Clone, Debug)]
pub(crate) struct Scanner<'a, const LINES: bool> {
    /// The text that was not read yet.
    rest: &'a [u8],
    /// The length of the whole text; with the rest it gives the position.
    length: usize,
    before: Before,
    pub(crate) deleted: bool,
}

/// Whether a byte begins a word: a letter, or with the extended codes a sign of polar coordinates.
pub(crate) const fn is_letter(byte: u8) -> bool {
    byte.is_ascii_alphabetic() || EXTENDED && matches!(byte, b'@' | b'^')
}

/// Whether a byte ends a line within a text.
pub(crate) const fn is_end(byte: u8) -> bool {
    matches!(byte, b'\r' | b'\n')
}

/// The position after the comment at the start of the text.
fn comment(text: &[u8], lines: bool) -> Result<usize, Error> {
    comment_within(text, lines).map_err(|end| Error {
        kind: ErrorKind::UnclosedComment,
        at: 0,
        end,
    })
}

/// The number after the letter at the start of the text, with the positions after it and after the
/// following text.
#[inline(always)]
fn any_number<const LINES: bool>(
    text: &[u8],
    letter: u8,
) -> Result<(Decimal, usize, usize), Error> {
    let short = if LINES || !QUICK {
        short_number(text, 1, LINES)
    } else {
        None // was tried
    };
    short.map_or_else(|| number(text, letter, LINES), Ok)
}

impl<'a, const LINES: bool> Scanner<'a, LINES> {
    #[inline]
    pub(crate) fn new(text: &'a [u8]) -> Self {
        Scanner {
            rest: text,
            length: text.len(),
            before: Before::Nothing,
            deleted: false,
        }
    }

    /// The position of the text that was not read yet.
    #[inline(always)]
    fn at(&self) -> usize {
        self.length.wrapping_sub(self.rest.len())
    }

    /// Skips bytes; there are at least as many.
    #[inline(always)]
    fn skip(&mut self, bytes: usize) {
        self.rest = self.rest.get(bytes..).unwrap_or_default();
    }

    #[inline(always)]
    pub(crate) fn next(&mut self) -> Option<Result<Token, Error>> {
        loop {
            if !(LINES || QUICK) {
                // Below.
            } else if let Some(window) = self.rest.first_chunk::<WINDOW>() {
                let byte = window_at(window, 0);
                if alphabet(byte) < 26 {
                    if let Some(number) = window_number(window, LINES) {
                        if let Some(word) = self.take(byte, number) {
                            return Some(Ok(Token::Word(word)));
                        }
                    }
                } else if LINES && byte == LINE_FEED {
                    self.skip(1);
                    self.end_line();
                    return Some(Ok(Token::EndOfLine));
                }
            }
            if !LINES && QUICK {
                // Half the words of a single line are too close to its end.
                let byte = u32::from(*self.rest.first()?);
                if alphabet(byte) < 26 {
                    if let Some(number) = short_number(self.rest, 1, LINES) {
                        if let Some(word) = self.take(byte, number) {
                            return Some(Ok(Token::Word(word)));
                        }
                    }
                }
            }
            if let ControlFlow::Break(found) = self.other() {
                return found;
            }
        }
    }

    /// The word of a letter and a number, with the positions after it and after the following text,
    /// unless a word is not permitted here.
    #[inline(always)]
    fn take(&mut self, letter: u32, (value, end, next): (Decimal, usize, usize)) -> Option<Word> {
        let letter = (letter & !0x20) as u8;
        if self.before != Before::Words && !self.enter(letter) {
            return None;
        }
        let at = self.at();
        self.skip(next);
        Some(Word {
            letter,
            value,
            at,
            end: at.wrapping_add(end),
        })
    }

    /// Begins the first word of a line, or the one after its `N` word; false after a `%` or an
    /// error.
    #[inline(always)]
    fn enter(&mut self, letter: u8) -> bool {
        if self.before >= Before::Percent {
            return false;
        }
        if self.before == Before::Nothing {
            self.deleted = false;
        }
        self.before = if letter == b'N' && self.before < Before::Number {
            Before::Number
        } else {
            Before::Words
        };
        true
    }

    /// Begins the next line. Whether the last one is deleted is known until the first word of the
    /// new line.
    #[inline(always)]
    fn end_line(&mut self) {
        if self.before == Before::Nothing {
            self.deleted = false;
        }
        self.before = Before::Nothing;
    }

    /// Skips text that is not an ordinary word, or returns what it is.
    #[inline(never)]
    fn other(&mut self) -> ControlFlow<Option<Result<Token, Error>>> {
        let (at, rest) = (self.at(), self.rest);
        let Some(&byte) = rest.first() else {
            if LINES && self.before != Before::Nothing {
                self.before = Before::Nothing;
                return ControlFlow::Break(Some(Ok(Token::EndOfLine)));
            }
            return ControlFlow::Break(None);
        };
        if LINES && is_end(byte) {
            let both = byte == b'\r' && rest.get(1) == Some(&b'\n');
            self.skip(if both { 2 } else { 1 });
            self.end_line();
            return ControlFlow::Break(Some(Ok(Token::EndOfLine)));
        }
        if self.before == Before::Nothing {
            self.before = Before::Blanks;
            self.deleted = false;
        }
        let fault = match byte {
            _ if byte == b';' || self.before == Before::Fault => {
                self.skip_line();
                return ControlFlow::Continue(());
            }
            _ if is_blank(byte, LINES) => {
                self.skip(1);
                return ControlFlow::Continue(());
            }
            b'(' => match comment(rest, LINES) {
                Ok(behind) => {
                    self.skip(behind);
                    return ControlFlow::Continue(());
                }
                Err(error) => error,
            },
            b'/' if self.before == Before::Blanks => {
                (self.before, self.deleted) = (Before::Words, true);
                self.skip(1);
                return ControlFlow::Continue(());
            }
            b'%' if self.before < Before::Words => {
                self.before = Before::Percent;
                self.skip(1);
                return ControlFlow::Continue(());
            }
            _ if is_letter(byte) && self.before < Before::Percent => {
                let letter = byte.to_ascii_uppercase();
                match any_number::<LINES>(rest, letter) {
                    Ok((value, end, next)) => {
                        self.enter(letter);
                        self.skip(next);
                        let end = at.wrapping_add(end);
                        return ControlFlow::Break(Some(Ok(Token::Word(Word {
                            letter,
                            value,
                            at,
                            end,
                        }))));
                    }
                    Err(error) => error,
                }
            }
            _ => Error {
                kind: match byte {
                    b'#' | b'[' => ErrorKind::Expression,
                    _ => ErrorKind::NotALetter(byte),
                },
                at: 0,
                end: 1,
            },
        };
        self.before = Before::Fault;
        self.skip(1);
        ControlFlow::Break(Some(Err(Error {
            kind: fault.kind,
            at: at.wrapping_add(fault.at),
            end: at.wrapping_add(fault.end),
        })))
    }

    /// Skips the rest of this line.
    fn skip_line(&mut self) {
        let left = if LINES {
            self.rest.iter().position(|&byte| is_end(byte))
        } else {
            None
        };
        self.skip(left.unwrap_or(self.rest.len()));
    }
}
