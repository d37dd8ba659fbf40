//! Words of one line: a letter and a number, with blanks anywhere.

use crate::error::{Error, ErrorKind};
use crate::number::Number;

/// A position in a line. The scanner skips blanks and returns letters in upper case.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Scanner<'a> {
    text: &'a [u8],
    at: usize,
}

/// A letter with its number and the range of its bytes.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Word {
    pub letter: u8,
    pub number: Number,
    pub at: usize,
    pub end: usize,
}

impl Word {
    /// Returns an error about the whole word.
    pub(crate) fn error(&self, kind: ErrorKind) -> Error {
        Error {
            kind,
            at: self.at,
            end: self.end,
        }
    }

    /// Returns the number as an integer up to `most`.
    pub(crate) fn whole(&self, most: u16) -> Result<u16, Error> {
        let Some(whole) = self.number.whole() else {
            return Err(self.error(ErrorKind::NotWhole(self.letter)));
        };
        match u16::try_from(whole) {
            Ok(whole) if whole <= most => Ok(whole),
            _ => Err(self.error(ErrorKind::NumberTooLarge)),
        }
    }
}

impl<'a> Scanner<'a> {
    pub(crate) const fn new(text: &'a [u8]) -> Scanner<'a> {
        Scanner { text, at: 0 }
    }

    /// Returns the next byte that is not a blank, in upper case.
    pub(crate) fn peek(&mut self) -> Option<u8> {
        while let Some(b' ' | b'\t') = self.text.get(self.at) {
            self.at = self.at.wrapping_add(1); // at < len
        }
        self.text.get(self.at).map(u8::to_ascii_uppercase)
    }

    /// Returns the next byte and skips it.
    pub(crate) fn next(&mut self) -> Option<u8> {
        let byte = self.peek()?;
        self.at = self.at.wrapping_add(1); // at < len
        Some(byte)
    }

    /// Skips the next byte if it is `wanted`.
    pub(crate) fn take(&mut self, wanted: u8) -> bool {
        let is = self.peek() == Some(wanted);
        if is {
            self.at = self.at.wrapping_add(1); // at < len
        }
        is
    }

    /// Skips `name` (in upper case) if all its bytes come next.
    pub(crate) fn take_name(&mut self, name: &[u8]) -> bool {
        let mut ahead = *self;
        let is = name.iter().all(|byte| ahead.take(*byte));
        if is {
            *self = ahead;
        }
        is
    }

    /// Returns the position of the first unread byte. Blanks before it count as read.
    pub(crate) fn at(&mut self) -> usize {
        self.peek();
        self.at
    }

    /// Whether only a comment or nothing is left in the line.
    pub(crate) fn is_at_end(&mut self) -> bool {
        matches!(self.peek(), None | Some(b';'))
    }

    /// Reads a number with its sign. Returns `None` if there is no digit.
    pub(crate) fn number(&mut self) -> Result<Option<Number>, Error> {
        let start = self.at();
        let mut number = Number::EMPTY;
        match self.peek() {
            Some(b'+') => {
                self.next();
            }
            Some(b'-') => {
                self.next();
                number.set_negative();
            }
            _ => {}
        }
        loop {
            let fault = match self.peek() {
                Some(digit @ b'0'..=b'9') => {
                    let fits = number.push(digit.wrapping_sub(b'0'));
                    (!fits).then_some(ErrorKind::TooManyDigits)
                }
                Some(b'.') => (!number.set_point()).then_some(ErrorKind::MalformedNumber),
                _ => break,
            };
            self.next();
            if let Some(kind) = fault {
                while let Some(b'0'..=b'9' | b'.') = self.peek() {
                    self.next();
                }
                return Err(Error {
                    kind,
                    at: start,
                    end: self.at,
                });
            }
        }
        Ok((number.written() > 0).then_some(number))
    }

    /// Reads the next word. Returns `None` at the end of the line or at a comment.
    pub(crate) fn word(&mut self) -> Option<Result<Word, Error>> {
        if self.is_at_end() {
            return None;
        }
        let at = self.at();
        let letter = self.next()?;
        let error = |kind, end| Error { kind, at, end };
        if !letter.is_ascii_alphabetic() {
            let kind = match letter {
                b'*' => ErrorKind::Gerber,
                b' '..=b'~' => ErrorKind::NotALetter(letter),
                _ => ErrorKind::NotText(letter),
            };
            return Some(Err(error(kind, self.at)));
        }
        let letter_end = self.at;
        Some(match self.number() {
            Ok(Some(number)) => Ok(Word {
                letter,
                number,
                at,
                end: self.at_last(letter_end),
            }),
            Ok(None) => Err(error(ErrorKind::MissingNumber(letter), letter_end)),
            Err(fault) => Err(fault),
        })
    }

    /// Returns the end of the last byte read that is not a blank, at least `least`.
    fn at_last(&self, least: usize) -> usize {
        let read = self.text.get(..self.at).unwrap_or_default();
        let blanks = read
            .iter()
            .rev()
            .take_while(|byte| matches!(byte, b' ' | b'\t'));
        // The count stops at the letter at the latest, so it is at most `at`.
        blanks
            .fold(self.at, |end, _| end.wrapping_sub(1))
            .max(least)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    #[test]
    fn words_with_blanks_inside() {
        let mut scanner = Scanner::new(b" x 01 2.5 Y-3;c");
        let first = scanner.word().unwrap().unwrap();
        assert_eq!((first.letter, first.at, first.end), (b'X', 1, 9));
        assert_eq!(first.number.written(), 4);
        let second = scanner.word().unwrap().unwrap();
        assert_eq!((second.letter, second.at, second.end), (b'Y', 10, 13));
        assert!(scanner.word().is_none());
    }

    #[test]
    fn faults_have_places() {
        let kinds: Vec<_> = ["X", "X1.2.3Y", "?", "\u{7f}", "X1234567890123456789", "*"]
            .iter()
            .map(|text| {
                let error = Scanner::new(text.as_bytes()).word().unwrap().unwrap_err();
                (error.kind, error.at, error.end)
            })
            .collect();
        assert_eq!(
            kinds,
            [
                (ErrorKind::MissingNumber(b'X'), 0, 1),
                (ErrorKind::MalformedNumber, 1, 6),
                (ErrorKind::NotALetter(b'?'), 0, 1),
                (ErrorKind::NotText(0x7f), 0, 1),
                (ErrorKind::TooManyDigits, 1, 20),
                (ErrorKind::Gerber, 0, 1),
            ]
        );
    }

    #[test]
    fn names_are_taken_whole() {
        let mut scanner = Scanner::new(b"met ric,tz");
        assert!(!scanner.take_name(b"METRO"));
        assert!(scanner.take_name(b"METRIC") && scanner.take(b',') && scanner.take_name(b"TZ"));
        assert!(scanner.is_at_end());
    }
}
