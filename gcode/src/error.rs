//! What can be wrong with a line, and where.

use crate::nm::Nm;
use core::fmt;

/// An error of one line: its kind and the bytes it is about, `at..end`, counted from 0 in the text given.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct Error {
    /// What is wrong.
    pub kind: ErrorKind,
    /// First byte concerned, 0-based; at most the length of the text.
    pub at: usize,
    /// One behind the last byte concerned; `at <= end`.
    pub end: usize,
}

/// The kinds of error. Letters are upper case; [`ErrorKind::code`] is the number of the host's message.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A byte that cannot start a word.
    NotALetter(u8),
    /// A word without a number.
    MissingNumber(u8),
    /// A second sign or decimal point in a number.
    MalformedNumber,
    /// A parameter `#` or an expression `[ ]`, which are not taken.
    Expression,
    /// A number, or a coordinate made with it, beyond what can be represented.
    NumberTooLarge,
    /// A number with more digits than can be kept exactly.
    TooManyDigits,
    /// A block longer than the dialect's buffer of so many characters.
    BlockTooLong(u8),
    /// A comment `(` without its `)`.
    UnclosedComment,
    /// A `(` inside a comment.
    NestedComment,
    /// A word that needs a whole number and has a fraction, or is too large for one.
    NotWhole(u8),
    /// A letter that is no axis and no parameter here.
    UnknownWord(u8),
    /// A code outside the list: its letter, and its number in tenths (`None` when it has more places or is out of range).
    UnknownCode(u8, Option<u16>),
    /// A letter given twice.
    RepeatedWord(u8),
    /// A second code of the same modal group.
    TwoCodesOfOneGroup,
    /// Two codes that both want the axis words, or the same parameter.
    TwoUsersOfWords,
    /// Axis words, and no code in effect that moves.
    AxisWordsWithoutMotion,
    /// A code that needs axis words and has none.
    NoAxisWords,
    /// A word that no code in the block uses.
    UnusedWord(u8),
    /// `G53` without G0 or G1, or with incremental distances.
    MachineFrame,
    /// `Z` in one string with other axes (micromill dialect).
    ZNotAlone,
    /// A coordinate of `G28` that is not zero (micromill dialect).
    NotZero(u8),
    /// An arc without a centre and without a radius, or with its centre at its start.
    NoCentre,
    /// One word of a centre given in absolute coordinates (G90.1, micromill dialect), which takes both.
    HalfCentre,
    /// An arc whose end is not on it: radii differ by so much.
    EndOffArc(Nm),
    /// An arc with a radius and a centre.
    RadiusAndCentre,
    /// A radius smaller than half the distance to the end; the least radius that reaches it.
    RadiusTooSmall(Nm),
    /// An arc given by its radius that ends where it starts.
    RadiusToSamePoint,
    /// An arc given by its radius without an end in its plane.
    NoEnd,
    /// A feed move without a feed rate.
    NoFeed,
    /// A feed move under G93 without an F word of its own.
    NoInverseTime,
    /// A negative value of a word that must not be negative.
    Negative(u8),
    /// `G4` without `P`.
    NoDwellTime,
}

impl ErrorKind {
    /// The number of the message: 301 for E0301.
    pub const fn code(self) -> u16 {
        match self {
            ErrorKind::NotALetter(_) => 101,
            ErrorKind::MissingNumber(_) | ErrorKind::MalformedNumber | ErrorKind::Expression => 102,
            ErrorKind::NumberTooLarge | ErrorKind::TooManyDigits => 103,
            ErrorKind::BlockTooLong(_) => 104,
            ErrorKind::UnclosedComment => 105,
            ErrorKind::NestedComment => 106,
            ErrorKind::NotWhole(_) => 107,
            ErrorKind::UnknownWord(_) => 201,
            ErrorKind::UnknownCode(..) => 202,
            ErrorKind::RepeatedWord(_) => 203,
            ErrorKind::TwoCodesOfOneGroup => 204,
            ErrorKind::TwoUsersOfWords => 205,
            ErrorKind::AxisWordsWithoutMotion => 206,
            ErrorKind::NoAxisWords => 207,
            ErrorKind::UnusedWord(_) => 208,
            ErrorKind::MachineFrame => 209,
            ErrorKind::ZNotAlone => 210,
            ErrorKind::NotZero(_) => 211,
            ErrorKind::NoCentre | ErrorKind::HalfCentre => 301,
            ErrorKind::EndOffArc(_) => 302,
            ErrorKind::RadiusAndCentre => 303,
            ErrorKind::RadiusTooSmall(_) => 304,
            ErrorKind::RadiusToSamePoint => 305,
            ErrorKind::NoEnd => 306,
            ErrorKind::NoFeed | ErrorKind::NoInverseTime => 501,
            ErrorKind::Negative(_) => 502,
            ErrorKind::NoDwellTime => 504,
        }
    }
}

