//! Errors of a line, with their columns.

pub(crate) mod framing;
#[cfg(feature = "program")]
pub(crate) mod parameters;

use crate::error::framing::FramingError;
#[cfg(feature = "program")]
use crate::error::parameters::Fault;
use crate::values::nm::Measure;
use core::fmt;

/// An error of one line: its kind, and the bytes that it concerns, `at..end`, counted from 0 in the
/// given text.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Error {
    /// The kind of the error.
    pub kind: ErrorKind,
    /// First byte concerned, 0-based; at most the length of the text.
    pub at: usize,
    /// One past the last byte concerned; `at <= end`.
    pub end: usize,
}

/// The kinds of errors. Letters are upper case. [`ErrorKind::code`] is the number of the message of
/// the host.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ErrorKind {
    /// A byte that cannot start a word.
    NotALetter(u8),
    /// A word without a number.
    MissingNumber(u8),
    /// A second sign or decimal point in a number.
    MalformedNumber,
    /// A parameter `#` or an expression `[ ]` where they are not supported.
    Expression,
    /// A number, or a coordinate computed from it, that is out of range.
    NumberTooLarge,
    /// A number with more digits than can be kept exactly.
    TooManyDigits,
    /// A block longer than the buffer of the dialect, which has this many characters.
    BlockTooLong(u8),
    /// A comment `(` without its `)`.
    UnclosedComment,
    /// A word that needs a whole number and has a fraction, or is too large for one.
    NotWhole(u8),
    /// A letter that is neither an axis nor a parameter here.
    UnknownWord(u8),
    /// A code that is not in the list: its letter, and its number in tenths (`None` when it has
    /// more decimal places or is out of range).
    UnknownCode(u8, Option<u16>),
    /// A code of the list that this dialect lacks: its letter and its number in tenths.
    NotOfDialect(u8, u16),
    /// A code without a word it needs.
    MissingWord(u8),
    /// A program number `O` with other words.
    NumberNotAlone,
    /// A comma instead of a decimal point.
    DecimalComma,
    /// A line that was received with a wrong checksum: see [`FramingError`].
    Checksum {
        /// The checksum in the line.
        given: u8,
        /// The checksum of the bytes of the line.
        computed: u8,
    },
    /// A line without a checksum, or with one that is not a number from 0 to 255.
    NoChecksum,
    /// The line number is not the successor of the last one.
    LineNumber(u32),
    /// A letter given twice.
    RepeatedWord(u8),
    /// A second code of the same modal group.
    TwoCodesOfOneGroup,
    /// Two codes that both use the axis words, or the same parameter.
    TwoUsersOfWords,
    /// Axis words without a motion code in effect.
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
    /// Only one word of a centre in absolute coordinates (G90.1, micromill dialect), which needs
    /// both.
    HalfCentre,
    /// An arc whose end is not on it; the radii differ by this much.
    EndOffArc(Measure),
    /// An arc with a radius and a centre.
    RadiusAndCentre,
    /// A radius smaller than half the distance to the end; the least radius that reaches it.
    RadiusTooSmall(Measure),
    /// An arc given by its radius that ends where it starts.
    RadiusToSamePoint,
    /// An arc given by its radius without an end in its plane.
    NoEnd,
    /// A feed move without a feed rate.
    NoFeed,
    /// A feed move under G93 without its own F word.
    NoInverseTime,
    /// A negative value of a word that must not be negative.
    Negative(u8),
    /// `G4` without `P`.
    NoDwellTime,
    /// A value outside the range of its code.
    OutOfRange(u8),
    /// More tools than the table holds.
    ToolTableFull,
    /// A tool that is not in the table.
    UnknownTool,
    /// A thread, a tapping cycle, a feed per revolution or a surface speed without a turning
    /// spindle.
    SpindleStopped,
    /// A code that cannot be used under G93, or at all in this feed mode.
    WrongFeedMode,
    /// A canned cycle whose retract plane is not above the bottom.
    RetractBelowBottom,
    /// A cycle with more than 2^16 passes or pecks.
    TooManyPasses,
    /// A turning cycle along a contour of several blocks, where only one block is available.
    ContourOfBlocks,
    /// There is no block with the number in `P` or `Q` at the position of the contour of a turning
    /// cycle.
    NoContour(u8),
    /// Something other than straight moves and arcs of X and Z in the contour of a turning cycle.
    NotOfContour,
    /// The contour of a roughing cycle goes back along this axis.
    Pocket(u8),
    /// The contour of a roughing cycle has more moves than there is room for.
    ContourTooLong,
    /// A roughing cycle whose start is not beside and in front of its contour.
    ContourStart,
    /// A thread whose crest and depth are not between its start and its end.
    ThreadStart,
    /// A rotary axis in a canned cycle.
    RotaryInCycle(u8),
    /// A spline outside of G17, or with words of other axes.
    SplinePlane,
    /// A probe move without length.
    NoProbeMove,
    /// A NURBS (G5.2) that another code or a move interrupts before its end (G5.3).
    NurbsOpen,
    /// The end of a NURBS (G5.3) with fewer control points than its order, or without a start.
    TooFewPoints,
    /// A code, or an arc outside of G17, that is not possible in a rotated work frame.
    RotatedFrame,
    /// A code that needs the lines around its own (M70 to M73, M98, M99), where only one line is
    /// available.
    NeedsProgram,
    /// A code that is refused while cutter compensation is on.
    UnderCompensation,
    /// An arc or a rapid as the first or the last move of cutter compensation.
    CompensationEntry,
    /// A first move of cutter compensation that is not longer than the tool radius.
    EntryTooShort(Measure),
    /// A corner of the contour that the tool cannot reach without cutting into it.
    Gouge,
    /// An inside arc of the contour smaller than the tool.
    ArcSmallerThanTool(Measure),
    /// More commands between two moves of a compensated contour than can wait for the corner, which
    /// are four.
    TooManyWaiting,
    /// Not all commands of the previous block were taken.
    CommandsWaiting,
    /// A fault of parameters, expressions or the flow of a program.
    #[cfg(feature = "program")]
    Program(Fault),
}

