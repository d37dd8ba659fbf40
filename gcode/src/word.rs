//! Words: a letter and a number, with their place in the line.

use crate::decimal::Decimal;
use crate::error::{Error, ErrorKind};

/// A letter and its number. `at..end` are the bytes of the line, 0-based, from the letter to the last digit.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct Word {
    /// Upper-case letter.
    pub letter: u8,
    /// The number, exactly.
    pub value: Decimal,
    /// Column of the letter.
    pub at: usize,
    /// Column behind the number.
    pub end: usize,
}

/// The words of one line, in order. Blanks are ignored everywhere, also inside words; comments `( )` and `;` are
/// skipped; a `/` before everything else marks a deleted block; a `%` alone (or behind `N`) is an empty line. Ends after the first error.
///
/// ```
/// let line = husillo_gcode::words(b"g1 x - 1 . 5 (cut)");
/// let words: Result<Vec<_>, _> = line.map(|word| word.map(|w| (w.letter, w.value.to_string()))).collect();
/// assert_eq!(words?, [(b'G', "1".into()), (b'X', "-1.5".into())]);
/// # Ok::<(), husillo_gcode::Error>(())
/// ```
pub fn words(line: &[u8]) -> Words<'_> {
    Words {
        line,
        at: 0,
        start: true,
        numbered: false,
        percent: false,
        deleted: false,
    }
}

/// Iterator over the words of a line; see [`words`].
#[derive(Clone, Debug)]
pub struct Words<'a> {
    line: &'a [u8],
    at: usize,
    /// Nothing but blanks and comments was read so far.
    start: bool,
    /// Only an `N` word was read so far.
    numbered: bool,
    /// A `%` was read: nothing but blanks and comments may follow.
    percent: bool,
    deleted: bool,
}

const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n')
}

impl Words<'_> {
    /// Whether a `/` (block delete) stood before the first word; known once the first word was asked for.
    pub const fn is_deleted(&self) -> bool {
        self.deleted
    }

    fn peek(&self) -> Option<u8> {
        self.line.get(self.at).copied()
    }

    /// One byte on; the position stays below the slice length, so it cannot wrap.
    fn advance(&mut self) {
        self.at = self.at.wrapping_add(1);
    }

    fn fail(&mut self, kind: ErrorKind, at: usize, end: usize) -> Option<Result<Word, Error>> {
        self.at = self.line.len();
        Some(Err(Error { kind, at, end }))
    }

    /// Passes a comment that starts here. On an error gives its kind and place.
    fn comment(&mut self) -> Result<(), Error> {
        let start = self.at;
        self.advance();
        while let Some(byte) = self.peek() {
            let here = self.at;
            self.advance();
            match byte {
                b')' => return Ok(()),
                b'(' => {
                    return Err(Error {
                        kind: ErrorKind::NestedComment,
                        at: here,
                        end: self.at,
                    });
                }
                _ => {}
            }
        }
        Err(Error {
            kind: ErrorKind::UnclosedComment,
            at: start,
            end: self.line.len(),
        })
    }

    /// The number behind a letter: `[+-] digits [. digits]` with at least one digit, blanks anywhere.
    fn number(&mut self, letter: u8, letter_at: usize) -> Result<(Decimal, usize), Error> {
        let mut value = Decimal::default();
        let mut end = self.at;
        let first = loop {
            match self.peek() {
                Some(byte) if is_blank(byte) => self.advance(),
                _ => break self.at,
            }
        };
        let (mut negative, mut signed, mut point, mut digits) = (false, false, false, false);
        while let Some(byte) = self.peek() {
            let here = self.at;
            let fault = match byte {
                b'0'..=b'9' => {
                    digits = true;
                    let digit = byte.wrapping_sub(b'0');
                    if point {
                        value.push_place(digit)
                    } else {
                        value.push_whole(digit)
                    }
                }
                b'.' if !point => {
                    point = true;
                    Ok(())
                }
                b'+' | b'-' if !(signed || point || digits) => {
                    signed = true;
                    negative = byte == b'-';
                    Ok(())
                }
                b'.' | b'+' | b'-' => Err(ErrorKind::MalformedNumber),
                b',' if !point => Err(ErrorKind::DecimalComma),
                b'#' | b'[' if !digits => Err(ErrorKind::Expression),
                _ if is_blank(byte) => {
                    self.advance();
                    continue;
                }
                _ => break,
            };
            self.advance();
            end = self.at;
            if let Err(kind) = fault {
                // The rest of what looks like this number belongs to the error.
                while matches!(self.peek(), Some(b'0'..=b'9' | b'.')) {
                    self.advance();
                }
                let from = match kind {
                    ErrorKind::NumberTooLarge | ErrorKind::TooManyDigits => first,
                    _ => here,
                };
                return Err(Error {
                    kind,
                    at: from,
                    end: self.at,
                });
            }
        }
        if !digits {
            return Err(Error {
                kind: ErrorKind::MissingNumber(letter),
                at: letter_at,
                end,
            });
        }
        Ok((if negative { value.negated() } else { value }, end))
    }
}

