//! Words: a letter and a number, with their place in the text.

use crate::decimal::Decimal;
use crate::error::{Error, ErrorKind};
use core::ops::ControlFlow;

/// A letter and its number. `at..end` are the bytes of the text, 0-based, from the letter to the last digit.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct Word {
    /// Upper-case letter.
    pub letter: u8,
    /// The number, exactly.
    pub value: Decimal,
    /// Place of the letter.
    pub at: usize,
    /// Place behind the number.
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
#[inline]
pub fn words(line: &[u8]) -> Words<'_> {
    Words {
        scanner: Scanner::new(line),
    }
}

/// Iterator over the words of a line; see [`words`].
#[derive(Clone, Debug)]
pub struct Words<'a> {
    scanner: Scanner<'a, false>,
}

impl Words<'_> {
    /// Whether a `/` (block delete) stood before the first word; known once the first word was asked for.
    pub const fn is_deleted(&self) -> bool {
        self.scanner.deleted
    }
}

impl Iterator for Words<'_> {
    type Item = Result<Word, Error>;

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        match self.scanner.next()? {
            Ok(Token::Word(word)) => Some(Ok(word)),
            Ok(Token::EndOfLine) => None,
            Err(error) => Some(Err(error)),
        }
    }
}

impl core::iter::FusedIterator for Words<'_> {}

/// What a program consists of.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum Token {
    /// A word; its places are those in the whole text.
    Word(Word),
    /// The end of a line: CR, LF or CR LF, or the end of a text that ends without one.
    EndOfLine,
}

/// The words of a whole program with the ends of its lines, in one pass: what [`words`] gives for each line, without
/// looking for the ends of lines first. An error ends its line, and only that: the next line is read.
///
/// ```
/// use husillo_gcode::{Token, tokens};
/// let lines = tokens(b"G1 X1\nX\nX2").filter(|token| *token == Ok(Token::EndOfLine)).count();
/// let words = tokens(b"G1 X1\nX\nX2").filter(|token| matches!(token, Ok(Token::Word(_)))).count();
/// assert_eq!((lines, words), (3, 3));
/// ```
#[inline]
pub fn tokens(text: &[u8]) -> Tokens<'_> {
    Tokens {
        scanner: Scanner::new(text),
    }
}

/// Iterator over the words and line ends of a program; see [`tokens`].
#[derive(Clone, Debug)]
pub struct Tokens<'a> {
    scanner: Scanner<'a, true>,
}

impl Tokens<'_> {
    /// Whether a `/` (block delete) stood before the first word of this line; known once its first word was asked for,
    /// and until the word behind its end is.
    pub const fn is_deleted(&self) -> bool {
        self.scanner.deleted
    }
}

impl Iterator for Tokens<'_> {
    type Item = Result<Token, Error>;

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        self.scanner.next()
    }
}

impl core::iter::FusedIterator for Tokens<'_> {}

/// What stood before this place in the line, as far as it matters for `/` and `%`.
#[derive(Copy, Clone, Eq, PartialEq, PartialOrd, Debug)]
pub(crate) enum Before {
    /// Nothing at all; the line was just begun.
    Nothing,
    /// Blanks and comments.
    Blanks,
    /// Only an `N` word.
    Number,
    /// A word or a `/`.
    Words,
    /// A `%`: nothing but blanks and comments may follow.
    Percent,
    /// An error: the rest of the line is passed over.
    Fault,
}

/// The scanner of one line, or (`LINES`) of all lines of a text.
#[derive(Clone, Debug)]
struct Scanner<'a, const LINES: bool> {
    /// What was not read yet.
    rest: &'a [u8],
    /// The length of the whole text: with the rest it tells the place.
    length: usize,
    before: Before,
    deleted: bool,
}

/// Blanks inside a line; the ends of lines are blanks for a text that is one line.
const fn is_blank(byte: u8, lines: bool) -> bool {
    matches!(byte, b' ' | b'\t') || (!lines && matches!(byte, b'\r' | b'\n'))
}

