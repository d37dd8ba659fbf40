//! Words from a stream of bytes, without a buffer for the line.

use crate::error::{Error, ErrorKind};
use crate::values::decimal::Decimal;
use crate::words::numeral::ZERO;
use crate::words::scanner::{Before, is_end};
use crate::words::word::Word;

/// Reads words from bytes as they come: what [`words`](crate::words()) gives for each line, with
/// nothing kept of the line but the word that is being read. 72 bytes of state on a 32-bit machine.
///
/// A word is complete with the byte behind it; the CR or LF that ends a line hands over its last
/// word, so after such a byte the line is over. An error is handed over with the byte behind what
/// it is about; the rest of that line is passed over, the next one is read. Places are columns of
/// the line, 0-based. NUL and form feed at the start of a line are passed over.
///
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
// In this order: what a Cortex-M0 reads byte by byte must be near the start.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct WordReader {
    state: State,
    before: Before,
    deleted: bool,
    letter: u8,
    number: Number,
    letter_at: usize,
    /// Where a number starts that stands behind blanks, or a comment; smaller for others of this
    /// line.
    first: usize,
    /// Behind the number, as it was before the last blank.
    end: usize,
    /// The column of the next byte and the room: so the digits that take room need not be counted
    /// here.
    column: usize,
    /// All digits of a number of more than nine.
    long: Decimal,
    fault: Error,
}

/// The number as far as it was read. In words of 32 bits: a digit changes two of them and nothing
/// else.
#[derive(Copy, Clone, Debug)]
struct Number {
    /// The first nine digits.
    low: u32,
    /// How many more digits `low` holds; 0 outside of a number.
    room: u32,
    /// The room at the point.
    point: u32,
    /// The room at the last blank, if nothing but blanks came since.
    closed: u32,
    sign: Sign,
}

/// How many digits 32 bits hold: 10^9 - 1 < 2^32.
const ROOM: u32 = 9;

/// The room at a point or a blank that was not read.
const NOWHERE: u32 = u32::MAX;

impl Number {
    /// Behind a letter.
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

    /// Digits behind the point, of the first nine.
    #[inline(always)]
    const fn places(&self) -> u8 {
        if self.point == NOWHERE {
            return 0;
        }
        self.point.wrapping_sub(self.room) as u8 // <= ROOM
    }
}

/// The sign of a number, as it is written.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[repr(u32)]
enum Sign {
    None,
    Plus,
    Minus,
}

/// What was read last. The order matters: those in which most bytes change nothing come last.
#[derive(Copy, Clone, Eq, PartialEq, PartialOrd, Debug)]
enum State {
    /// A letter and what there is of its number.
    Number,
    /// A letter and more than nine digits, in `long`.
    Long,
    /// Between words.
    Between,
    /// Something wrong in a number: the digits and points that follow belong to the error.
    Malformed,
    /// Something else that is wrong.
    Wrong,
    /// Inside `( )`.
    Comment,
    /// Behind an error or `;`: nothing more of this line counts.
    Rest,
}

/// What a byte completes.
#[derive(Copy, Clone, Eq, PartialEq)]
#[repr(u32)]
enum Step {
    Nothing,
    /// A word; the byte is not taken yet.
    Word,
    /// The error in `fault`.
    Fault,
}

impl WordReader {
    /// At the start of a line.
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