impl Iterator for Words<'_> {
    type Item = Result<Word, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let byte = self.peek()?;
            let at = self.at;
            match byte {
                _ if is_blank(byte) => self.advance(),
                b'(' => {
                    if let Err(error) = self.comment() {
                        return self.fail(error.kind, error.at, error.end);
                    }
                }
                b';' => {
                    self.at = self.line.len();
                    return None;
                }
                b'/' if self.start => {
                    self.start = false;
                    self.deleted = true;
                    self.advance();
                }
                b'%' if self.start || self.numbered => {
                    (self.start, self.numbered, self.percent) = (false, false, true);
                    self.advance();
                }
                _ if byte.is_ascii_alphabetic() && !self.percent => {
                    self.advance();
                    let letter = byte.to_ascii_uppercase();
                    self.numbered = self.start && letter == b'N';
                    self.start = false;
                    return match self.number(letter, at) {
                        Ok((value, end)) => Some(Ok(Word {
                            letter,
                            value,
                            at,
                            end,
                        })),
                        Err(error) => self.fail(error.kind, error.at, error.end),
                    };
                }
                b'#' | b'[' => return self.fail(ErrorKind::Expression, at, at.wrapping_add(1)),
                _ => return self.fail(ErrorKind::NotALetter(byte), at, at.wrapping_add(1)),
            }
        }
    }
}

impl core::iter::FusedIterator for Words<'_> {}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::{String, ToString};
    use std::vec::Vec;

    fn show(line: &str) -> Result<String, (u16, usize, usize)> {
        let words: Result<Vec<Word>, Error> = words(line.as_bytes()).collect();
        let words = words.map_err(|e| (e.kind.code(), e.at, e.end))?;
        let text: Vec<_> = words
            .iter()
            .map(|w| char::from(w.letter).to_string() + &w.value.to_string())
            .collect();
        Ok(text.join(" "))
    }

    #[test]
    fn reads_words() {
        assert_eq!(
            show("N10 g01x1.50Y-.5 (a;b) F+ 1 0 ; rest ("),
            Ok("N10 G1 X1.50 Y-0.5 F10".into())
        );
        assert_eq!(show("% \r\n"), Ok(String::new()));
        assert_eq!(show("N28 %"), Ok("N28".into()));
        assert_eq!(show("/ G0 X1."), Ok("G0 X1".into()));
        assert_eq!(show("(\u{e9})G1"), Ok("G1".into()));
        assert_eq!(
            show("X1.000000000000000000000000000000000"),
            Ok("X1.000000000000000000".into())
        );
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        assert_eq!(show("N030 G01 X1.2.3"), Err((102, 13, 15)));
        assert_eq!(show("G1 X99999999999999999999 Y1"), Err((103, 4, 24)));
        assert_eq!(show("G1 X"), Err((102, 3, 4)));
        assert_eq!(show("G1 X Y1"), Err((102, 3, 4)));
        assert_eq!(show("X--5"), Err((102, 2, 4)));
        assert_eq!(show("G1 \u{e9}"), Err((101, 3, 4)));
        assert_eq!(show("G1 (a (b)"), Err((106, 6, 7)));
        assert_eq!(show("G1 (a"), Err((105, 3, 5)));
        assert_eq!(show("X#1"), Err((102, 1, 3)));
        assert_eq!(show("%1"), Err((101, 1, 2)));
        assert_eq!(show("G1 %"), Err((101, 3, 4)));
        assert_eq!(show("N1 G1 %"), Err((101, 6, 7)));
    }
}