/// What ends a line of several.
pub(crate) const fn is_end(byte: u8) -> bool {
    matches!(byte, b'\r' | b'\n')
}

/// The byte at a place; 0 behind the end, which no number and no blank contains. In 32 bits: no instruction is spent on
/// cutting it to eight.
#[inline(always)]
fn byte_at(text: &[u8], at: usize) -> u32 {
    match text.get(at) {
        Some(&byte) => u32::from(byte),
        None => 0,
    }
}

/// Digits from a place on, appended to `low`: the new number, the place behind them and the byte there. The number is
/// right as long as it has nine digits.
#[inline(always)]
fn digits(text: &[u8], mut at: usize, mut low: u32) -> (u32, usize, u32) {
    loop {
        let byte = byte_at(text, at);
        let digit = byte.wrapping_sub(ZERO);
        if digit > 9 {
            return (low, at, byte);
        }
        low = low.wrapping_mul(10).wrapping_add(digit);
        at = at.wrapping_add(1); // below the length of the text
    }
}

pub(crate) const ZERO: u32 = b'0' as u32;
const NINE: u32 = b'9' as u32;
const POINT: u32 = b'.' as u32;
const PLUS: u32 = b'+' as u32;
const MINUS: u32 = b'-' as u32;
const SPACE: u32 = b' ' as u32;
const LINE_FEED: u32 = b'\n' as u32;

/// Place of a letter in the alphabet, 26 and more for other bytes.
#[inline(always)]
fn alphabet(byte: u32) -> u32 {
    (byte & !0x20).wrapping_sub(b'A' as u32)
}

/// Bytes of a word and of what follows it, enough for the words that most programs consist of.
const WINDOW: usize = 16;

/// Whether the words of one line are read by the window too, a quarter of a kilobyte of code; processors without
/// compare-and-swap (Cortex-M0) have little room for it.
const QUICK: bool = cfg!(target_has_atomic = "32");

/// The most digits of a number within the window before its point.
const WHOLE: usize = 4;

/// The most digits behind it. Together nine: below 10^9 < 2^30.
const PLACES: usize = 5;

/// A byte of the window. All places asked for are below `1 + 1 + WHOLE + 1 + PLACES + 2 = 14`.
#[inline(always)]
fn window_at(window: &[u8; WINDOW], at: usize) -> u32 {
    match window.get(at) {
        Some(&byte) => u32::from(byte),
        None => 0,
    }
}

/// The number of a word whose letter is the first byte of the window, if it has few digits and no blank inside: its
/// value, the place behind it and the place behind a blank. `None` for everything else, right or wrong. The loops have fixed
/// lengths, so that no place is counted where they are unrolled.
#[inline(always)]
fn window_number(window: &[u8; WINDOW], lines: bool) -> Option<(Decimal, usize, usize)> {
    let (mut at, mut negative) = (1, false);
    let sign = window_at(window, 1);
    if sign.wrapping_sub(ZERO) > 9 {
        negative = sign == MINUS;
        if negative || sign == PLUS {
            at = 2;
        }
    }
    let (mut low, mut whole) = (0_u32, 0);
    let mut byte = window_at(window, at);
    while whole < WHOLE {
        let digit = byte.wrapping_sub(ZERO);
        if digit > 9 {
            break;
        }
        low = low.wrapping_mul(10).wrapping_add(digit);
        whole = whole.wrapping_add(1);
        byte = window_at(window, at.wrapping_add(whole));
    }
    at = at.wrapping_add(whole);
    let mut places = 0;
    if byte == POINT {
        at = at.wrapping_add(1);
        byte = window_at(window, at);
        while places < PLACES {
            let digit = byte.wrapping_sub(ZERO);
            if digit > 9 {
                break;
            }
            low = low.wrapping_mul(10).wrapping_add(digit);
            places = places.wrapping_add(1);
            byte = window_at(window, at.wrapping_add(places));
        }
        if places | whole == 0 {
            return None;
        }
        at = at.wrapping_add(places);
    } else if whole == 0 {
        return None;
    }
    let end = at;
    if byte == SPACE {
        at = at.wrapping_add(1);
        byte = window_at(window, at);
    }
    // Digits, and below them points, signs, commas and blanks: what may go on with a number or be wrong in it.
    if byte > NINE || (lines && byte == LINE_FEED) {
        return Some((Decimal::short(low, places as u8, negative), end, at));
    }
    None
}