    /// Takes one byte; gives the word or the error that it completes.
    ///
    /// # Errors
    /// Those of [`words`](crate::words()): E0101 to E0103, E0105, E0106, E0108, once a line.
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
            // Most words are over with the letter of the next; outside of a number there is no
            // room.
            over = room.wrapping_sub(1) < ROOM - 1;
        }
        match if over { Step::Word } else { self.step(byte) } {
            Step::Nothing => None,
            Step::Word => {
                let number = &self.number;
                let value = if !over && self.state == State::Long {
                    self.long
                } else {
                    Decimal::short(number.low, number.places(), number.is_negative())
                };
                let word = self.word(value);
                self.between(byte);
                Some(Ok(word))
            }
            Step::Fault => Some(Err(self.fault)),
        }
    }

    /// The end of the input, which also ends a line: gives its last word or error, and is ready for
    /// another input.
    ///
    /// # Errors
    /// As [`WordReader::push`].
    pub fn finish(&mut self) -> Option<Result<Word, Error>> {
        self.push(b'\n')
    }

    /// Whether a `/` (block delete) stood before the first word of the line; known with its first
    /// word, until the byte behind its end.
    pub const fn is_deleted(&self) -> bool {
        self.deleted
    }

    /// The word that is complete now.
    #[inline(always)]
    fn word(&self, value: Decimal) -> Word {
        Word {
            letter: self.letter,
            value,
            at: self.letter_at,
            end: self.end(),
        }
    }

    /// The position behind the number as far as it was read.
    #[inline(always)]
    fn end(&self) -> usize {
        if self.number.closed == self.number.room {
            self.end
        } else {
            self.at()
        }
    }

    /// Everything but the first nine digits of a number.
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

    /// A byte inside a word, behind its letter.
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

    /// The number goes on with a byte that took no room.
    #[inline(always)]
    fn extend(&mut self) -> Step {
        self.number.closed = NOWHERE;
        // A line of 2^32 bytes on a small machine gives wrong columns, nothing else.
        self.column = self.column.wrapping_add(1);
        Step::Nothing
    }

    /// A blank in a number or behind it.
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

    /// What is seldom in a number or wrong.
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
            self.long = Decimal::short(number.low, number.places(), false);
        }
        number.closed = NOWHERE;
        let pushed = self.long.push(digit, point);
        let at = self.column; // there is no room
        self.column = at.wrapping_add(1);
        if let Err(kind) = pushed {
            self.mark(State::Malformed, kind, at);
            // Behind the letter, or behind the blanks that follow it.
            self.fault.at = self.first.max(self.letter_at.wrapping_add(1));
        }
        Step::Nothing
    }

    /// The column of the next byte.
    #[inline(always)]
    fn at(&self) -> usize {
        self.column.wrapping_sub(self.number.room as usize)
    }

    /// A byte between words, also the one that completes a word.
    #[inline(never)]
    fn between(&mut self, byte: u8) {
        let at = self.at();
        let letter = byte & !0x20;
        if letter.wrapping_sub(b'A') < 26 && self.before < Before::Percent {
            if self.before != Before::Words {
                self.enter(letter);
            }
            (self.letter, self.letter_at) = (letter, at);
            self.column = at.wrapping_add(1).wrapping_add(ROOM as usize);
            (self.number, self.state) = (Number::BEGIN, State::Number);
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

    /// The first word of a line, or the one behind its `N` word.
    #[inline(always)]
    fn enter(&mut self, letter: u8) {
        self.deleted &= self.before != Before::Nothing;
        self.before = if letter == b'N' && self.before < Before::Number {
            Before::Number
        } else {
            Before::Words
        };
    }

    /// A byte between words that is no letter.
    #[inline(never)]
    fn mark_between(&mut self, byte: u8, at: usize) {
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
            b'(' => (self.first, self.state) = (at, State::Comment),
            b';' => self.state = State::Rest,
            b'/' if self.before == Before::Blanks => {
                (self.before, self.deleted) = (Before::Words, true);
            }
            b'%' if self.before < Before::Words => self.before = Before::Percent,
            b'#' | b'[' => self.mark(State::Wrong, ErrorKind::Expression, at),
            _ => self.mark(State::Wrong, ErrorKind::NotALetter(byte), at),
        }
    }

    /// A byte of a comment, of what is wrong, or behind it.
    #[inline(never)]
    fn outside(&mut self, byte: u8) -> Step {
        let at = self.column;
        self.column = at.wrapping_add(1);
        match self.state {
            State::Comment if byte == b')' => self.state = State::Between,
            State::Comment if byte == b'(' => self.mark(State::Wrong, ErrorKind::NestedComment, at),
            State::Comment if is_end(byte) => {
                let kind = ErrorKind::UnclosedComment;
                let (at, end) = (self.first, at);
                return self.refuse(Error { kind, at, end }, byte);
            }
            State::Malformed if matches!(byte, b'0'..=b'9' | b'.') => self.fault.end = self.column,
            State::Malformed | State::Wrong => return self.refuse(self.fault, byte),
            State::Rest if is_end(byte) => self.end_line(),
            // Numbers and what is between words went other ways.
            _ => {}
        }
        Step::Nothing
    }

    /// Keeps an error at one byte until the next.
    fn mark(&mut self, state: State, kind: ErrorKind, at: usize) {
        (self.number.room, self.state) = (0, state);
        self.fault = Error {
            kind,
            at,
            end: at.wrapping_add(1),
        };
    }

    /// Hands over an error at the byte behind it.
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