impl fmt::Display for ErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fixed = match *self {
            ErrorKind::NotALetter(byte) if byte.is_ascii_graphic() => {
                return write!(
                    f,
                    "`{}` is not a letter where a word starts",
                    char::from(byte)
                );
            }
            ErrorKind::NotALetter(byte) => {
                return write!(f, "byte 0x{byte:02x} where a word starts");
            }
            ErrorKind::MissingNumber(letter) => {
                return write!(f, "`{}` without a number", char::from(letter));
            }
            ErrorKind::NotWhole(letter) => {
                return write!(f, "`{}` takes a whole number", char::from(letter));
            }
            ErrorKind::UnknownWord(letter) => {
                return write!(f, "unknown word `{}`", char::from(letter));
            }
            ErrorKind::UnknownCode(letter, None) => {
                return write!(f, "unknown {} code", char::from(letter));
            }
            ErrorKind::UnknownCode(letter, Some(tenths)) => {
                write!(
                    f,
                    "unknown {0} code `{0}{1}",
                    char::from(letter),
                    tenths / 10
                )?;
                return match tenths % 10 {
                    0 => write!(f, "`"),
                    tenth => write!(f, ".{tenth}`"),
                };
            }
            ErrorKind::RepeatedWord(letter) => {
                return write!(f, "word `{}` repeated", char::from(letter));
            }
            ErrorKind::UnusedWord(letter) => {
                return write!(f, "word `{}` is not used by anything", char::from(letter));
            }
            ErrorKind::EndOffArc(by) => {
                return write!(
                    f,
                    "the end point is not on the arc: radius differs by {by} mm"
                );
            }
            ErrorKind::RadiusTooSmall(least) => {
                return write!(f, "radius is too small: at least {least} mm");
            }
            ErrorKind::NotZero(letter) => {
                return write!(f, "`{}` of `G28` must be zero", char::from(letter));
            }
            ErrorKind::Negative(letter) => return write!(f, "negative `{}`", char::from(letter)),
            ErrorKind::BlockTooLong(limit) => {
                return write!(f, "block longer than the buffer of {limit} characters");
            }
            ErrorKind::MalformedNumber => "malformed number",
            ErrorKind::Expression => "parameters and expressions are not supported",
            ErrorKind::NumberTooLarge => "number too large",
            ErrorKind::TooManyDigits => "number with too many digits",
            ErrorKind::UnclosedComment => "comment without its closing parenthesis",
            ErrorKind::NestedComment => "comment inside a comment",
            ErrorKind::TwoCodesOfOneGroup => "two codes of one modal group",
            ErrorKind::TwoUsersOfWords => "two codes that use the same words",
            ErrorKind::AxisWordsWithoutMotion => "axis words and no motion mode",
            ErrorKind::NoAxisWords => "code without axis words",
            ErrorKind::MachineFrame => "`G53` needs `G0` or `G1` and absolute distances",
            ErrorKind::ZNotAlone => "`Z` must be alone in its string",
            ErrorKind::NoCentre => "arc without a centre or a radius",
            ErrorKind::HalfCentre => "absolute arc centre with one word of two",
            ErrorKind::RadiusAndCentre => "arc has both a radius and a centre",
            ErrorKind::RadiusToSamePoint => "arc given by its radius ends where it starts",
            ErrorKind::NoEnd => "arc without an end in its plane",
            ErrorKind::NoFeed => "feed move before any feed rate",
            ErrorKind::NoInverseTime => "feed move without its own F under G93",
            ErrorKind::NoDwellTime => "dwell without `P`",
        };
        f.write_str(fixed)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(f)
    }
}

impl core::error::Error for Error {}