/// A number of one to nine digits without blanks inside: its value, the place behind it and the place behind the blanks
/// that follow. `None` for everything else, right or wrong, which is [`number`]'s.
#[inline(always)]
fn short_number(text: &[u8], at: usize, lines: bool) -> Option<(Decimal, usize, usize)> {
    let sign = byte_at(text, at);
    let negative = sign == MINUS;
    let mut first = at;
    if negative || sign == PLUS {
        first = at.wrapping_add(1);
    }
    let (mut low, mut end, mut byte) = digits(text, first, 0);
    let mut places = 0;
    if byte == POINT {
        let point = end.wrapping_add(1);
        (low, end, byte) = digits(text, point, low);
        places = end.wrapping_sub(point);
        // From here on for the count alone: the point is none of the digits.
        first = first.wrapping_add(1);
    }
    // 1..=9 digits: below 10^9 < 2^30. The places are as many at the most.
    if end.wrapping_sub(first).wrapping_sub(1) > 8 {
        return None;
    }
    let mut next = end;
    if byte == SPACE {
        next = end.wrapping_add(1);
        byte = byte_at(text, next);
    }
    // At the end of the text, and before a NUL, it is over as well.
    if alphabet(byte) > 25 && byte != 0 && !(lines && byte == LINE_FEED) {
        next = behind_number(text, next, lines)?;
    }
    Some((Decimal::short(low, places as u8, negative), end, next))
}

/// The place behind the blanks that follow a number; `None` where the number goes on behind them, or is wrong there.
#[inline(never)]
fn behind_number(text: &[u8], mut at: usize, lines: bool) -> Option<usize> {
    while let Some(&byte) = text.get(at) {
        match byte {
            b'0'..=b'9' | b'.' | b'+' | b'-' | b',' => return None,
            _ if is_blank(byte, lines) => at = at.wrapping_add(1),
            _ => break,
        }
    }
    Some(at)
}