impl From<FramingError> for ErrorKind {
    fn from(error: FramingError) -> ErrorKind {
        match error {
            FramingError::Checksum { given, computed } => ErrorKind::Checksum { given, computed },
            FramingError::NoChecksum | FramingError::MalformedChecksum => ErrorKind::NoChecksum,
            FramingError::NoNumber => ErrorKind::NotWhole(b'N'),
            FramingError::Number { given, .. } => ErrorKind::LineNumber(given),
        }
    }
}

impl ErrorKind {
    /// The number of the message: 301 for E0301.
    #[inline(never)]
    pub const fn code(self) -> u16 {
        match self {
            ErrorKind::NotALetter(_) => 101,
            ErrorKind::MissingNumber(_) | ErrorKind::MalformedNumber | ErrorKind::Expression => 102,
            ErrorKind::NumberTooLarge | ErrorKind::TooManyDigits => 103,
            ErrorKind::BlockTooLong(_) => 104,
            ErrorKind::UnclosedComment => 105,
            ErrorKind::NotWhole(_) => 107,
            ErrorKind::DecimalComma => 108,
            ErrorKind::Checksum { .. } | ErrorKind::NoChecksum => 110,
            ErrorKind::LineNumber(_) => 111,
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
            ErrorKind::NotOfDialect(..) => 212,
            ErrorKind::MissingWord(_) => 213,
            ErrorKind::NumberNotAlone => 214,
            ErrorKind::RotaryInCycle(_) => 215,
            ErrorKind::ContourOfBlocks => 216,
            ErrorKind::UnderCompensation => 217,
            ErrorKind::NoContour(_) => 218,
            ErrorKind::NotOfContour => 219,
            ErrorKind::NeedsProgram => 220,
            ErrorKind::NoCentre | ErrorKind::HalfCentre => 301,
            ErrorKind::EndOffArc(_) => 302,
            ErrorKind::RadiusAndCentre => 303,
            ErrorKind::RadiusTooSmall(_) => 304,
            ErrorKind::RadiusToSamePoint => 305,
            ErrorKind::NoEnd => 306,
            ErrorKind::NoFeed | ErrorKind::NoInverseTime => 501,
            ErrorKind::Negative(_) => 502,
            ErrorKind::NoDwellTime => 504,
            ErrorKind::OutOfRange(_) | ErrorKind::TooManyPasses => 505,
            ErrorKind::ToolTableFull | ErrorKind::UnknownTool => 506,
            ErrorKind::SpindleStopped => 507,
            ErrorKind::WrongFeedMode => 508,
            ErrorKind::RetractBelowBottom => 310,
            ErrorKind::SplinePlane => 311,
            ErrorKind::NoProbeMove => 312,
            ErrorKind::NurbsOpen => 313,
            ErrorKind::TooFewPoints => 314,
            ErrorKind::RotatedFrame => 315,
            ErrorKind::CompensationEntry => 320,
            ErrorKind::EntryTooShort(_) => 321,
            ErrorKind::Gouge => 322,
            ErrorKind::ArcSmallerThanTool(_) => 323,
            ErrorKind::TooManyWaiting => 324,
            ErrorKind::CommandsWaiting => 509,
            ErrorKind::Pocket(_) => 330,
            ErrorKind::ContourTooLong => 331,
            ErrorKind::ContourStart => 332,
            ErrorKind::ThreadStart => 333,
            #[cfg(feature = "program")]
            ErrorKind::Program(fault) => fault.code(),
        }
    }
}

