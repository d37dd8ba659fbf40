//! Words from a stream of bytes, without a buffer for the line.

use crate::error::{Error, ErrorKind};
use crate::features::EXTENDED;
use crate::values::decimal::Decimal;
use crate::words::numeral::ZERO;
use crate::words::scanner::{Before, is_end};
use crate::words::word::Word;

/// Reads words from bytes as they arrive. It gives the same as [`words`](crate::words()) for each
/// line, and stores only the word in progress. Size: 72 bytes on a 32-bit machine.
///
/// A word is complete with the byte after it. The CR or LF that ends a line returns its last word,
/// so the line is over after such a byte. An error is returned with the byte after its text; the
/// rest of that line is skipped, and the next one is read. Positions are columns of the line,
/// counted from 0. NUL and form feed at the start of a line are skipped.
///
/// # Examples
/// ```
/// use husillo_gcode::WordReader;
/// let mut reader = WordReader::new();
/// let mut seen = String::new();
/// for byte in *b"G1 X1.50\nX2,5 Y1\nZ-1\n" {
///     match reader.push(byte) {
///         Some(Ok(word)) => seen += &format!("{}{} ", char::from(word.letter), word.value),
///         Some(Err(error)) => seen += &format!("{error} at {} ", error.at),
///         None => {}
///     }
/// }
/// assert_eq!(seen, "G1 X1.50 comma in a number at 2 Z-1 ");
/// ```
// In this order, the fields that a Cortex-M0 reads byte by byte are near the start.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct WordReader {
    state: State,
    before: Before,
    deleted: bool,
    letter: u8,
    number: Number,
    letter_at: usize,
    /// Start of a number after blanks or a comment; smaller for other numbers of this line.
    first: usize,
    /// Position after the number, as it was before the last blank.
    end: usize,
    /// The column of the next byte plus the room. Digits that use up room therefore need no
    /// counting.
    column: usize,
    /// All digits of a number of more than nine.
    long: Decimal,
    fault: Error,
}

/// The number as far as it was read. In words of 32 bits: a digit changes only two of them.
#[derive(Copy, Clone, Debug)]
struct Number {
    /// The first nine digits.
    low: u32,
    /// Number of further digits that `low` can hold; 0 outside a number.
    room: u32,
    /// The room at the point.
    point: u32,
    /// The room at the last blank, if only blanks followed.
    closed: u32,
    sign: Sign,
}

/// Number of digits that 32 bits hold: 10^9 - 1 < 2^32.
const ROOM: u32 = 9;

/// The room at a point or a blank that was not read.
const NOWHERE: u32 = u32::MAX;

impl Number {
    /// The state after a letter.
    const BEGIN: Number = Number {
        low: 0,
        room: ROOM,
        point: NOWHERE,
        closed: NOWHERE,
        sign: Sign::None,
    };

    /// Whether a sign, a point or a digit was read.
    fn is_begun(&self) -> bool {
        self.room != ROOM || self.point != NOWHERE || self.sign != Sign::None
    }

    #[inline(always)]
    fn is_negative(&self) -> bool {
        self.sign == Sign::Minus
    }

    /// Number of digits after the point, among the first nine.
    #[inline(always)]
    const fn places(&self) -> u8 {
        if self.point == NOWHERE {
            return 0;
        }
        self.point.wrapping_sub(self.room) as u8 // <= ROOM
    }
}

/// The sign of a number as written.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[repr(u32)]
enum Sign {
    None,
    Plus,
    Minus,
}

/// The state of the reader. The order matters: states in which most bytes change nothing come last.
#[derive(Copy, Clone, Eq, PartialEq, PartialOrd, Debug)]
enum State {
    /// After a letter, within its number.
    Number,
    /// After a letter and more than nine digits, which are in `long`.
    Long,
    /// Between words.
    Between,
    /// After a fault in a number: the following digits and points belong to the error.
    Malformed,
    /// After any other fault.
    Wrong,
    /// Inside `( )`, after a `)` that ends an inner pair, and after blanks behind it.
    Closing,
    /// Inside `( )`.
    Comment,
    /// After an error or `;`: the rest of this line is ignored.
    Rest,
}