/// The number behind the letter that the text starts with: `[+-] digits [. digits]` with at least one digit, blanks
/// anywhere; and twice the place behind it. An error covers the rest of what looks like this number.
#[cold]
#[inline(never)]
fn number(text: &[u8], letter: u8, lines: bool) -> Result<(Decimal, usize, usize), Error> {
    let mut value = Decimal::default();
    let mut at = 1_usize;
    let mut end = at;
    while text.get(at).is_some_and(|&byte| is_blank(byte, lines)) {
        at = at.wrapping_add(1);
    }
    let first = at;
    let (mut negative, mut signed, mut point, mut digits) = (false, false, false, false);
    while let Some(&byte) = text.get(at) {
        let fault = match byte {
            b'0'..=b'9' => {
                digits = true;
                let digit = byte.wrapping_sub(b'0');
                value.push(digit, point)
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
            _ if is_blank(byte, lines) => {
                at = at.wrapping_add(1);
                continue;
            }
            _ => break,
        };
        let here = at;
        at = at.wrapping_add(1);
        end = at;
        if let Err(kind) = fault {
            while matches!(text.get(end), Some(b'0'..=b'9' | b'.')) {
                end = end.wrapping_add(1);
            }
            let at = match kind {
                ErrorKind::NumberTooLarge | ErrorKind::TooManyDigits => first,
                _ => here,
            };
            return Err(Error { kind, at, end });
        }
    }
    if !digits {
        let kind = ErrorKind::MissingNumber(letter);
        return Err(Error { kind, at: 0, end });
    }
    let value = if negative { value.negated() } else { value };
    Ok((value, end, end))
}

/// The place behind the comment that the text starts with.
fn comment(text: &[u8], lines: bool) -> Result<usize, Error> {
    let mut at = 0_usize;
    loop {
        at = at.wrapping_add(1);
        let kind = match text.get(at) {
            Some(b')') => return Ok(at.wrapping_add(1)),
            Some(b'(') => ErrorKind::NestedComment,
            Some(&byte) if !(lines && is_end(byte)) => continue,
            _ => ErrorKind::UnclosedComment,
        };
        return Err(match kind {
            ErrorKind::NestedComment => Error {
                kind,
                at,
                end: at.wrapping_add(1),
            },
            _ => Error {
                kind,
                at: 0,
                end: at,
            },
        });
    }
}

impl<'a, const LINES: bool> Scanner<'a, LINES> {
    #[inline]
    fn new(text: &'a [u8]) -> Self {
        Scanner {
            rest: text,
            length: text.len(),
            before: Before::Nothing,
            deleted: false,
        }
    }

    /// The place of what was not read yet.
    #[inline(always)]
    fn at(&self) -> usize {
        self.length.wrapping_sub(self.rest.len())
    }

    /// Passes bytes; there are at least as many.
    #[inline(always)]
    fn skip(&mut self, bytes: usize) {
        self.rest = self.rest.get(bytes..).unwrap_or_default();
    }

    #[inline(always)]
    fn next(&mut self) -> Option<Result<Token, Error>> {
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
                // Half the words of one line are too near to its end.
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

    /// The word of a letter and a number with the places behind it and behind what follows it, unless none may stand here.
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

    /// The first word of a line begins, or the one behind its `N` word; false behind a `%` or an error.
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

    /// The next line begins. Whether the last one is deleted is known until its first word is.
    #[inline(always)]
    fn end_line(&mut self) {
        if self.before == Before::Nothing {
            self.deleted = false;
        }
        self.before = Before::Nothing;
    }

    /// Passes what stands here and is none of the usual words, or gives what it is.
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
            b'A'..=b'Z' | b'a'..=b'z' if self.before < Before::Percent => {
                let letter = byte.to_ascii_uppercase();
                let short = if LINES || !QUICK {
                    short_number(rest, 1, LINES)
                } else {
                    None // was tried
                };
                match short.map_or_else(|| number(rest, letter, LINES), Ok) {
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

    /// Passes the rest of this line.
    fn skip_line(&mut self) {
        let left = if LINES {
            self.rest.iter().position(|&byte| is_end(byte))
        } else {
            None
        };
        self.skip(left.unwrap_or(self.rest.len()));
    }
}

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

    /// Letters, numbers and ends of lines (`|`); errors by their code and place.
    fn show_all(text: &str) -> String {
        let show = |token| match token {
            Ok(Token::Word(w)) => std::format!("{}{}", char::from(w.letter), w.value),
            Ok(Token::EndOfLine) => "|".into(),
            Err(Error { kind, at, end }) => std::format!("E{}@{at}..{end}", kind.code()),
        };
        tokens(text.as_bytes())
            .map(show)
            .collect::<Vec<_>>()
            .join(" ")
    }

    #[test]
    fn a_program_is_its_lines() {
        assert_eq!(
            show_all("G1 X1.5\r\n(a) Y 1 0;b\n\n%\nN1%\rX2"),
            "G1 X1.5 | Y10 | | | N1 | X2 |"
        );
        assert_eq!(
            show_all("X1 \n2\nX\n1 Y1\nZ1"),
            "X1 | E101@4..5 | E102@6..7 | E101@8..9 | Z1 |"
        );
        assert_eq!(
            show_all("(a\nG1)X1\n%X1 Y1\n"),
            "E105@0..2 | G1 E101@5..6 | E101@10..11 |"
        );
        assert_eq!(show_all("\n\r\n\n\r"), "| | | |");
        assert_eq!(show_all(" "), "|");
        assert_eq!(show_all(""), "");
    }

    #[test]
    fn a_deleted_line_says_so_until_the_next() {
        let mut program = tokens(b"/X1\nX2\n/\n\n");
        let deleted: Vec<bool> =
            core::iter::from_fn(|| program.next().map(|_| program.is_deleted())).collect();
        assert_eq!(deleted, [true, true, false, false, true, false]);
    }
}
