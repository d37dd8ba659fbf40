//! Words from a stream of bytes, without a buffer for the line.

use crate::decimal::Decimal;
use crate::error::{Error, ErrorKind};
use crate::word::{Before, Word, is_end};

/// Reads words from bytes as they come: what [`words`](crate::words) gives for each line, with nothing kept of the line but the
/// word that is being read. 56 bytes of state on a 32-bit machine.
///
/// A word is complete with the byte behind it; the CR or LF that ends a line hands over its last word, so after such a
/// byte the line is over. An error is handed over with the byte behind what it is about; the rest of that line is passed over, the next one is
/// read. Places are columns of the line, 0-based. NUL and form feed at the start of a line are passed over.
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
#[derive(Clone, Debug)]
pub struct WordReader {
    state: State,
    before: Before,
    /// The first nine digits; with more, all digits are in `long`.
    short: u32,
    count: u8,
    places: u8,
    negative: bool,
    deleted: bool,
    letter: u8,
    letter_at: usize,
    /// Where the number starts.
    first: usize,
    /// Behind the number as far as it was read.
    end: usize,
    /// The column of the next byte.
    column: usize,
    long: Decimal,
    fault: Error,
}

/// How many digits `short` holds: 10^9 - 1 < 2^32.
const SHORT: u8 = 9;

/// What was read last. The order matters: the states of a number come first, those with digits before all.
#[derive(Copy, Clone, Eq, PartialEq, PartialOrd, Debug)]
enum State {
    /// Digits before the point.
    Whole,
    /// A point with digits before or behind it.
    Places,
    /// A point without a digit so far.
    Point,
    /// A sign.
    Sign,
    /// A letter.
    Letter,
    /// Something wrong in a number: the digits and points that follow belong to the error.
    Malformed,
    /// Something else that is wrong.
    Wrong,
    /// Between words.
    Between,
    /// Inside `( )`.
    Comment,
    /// Behind an error or `;`: nothing more of this line counts.
    Rest,
}