/// The result of a byte.
#[derive(Copy, Clone, Eq, PartialEq)]
#[repr(u32)]
enum Step {
    Nothing,
    /// A word is complete; the byte is not taken yet.
    Word,
    /// The error in `fault`.
    Fault,
}

impl WordReader {
    /// Creates a reader at the start of a line.
    pub const fn new() -> WordReader {
        WordReader {
            number: Number {
                room: 0,
                ..Number::BEGIN
            },
            state: State::Between,
            before: Before::Nothing,
            deleted: false,
            letter: 0,
            letter_at: 0,
            first: 0,
            end: 0,
            column: 0,
            long: Decimal::ZERO,
            fault: Error {
                kind: ErrorKind::MalformedNumber,
                at: 0,
                end: 0,
            },
        }
    }

    /// Takes one byte; returns the word or the error that it completes.
    ///
    /// # Errors
    /// Those of [`words`](crate::words()): E0101 to E0103, E0105, E0108, at most one per line.
    #[inline]
    pub fn push(&mut self, byte: u8) -> Option<Result<Word, Error>> {
        let room = self.number.room;
        let digit = u32::from(byte).wrapping_sub(ZERO);
        let mut over = false;
        if digit < 10 {
            if room != 0 {
                self.number.low = self.number.low.wrapping_mul(10).wrapping_add(digit);
                self.number.room = room.wrapping_sub(1);
                return None;
            }
        } else if byte >= b'A' {
            // Most words end with the letter of the next one; outside a number there is no room.
            over = room.wrapping_sub(1) < ROOM - 1;
        }
        match if over { Step::Word } else { self.step(byte) } {
            Step::Nothing => None,
            Step::Word => {
                let number = &self.number;
                let value = if !over && self.state == State::Long {
                    self.long
                } else {
                    Decimal::any_short(number.low, number.places(), number.is_negative())
                };
                let word = self.word(value);
                self.between(byte);
                Some(Ok(word))
            }
            Step::Fault => Some(Err(self.fault)),
        }
    }

    /// Ends the input, which also ends a line: returns its last word or error. The reader is then
    /// ready for another input.
    ///
    /// # Errors
    /// As [`WordReader::push`].
    pub fn finish(&mut self) -> Option<Result<Word, Error>> {
        self.push(b'\n')
    }

    /// Whether a `/` (block delete) precedes the first word of the line; known from its first word
    /// until the byte after its end.
    pub const fn is_deleted(&self) -> bool {
        self.deleted
    }

    /// The word that is now complete.
    #[inline(always)]
    fn word(&self, value: Decimal) -> Word {
        Word {
            letter: self.letter,
            value,
            at: self.letter_at,
            end: self.end(),
        }
    }

    /// The position after the number as far as it was read.
    #[inline(always)]
    fn end(&self) -> usize {
        if self.number.closed == self.number.room {
            self.end
        } else {
            self.at()
        }
    }

    /// Handles everything except the first nine digits of a number.
    #[inline(never)]
    fn step(&mut self, byte: u8) -> Step {
        match self.state {
            State::Number => self.in_number(byte),
            State::Long => self.other_in_number(byte),
            State::Between => {
                self.between(byte);
                Step::Nothing
            }
            state if byte > b')' && state >= State::Comment => {
                self.column = self.column.wrapping_add(1);
                Step::Nothing
            }
            _ => self.outside(byte),
        }
    }

    /// A byte inside a word, after its letter.
    #[inline(always)]
    fn in_number(&mut self, byte: u8) -> Step {
        if byte > b' ' {
            if byte == b'.' && self.number.point == NOWHERE {
                return self.point();
            }
            if byte == b'-' && !self.number.is_begun() {
                return self.sign(Sign::Minus);
            }
        } else if byte == b' ' {
            return self.blank();
        } else if byte == b'\n' && self.number.room != ROOM {
            return Step::Word;
        }
        self.other_in_number(byte)
    }

