//! Errors and warnings of lines of a drill file.

use core::fmt;

/// An error of one line: its kind and the bytes `at..end` that it concerns, counted from 0 in the
/// line.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Error {
    /// The kind of the error.
    pub kind: ErrorKind,
    /// First byte concerned, 0-based, at most the length of the line.
    pub at: usize,
    /// End of the bytes concerned, exclusive; `at <= end`.
    pub end: usize,
}

/// The kinds of error. Letters are upper case. [`ErrorKind::code`] is the number of the host's
/// message.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ErrorKind {
    /// A byte that cannot start a word.
    NotALetter(u8),
    /// A byte that is not text. Binary (EIA) files are not supported.
    NotText(u8),
    /// A Gerber command: the file holds no drill data.
    Gerber,
    /// A word without a number.
    MissingNumber(u8),
    /// A second point in a number.
    MalformedNumber,
    /// A number out of range: a coordinate beyond [`LIMIT_NM`](crate::LIMIT_NM), a tool above
    /// 65535, more than 9999 repeats.
    NumberTooLarge,
    /// A number of more than 18 digits.
    TooManyDigits,
    /// A word that requires an integer without sign.
    NotWhole(u8),
    /// A letter that is not a word of a drill file.
    UnknownWord(u8),
    /// A G or M code that is not supported.
    UnknownCode(u8, u16),
    /// An unknown command name outside a header.
    UnknownName,
    /// A repeated letter.
    RepeatedWord(u8),
    /// A hole or a slot before any tool.
    NoTool,
    /// A tool with a diameter of zero or less.
    NoDiameter,
    /// Step and repeat (M01, M02, M08, M25 and their codes), for a reader without patterns.
    StepAndRepeat,
    /// Step and repeat out of order. The order is M25, the pattern, M01, an M02 for each copy, M08.
    /// Also `R0` with M02.
    PatternOrder,
    /// `R` without a hole before it.
    NothingToRepeat,
    /// `R` with a slot or in a rout.
    RepeatOfSlot,
    /// More tools than the reader has room for.
    TooManyTools,
    /// `G85` without both ends of the slot.
    HalfSlot,
    /// An origin other than zero.
    Origin,
    /// A circular rout without `A`, or without `I` and `J`.
    NoCentre,
}

impl ErrorKind {
    /// Returns the number of the message: 901 for E0901.
    pub const fn code(self) -> u16 {
        match self {
            ErrorKind::NotALetter(_) => 101,
            ErrorKind::MissingNumber(_) | ErrorKind::MalformedNumber => 102,
            ErrorKind::NumberTooLarge | ErrorKind::TooManyDigits => 103,
            ErrorKind::NotWhole(_) => 107,
            ErrorKind::UnknownWord(_) | ErrorKind::UnknownName => 201,
            ErrorKind::UnknownCode(..) => 202,
            ErrorKind::RepeatedWord(_) => 203,
            ErrorKind::NoCentre => 301,
            ErrorKind::NotText(_) => 901,
            ErrorKind::Gerber => 902,
            ErrorKind::NoTool => 903,
            ErrorKind::StepAndRepeat => 904,
            ErrorKind::PatternOrder => 911,
            ErrorKind::NothingToRepeat | ErrorKind::RepeatOfSlot => 905,
            ErrorKind::TooManyTools => 906,
            ErrorKind::HalfSlot => 907,
            ErrorKind::Origin => 908,
            ErrorKind::NoDiameter => 909,
        }
    }
}

impl fmt::Display for ErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fixed = match *self {
            ErrorKind::NotALetter(byte) => {
                let byte = char::from(byte);
                return write!(f, "`{byte}` is not a letter where a word starts");
            }
            ErrorKind::NotText(byte) => {
                return write!(f, "byte 0x{byte:02x} is not text: a binary drill file?");
            }
            ErrorKind::MissingNumber(letter) => {
                return write!(f, "`{}` without a number", char::from(letter));
            }
            ErrorKind::NotWhole(letter) => {
                return write!(
                    f,
                    "`{}` requires an integer without sign",
                    char::from(letter)
                );
            }
            ErrorKind::UnknownWord(letter) => {
                return write!(f, "unknown word `{}`", char::from(letter));
            }
            ErrorKind::UnknownCode(letter, number) => {
                return write!(f, "`{}{number:02}` is not supported", char::from(letter));
            }
            ErrorKind::RepeatedWord(letter) => {
                return write!(f, "word `{}` repeated", char::from(letter));
            }
            ErrorKind::Gerber => "a Gerber file, not a drill file",
            ErrorKind::MalformedNumber => "malformed number",
            ErrorKind::NumberTooLarge => "number too large",
            ErrorKind::TooManyDigits => "number with too many digits",
            ErrorKind::UnknownName => "unknown command",
            ErrorKind::NoTool => "hole before any tool",
            ErrorKind::NoDiameter => "tool diameter is not above zero",
            ErrorKind::StepAndRepeat => "step and repeat is not supported",
            ErrorKind::PatternOrder => "step and repeat out of order",
            ErrorKind::NothingToRepeat => "`R` without a hole before it",
            ErrorKind::RepeatOfSlot => "`R` repeats holes, not slots",
            ErrorKind::TooManyTools => "too many tools",
            ErrorKind::HalfSlot => "`G85` requires both ends of the slot",
            ErrorKind::Origin => "an origin other than zero is not supported",
            ErrorKind::NoCentre => "circular rout without a centre or a radius",
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

/// A warning about a line that is read: its kind and the bytes it concerns.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Warning {
    /// The kind of the warning.
    pub kind: WarningKind,
    /// First byte concerned, 0-based, at most the length of the line.
    pub at: usize,
    /// End of the bytes concerned, exclusive; `at <= end`.
    pub end: usize,
}

/// The kinds of warning. [`WarningKind::code`] is the number of the host's message.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum WarningKind {
    /// A code without a meaning for holes.
    Ignored,
    /// An unknown name in a header.
    UnknownName,
    /// A coordinate in a header. The header ends before it.
    HeaderNotEnded,
    /// A tool that is redefined with another diameter.
    Redefined(u16),
    /// A selected tool of unknown diameter.
    NoDiameter(u16),
    /// A rout with the tool up. It is a move and cuts no slot.
    ToolUp,
    /// Text after the end of the program.
    AfterEnd,
}

impl WarningKind {
    /// Returns the number of the message: 921 for W0921.
    pub const fn code(self) -> u16 {
        match self {
            WarningKind::Ignored => 921,
            WarningKind::UnknownName => 922,
            WarningKind::HeaderNotEnded => 923,
            WarningKind::Redefined(_) => 924,
            WarningKind::NoDiameter(_) => 925,
            WarningKind::ToolUp => 926,
            WarningKind::AfterEnd => 927,
        }
    }
}

impl fmt::Display for WarningKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fixed = match *self {
            WarningKind::Redefined(tool) => {
                return write!(f, "tool T{tool} gets another diameter");
            }
            WarningKind::NoDiameter(tool) => {
                return write!(f, "the diameter of tool T{tool} is unknown");
            }
            WarningKind::Ignored => "ignored: has no meaning for holes",
            WarningKind::UnknownName => "unknown header command, ignored",
            WarningKind::HeaderNotEnded => "coordinate in a header that was not ended",
            WarningKind::ToolUp => "rout with the tool up: nothing is cut",
            WarningKind::AfterEnd => "text after the end of the program, ignored",
        };
        f.write_str(fixed)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(f)
    }
}