impl WordReader {
    /// At the start of a line.
    pub const fn new() -> WordReader {
        WordReader {
            state: State::Between,
            before: Before::Nothing,
            short: 0,
            count: 0,
            places: 0,
            negative: false,
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
    /// Those of [`words`](crate::words): E0101 to E0103, E0105, E0106, E0108, once a line.
    pub fn push(&mut self, byte: u8) -> Option<Result<Word, Error>> {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 && self.state <= State::Places && self.count < SHORT {
            self.append(digit);
            return None;
        }
        self.other(byte)
    }

    /// The end of the input, which also ends a line: gives its last word or error, and is ready for another input.
    ///
    /// # Errors
    /// As [`WordReader::push`].
    pub fn finish(&mut self) -> Option<Result<Word, Error>> {
        self.push(b'\n')
    }

    /// Whether a `/` (block delete) stood before the first word of the line; known with its first word, until the byte
    /// behind its end.
    pub const fn is_deleted(&self) -> bool {
        self.deleted
    }

    /// One of the first nine digits.
    #[inline(always)]
    fn append(&mut self, digit: u8) {
        self.column = self.column.wrapping_add(1);
        self.end = self.column;
        self.short = self.short.wrapping_mul(10).wrapping_add(u32::from(digit));
        self.count = self.count.wrapping_add(1); // <= SHORT
        self.places = self
            .places
            .wrapping_add(u8::from(self.state == State::Places));
    }

    /// Everything but the second to ninth digit of a number.
    #[inline(never)]
    fn other(&mut self, byte: u8) -> Option<Result<Word, Error>> {
        if self.state <= State::Letter {
            return self.in_number(byte);
        }
        let at = self.column;
        // A line of 2^32 bytes on a small machine gives wrong columns, nothing else.
        self.column = at.wrapping_add(1);
        match self.state {
            State::Malformed if matches!(byte, b'0'..=b'9' | b'.') => {
                self.fault.end = self.column;
                None
            }
            State::Malformed | State::Wrong => self.refuse(self.fault, byte),
            State::Comment => {
                match byte {
                    b')' => self.state = State::Between,
                    b'(' => self.mark(State::Wrong, ErrorKind::NestedComment, at),
                    _ if is_end(byte) => {
                        let kind = ErrorKind::UnclosedComment;
                        let (at, end) = (self.first, at);
                        return self.refuse(Error { kind, at, end }, byte);
                    }
                    _ => {}
                }
                None
            }
            State::Rest => {
                if is_end(byte) {
                    self.end_line();
                }
                None
            }
            _ => {
                self.between(byte, at);
                None
            }
        }
    }

    /// A byte inside a word, behind its letter.
    #[inline(always)]
    fn in_number(&mut self, byte: u8) -> Option<Result<Word, Error>> {
        let at = self.column;
        let digits = self.state <= State::Places;
        let point = matches!(self.state, State::Places | State::Point);
        match byte {
            b' ' | b'\t' => {}
            b'0'..=b'9' => {
                self.begin(at);
                self.state = if point { State::Places } else { State::Whole };
                let digit = byte.wrapping_sub(b'0');
                if self.count < SHORT {
                    self.append(digit);
                } else {
                    self.append_long(digit, point);
                }
                return None;
            }
            b'.' if !point => {
                self.begin(at);
                self.end = at.wrapping_add(1);
                self.state = if digits { State::Places } else { State::Point };
            }
            b'+' | b'-' if self.state == State::Letter => {
                self.begin(at);
                self.end = at.wrapping_add(1);
                self.negative = byte == b'-';
                self.state = State::Sign;
            }
            b'.' | b'+' | b'-' => self.mark(State::Malformed, ErrorKind::MalformedNumber, at),
            b',' if !point => self.mark(State::Malformed, ErrorKind::DecimalComma, at),
            b'#' | b'[' if !digits => self.mark(State::Malformed, ErrorKind::Expression, at),
            _ if !digits => {
                self.column = at.wrapping_add(1);
                let kind = ErrorKind::MissingNumber(self.letter);
                let (at, end) = (self.letter_at, self.end);
                return self.refuse(Error { kind, at, end }, byte);
            }
            _ => {
                let word = self.word();
                self.column = at.wrapping_add(1);
                self.state = State::Between;
                self.between(byte, at);
                return Some(Ok(word));
            }
        }
        self.column = at.wrapping_add(1);
        None
    }

    /// The number starts here, unless it has started.
    fn begin(&mut self, at: usize) {
        if self.state == State::Letter {
            self.first = at;
        }
    }

    /// A digit beyond the ninth.
    #[cold]
    #[inline(never)]
    fn append_long(&mut self, digit: u8, point: bool) {
        if self.count == SHORT {
            self.long = Decimal::short(self.short, self.places, false);
            self.count = SHORT.wrapping_add(1);
        }
        let pushed = if point {
            self.long.push_place(digit)
        } else {
            self.long.push_whole(digit)
        };
        let at = self.column;
        self.column = at.wrapping_add(1);
        self.end = self.column;
        if let Err(kind) = pushed {
            self.mark(State::Malformed, kind, at);
            self.fault.at = self.first;
        }
    }

    /// The word that is complete now.
    #[inline(always)]
    fn word(&self) -> Word {
        let value = if self.count <= SHORT {
            Decimal::short(self.short, self.places, self.negative)
        } else if self.negative {
            self.long.negated()
        } else {
            self.long
        };
        Word {
            letter: self.letter,
            value,
            at: self.letter_at,
            end: self.end,
        }
    }

    /// A byte between words.
    #[inline(always)]
    fn between(&mut self, byte: u8, at: usize) {
        let letter = byte & !0x20;
        if letter.wrapping_sub(b'A') < 26 && self.before < Before::Percent {
            self.deleted &= self.before != Before::Nothing;
            self.before = if letter == b'N' && self.before < Before::Number {
                Before::Number
            } else {
                Before::Words
            };
            (self.letter, self.letter_at, self.end) = (letter, at, self.column);
            (self.short, self.count, self.places) = (0, 0, 0);
            (self.negative, self.state) = (false, State::Letter);
        } else {
            self.mark_between(byte, at);
        }
    }

    /// A byte between words that is no letter.
    fn mark_between(&mut self, byte: u8, at: usize) {
        if is_end(byte) {
            self.end_line();
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

    /// Keeps an error at one byte until the next.
    fn mark(&mut self, state: State, kind: ErrorKind, at: usize) {
        self.state = state;
        self.fault = Error {
            kind,
            at,
            end: at.wrapping_add(1),
        };
    }

    /// Hands over an error at the byte behind it.
    fn refuse(&mut self, error: Error, byte: u8) -> Option<Result<Word, Error>> {
        self.state = State::Rest;
        if is_end(byte) {
            self.end_line();
        }
        Some(Err(error))
    }

    fn end_line(&mut self) {
        self.deleted &= self.before != Before::Nothing;
        (self.state, self.before, self.column) = (State::Between, Before::Nothing, 0);
    }
}

impl Default for WordReader {
    fn default() -> Self {
        WordReader::new()
    }
}