    #[inline(always)]
    fn point(&mut self) -> Step {
        self.number.point = self.number.room;
        self.extend()
    }

    #[inline(always)]
    fn sign(&mut self, sign: Sign) -> Step {
        self.number.sign = sign;
        self.extend()
    }

    /// Continues the number with a byte that took no room.
    #[inline(always)]
    fn extend(&mut self) -> Step {
        self.number.closed = NOWHERE;
        // A line of 2^32 bytes on a small machine gives wrong columns, but no other error.
        self.column = self.column.wrapping_add(1);
        Step::Nothing
    }

    /// A blank in a number or after it.
    #[inline(always)]
    fn blank(&mut self) -> Step {
        self.end = self.end();
        self.number.closed = self.number.room;
        if !self.number.is_begun() {
            self.first = self.at().wrapping_add(1);
        }
        self.column = self.column.wrapping_add(1);
        Step::Nothing
    }

    /// Bytes that are rare in a number, or wrong.
    #[cold]
    #[inline(never)]
    fn other_in_number(&mut self, byte: u8) -> Step {
        let number = &self.number;
        let (digits, point) = (number.room != ROOM, number.point != NOWHERE);
        let kind = match byte {
            b'0'..=b'9' => return self.append_long(byte.wrapping_sub(b'0'), point),
            b' ' | b'\t' => return self.blank(),
            b'.' if !point => return self.point(),
            b'+' if !number.is_begun() => return self.sign(Sign::Plus),
            b'.' | b'+' | b'-' => ErrorKind::MalformedNumber,
            b',' if !point => ErrorKind::DecimalComma,
            b'#' | b'[' if !digits => ErrorKind::Expression,
            _ if !digits => {
                let kind = ErrorKind::MissingNumber(self.letter);
                let (at, end) = (self.letter_at, self.end());
                self.column = self.at().wrapping_add(1);
                return self.refuse(Error { kind, at, end }, byte);
            }
            _ if self.state == State::Long => {
                if number.is_negative() {
                    self.long = self.long.negated();
                }
                return Step::Word;
            }
            _ => return Step::Word,
        };
        let at = self.at();
        self.column = at.wrapping_add(1);
        self.mark(State::Malformed, kind, at);
        Step::Nothing
    }

    /// A digit beyond the ninth.
    fn append_long(&mut self, digit: u8, point: bool) -> Step {
        let number = &mut self.number;
        if self.state != State::Long {
            self.state = State::Long;
            self.long = Decimal::any_short(number.low, number.places(), false);
        }
        number.closed = NOWHERE;
        let pushed = self.long.push(digit, point);
        let at = self.column; // there is no room
        self.column = at.wrapping_add(1);
        if let Err(kind) = pushed {
            self.mark(State::Malformed, kind, at);
            // After the letter, or after the blanks that follow it.
            self.fault.at = self.first.max(self.letter_at.wrapping_add(1));
        }
        Step::Nothing
    }

    /// The column of the next byte.
    #[inline(always)]
    fn at(&self) -> usize {
        self.column.wrapping_sub(self.number.room as usize)
    }

    /// A byte between words, including the one that completes a word.
    #[inline(never)]
    fn between(&mut self, byte: u8) {
        let at = self.at();
        let letter = byte & !0x20;
        if letter.wrapping_sub(b'A') < 26 && self.before < Before::Percent {
            self.begin(letter, at);
        } else {
            self.column = at.wrapping_add(1);
            (self.number.room, self.state) = (0, State::Between);
            if is_end(byte) {
                self.end_line();
            } else {
                self.mark_between(byte, at);
            }
        }
    }