impl fmt::Display for ErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fixed = match *self {
            #[cfg(feature = "program")]
            ErrorKind::Program(fault) => return fault.fmt(f),
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
            ErrorKind::NotOfDialect(letter, tenths) => {
                write!(f, "known code `{}{}", char::from(letter), tenths / 10)?;
                return match tenths % 10 {
                    0 => write!(f, "`, not of this dialect"),
                    tenth => write!(f, ".{tenth}`, not of this dialect"),
                };
            }
            ErrorKind::MissingWord(letter) => {
                return write!(f, "code without its `{}`", char::from(letter));
            }
            ErrorKind::OutOfRange(letter) => {
                return write!(f, "value of `{}` out of range", char::from(letter));
            }
            ErrorKind::RotaryInCycle(letter) => {
                return write!(f, "rotary axis `{}` in a canned cycle", char::from(letter));
            }
            ErrorKind::NoContour(letter) => {
                return write!(f, "no block with the number in `{}`", char::from(letter));
            }
            ErrorKind::Pocket(letter) => {
                return write!(f, "contour goes back in {}", char::from(letter));
            }
            ErrorKind::EntryTooShort(least) => {
                return write!(
                    f,
                    "first move of the compensation is not longer than the tool radius of \
                     {least} mm"
                );
            }
            ErrorKind::ArcSmallerThanTool(radius) => {
                return write!(
                    f,
                    "inside arc is smaller than the tool radius of {radius} mm"
                );
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
            ErrorKind::NumberNotAlone => "program number with other words",
            ErrorKind::DecimalComma => "comma in a number",
            ErrorKind::NoChecksum => "numbered line without a checksum",
            ErrorKind::Checksum { given, computed } => {
                return write!(f, "checksum is {given}, the line has {computed}");
            }
            ErrorKind::LineNumber(given) => {
                return write!(f, "line number {given} is not the next one");
            }
            ErrorKind::ToolTableFull => "tool table is full",
            ErrorKind::UnknownTool => "tool is not in the table",
            ErrorKind::SpindleStopped => "needs a turning spindle",
            ErrorKind::WrongFeedMode => "not in this feed mode",
            ErrorKind::RetractBelowBottom => "retract plane is below the bottom",
            ErrorKind::TooManyPasses => "too many passes",
            ErrorKind::ContourOfBlocks => {
                "cycle along a contour of several blocks needs the whole program"
            }
            ErrorKind::NotOfContour => "not in a contour of a turning cycle",
            ErrorKind::ContourTooLong => "contour with too many moves",
            ErrorKind::ContourStart => "contour is not beside the start of the cycle",
            ErrorKind::ThreadStart => "thread does not begin outside of its crest",
            ErrorKind::CommandsWaiting => "commands of the block before are still to be taken",
            ErrorKind::TooManyWaiting => {
                "too many commands between two moves of a compensated contour"
            }
            ErrorKind::SplinePlane => "spline outside of the XY plane",
            ErrorKind::NoProbeMove => "probe move without length",
            ErrorKind::NurbsOpen => "NURBS is not ended by `G5.3`",
            ErrorKind::TooFewPoints => "NURBS with fewer control points than its order",
            ErrorKind::RotatedFrame => "not in a rotated work frame",
            ErrorKind::NeedsProgram => "code needs the whole program",
            ErrorKind::UnderCompensation => "not while cutter compensation is on",
            ErrorKind::CompensationEntry => {
                "cutter compensation starts and ends with a straight move in its plane"
            }
            ErrorKind::Gouge => "tool cannot reach this corner without gouging",
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