    /// The letter of a word, or a sign of polar coordinates.
    #[inline(always)]
    fn begin(&mut self, letter: u8, at: usize) {
        if self.before != Before::Words {
            self.enter(letter);
        }
        (self.letter, self.letter_at) = (letter, at);
        self.column = at.wrapping_add(1).wrapping_add(ROOM as usize);
        (self.number, self.state) = (Number::BEGIN, State::Number);
    }

    /// The first word of a line, or the one after its `N` word.
    #[inline(always)]
    fn enter(&mut self, letter: u8) {
        self.deleted &= self.before != Before::Nothing;
        self.before = if letter == b'N' && self.before < Before::Number {
            Before::Number
        } else {
            Before::Words
        };
    }

    /// A byte between words that is not a letter.
    #[inline(never)]
    fn mark_between(&mut self, byte: u8, at: usize) {
        if EXTENDED && matches!(byte, b'@' | b'^') && self.before < Before::Percent {
            self.begin(byte, at);
            return;
        }
        if self.before == Before::Nothing {
            if matches!(byte, 0 | 0x0c) {
                self.column = 0;
                return;
            }
            self.before = Before::Blanks;
            self.deleted = false;
        }
        match byte {
            b' ' | b'\t' => {}
            b'(' => (self.first, self.number.low, self.state) = (at, 0, State::Comment),
            b';' => self.state = State::Rest,
            b'/' if self.before == Before::Blanks => {
                (self.before, self.deleted) = (Before::Words, true);
            }
            b'%' if self.before < Before::Words => self.before = Before::Percent,
            b'#' | b'[' => self.mark(State::Wrong, ErrorKind::Expression, at),
            _ => self.mark(State::Wrong, ErrorKind::NotALetter(byte), at),
        }
    }

    /// A byte of a comment, of faulty text, or after it.
    #[inline(never)]
    fn outside(&mut self, byte: u8) -> Step {
        let at = self.column;
        self.column = at.wrapping_add(1);
        match self.state {
            // Outside a number `low` counts the inner pairs of a comment that are open.
            State::Comment | State::Closing if byte == b')' => match self.number.low {
                0 => self.state = State::Between,
                inner => (self.number.low, self.state) = (inner.wrapping_sub(1), State::Closing),
            },
            State::Comment | State::Closing if byte == b'(' => {
                (self.number.low, self.state) = (self.number.low.saturating_add(1), State::Comment);
            }
            State::Closing if is_end(byte) => self.end_line(),
            State::Closing if !matches!(byte, b' ' | b'\t') => self.state = State::Comment,
            State::Comment if is_end(byte) => {
                let kind = ErrorKind::UnclosedComment;
                let (at, end) = (self.first, at);
                return self.refuse(Error { kind, at, end }, byte);
            }
            State::Malformed if matches!(byte, b'0'..=b'9' | b'.') => self.fault.end = self.column,
            State::Malformed | State::Wrong => return self.refuse(self.fault, byte),
            State::Rest if is_end(byte) => self.end_line(),
            // Numbers and the text between words are handled elsewhere.
            _ => {}
        }
        Step::Nothing
    }

    /// Stores an error at one byte until the next one.
    fn mark(&mut self, state: State, kind: ErrorKind, at: usize) {
        (self.number.room, self.state) = (0, state);
        self.fault = Error {
            kind,
            at,
            end: at.wrapping_add(1),
        };
    }

    /// Returns an error at the byte after it.
    fn refuse(&mut self, error: Error, byte: u8) -> Step {
        (self.number.room, self.state) = (0, State::Rest);
        self.fault = error;
        if is_end(byte) {
            self.end_line();
        }
        Step::Fault
    }

    fn end_line(&mut self) {
        self.deleted &= self.before != Before::Nothing;
        (self.state, self.before) = (State::Between, Before::Nothing);
        (self.column, self.first) = (0, 0);
    }
}

impl Default for WordReader {
    fn default() -> Self {
        WordReader::new()
    }
}
