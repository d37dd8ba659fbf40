//! Reasons for refusing a block, before the columns of its words are looked up.

use crate::codes::code::Group;
use crate::error::ErrorKind;
use crate::values::nm::Measure;
use core::num::NonZeroU32;

/// The kinds of [`ErrorKind`] that a whole block can have.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[repr(u8)]
pub(crate) enum Reason {
    NumberTooLarge,
    NotWhole,
    UnknownWord,
    MissingWord,
    NumberNotAlone,
    TwoUsersOfWords,
    AxisWordsWithoutMotion,
    NoAxisWords,
    UnusedWord,
    MachineFrame,
    ZNotAlone,
    NotZero,
    NoCentre,
    HalfCentre,
    EndOffArc,
    RadiusAndCentre,
    RadiusTooSmall,
    RadiusToSamePoint,
    NoEnd,
    NoFeed,
    NoInverseTime,
    Negative,
    NoDwellTime,
    OutOfRange,
    #[cfg(feature = "extended")]
    ToolTableFull,
    #[cfg(feature = "extended")]
    UnknownTool,
    #[cfg(feature = "extended")]
    SpindleStopped,
    WrongFeedMode,
    #[cfg(feature = "extended")]
    RetractBelowBottom,
    #[cfg(feature = "extended")]
    TooManyPasses,
    #[cfg(feature = "extended")]
    ContourOfBlocks,
    #[cfg(feature = "extended")]
    NoContour,
    #[cfg(feature = "extended")]
    ContourStart,
    #[cfg(feature = "extended")]
    ThreadStart,
    #[cfg(feature = "extended")]
    NotOfContour,
    #[cfg(feature = "extended")]
    RotaryInCycle,
    #[cfg(feature = "extended")]
    SplinePlane,
    NoProbeMove,
    #[cfg(feature = "extended")]
    NurbsOpen,
    #[cfg(feature = "extended")]
    TooFewPoints,
    #[cfg(feature = "extended")]
    RotatedFrame,
    #[cfg(feature = "extended")]
    NeedsProgram,
    #[cfg(feature = "extended")]
    UnderCompensation,
}

/// The words of a block that are at fault.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Place {
    /// The word of the letter.
    Word,
    /// All axis words: from the first to the last of them.
    Axes,
    /// The motion code, or the first axis word where the motion is modal.
    Motion,
    /// The code of the group of this number.
    Code(u8),
}

/// An error in a register, before its columns and its measure are looked up. Many functions pass it
/// on; an [`Error`](crate::Error) would take memory and a copy in each of them.
///
/// From the lowest byte on: the reason, from 1; the letter of the word, or 0; the place of
/// the words, with groups from 3 on.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) struct Fault(NonZeroU32);

const AXES: u32 = 1;
const MOTION: u32 = 2;
const CODES: u32 = 3;

impl Fault {
    #[inline(always)]
    const fn new(reason: Reason, letter: u8, place: u32) -> Fault {
        let reason = NonZeroU32::MIN.saturating_add(reason as u32);
        Fault(reason.saturating_add((letter as u32) << 8 | place << 16))
    }

    /// A fault at the word of a letter, and about that letter.
    #[inline(always)]
    pub(crate) const fn at(reason: Reason, letter: u8) -> Fault {
        Fault::new(reason, letter, 0)
    }

    #[inline(always)]
    pub(crate) const fn at_code(reason: Reason, group: Group) -> Fault {
        Fault::new(reason, 0, CODES + group as u32)
    }

    #[inline(always)]
    pub(crate) const fn at_axes(reason: Reason) -> Fault {
        Fault::new(reason, 0, AXES)
    }

    #[inline(always)]
    pub(crate) const fn at_motion(reason: Reason) -> Fault {
        Fault::new(reason, 0, MOTION)
    }

    /// A fault about the word of a letter, which may be absent.
    #[inline(always)]
    pub(crate) const fn of(self, letter: u8) -> Fault {
        Fault(self.0.saturating_add((letter as u32) << 8))
    }

    /// The same fault about the word of another letter.
    pub(crate) const fn with_letter(self, letter: u8) -> Fault {
        let others = self.0.get() & !0xff00;
        match NonZeroU32::new(others | (letter as u32) << 8) {
            Some(fault) => Fault(fault),
            None => self,
        }
    }

    /// The letter of the word, or 0.
    pub(crate) const fn letter(self) -> u8 {
        (self.0.get() >> 8) as u8
    }

    pub(crate) const fn place(self) -> Place {
        match self.0.get() >> 16 {
            0 => Place::Word,
            AXES => Place::Axes,
            MOTION => Place::Motion,
            code => Place::Code(code.wrapping_sub(CODES) as u8),
        }
    }

    /// The kind of the error; the measure is that of an arc that does not fit.
    #[cold]
    pub(crate) fn kind(self, measure: Measure) -> ErrorKind {
        let letter = self.letter();
        let number = (self.0.get() as u8).wrapping_sub(1);
        match number {
            n if n == Reason::NotWhole as u8 => ErrorKind::NotWhole(letter),
            n if n == Reason::UnknownWord as u8 => ErrorKind::UnknownWord(letter),
            n if n == Reason::MissingWord as u8 => ErrorKind::MissingWord(letter),
            n if n == Reason::NumberNotAlone as u8 => ErrorKind::NumberNotAlone,
            n if n == Reason::TwoUsersOfWords as u8 => ErrorKind::TwoUsersOfWords,
            n if n == Reason::AxisWordsWithoutMotion as u8 => ErrorKind::AxisWordsWithoutMotion,
            n if n == Reason::NoAxisWords as u8 => ErrorKind::NoAxisWords,
            n if n == Reason::UnusedWord as u8 => ErrorKind::UnusedWord(letter),
            n if n == Reason::MachineFrame as u8 => ErrorKind::MachineFrame,
            n if n == Reason::ZNotAlone as u8 => ErrorKind::ZNotAlone,
            n if n == Reason::NotZero as u8 => ErrorKind::NotZero(letter),
            n if n == Reason::NoCentre as u8 => ErrorKind::NoCentre,
            n if n == Reason::HalfCentre as u8 => ErrorKind::HalfCentre,
            n if n == Reason::EndOffArc as u8 => ErrorKind::EndOffArc(measure),
            n if n == Reason::RadiusAndCentre as u8 => ErrorKind::RadiusAndCentre,
            n if n == Reason::RadiusTooSmall as u8 => ErrorKind::RadiusTooSmall(measure),
            n if n == Reason::RadiusToSamePoint as u8 => ErrorKind::RadiusToSamePoint,
            n if n == Reason::NoEnd as u8 => ErrorKind::NoEnd,
            n if n == Reason::NoFeed as u8 => ErrorKind::NoFeed,
            n if n == Reason::NoInverseTime as u8 => ErrorKind::NoInverseTime,
            n if n == Reason::Negative as u8 => ErrorKind::Negative(letter),
            n if n == Reason::NoDwellTime as u8 => ErrorKind::NoDwellTime,
            n if n == Reason::OutOfRange as u8 => ErrorKind::OutOfRange(letter),
            #[cfg(feature = "extended")]
            n if n == Reason::ToolTableFull as u8 => ErrorKind::ToolTableFull,
            #[cfg(feature = "extended")]
            n if n == Reason::UnknownTool as u8 => ErrorKind::UnknownTool,
            #[cfg(feature = "extended")]
            n if n == Reason::SpindleStopped as u8 => ErrorKind::SpindleStopped,
            n if n == Reason::WrongFeedMode as u8 => ErrorKind::WrongFeedMode,
            #[cfg(feature = "extended")]
            n if n == Reason::RetractBelowBottom as u8 => ErrorKind::RetractBelowBottom,
            #[cfg(feature = "extended")]
            n if n == Reason::TooManyPasses as u8 => ErrorKind::TooManyPasses,
            #[cfg(feature = "extended")]
            n if n == Reason::ContourOfBlocks as u8 => ErrorKind::ContourOfBlocks,
            #[cfg(feature = "extended")]
            n if n == Reason::NoContour as u8 => ErrorKind::NoContour(letter),
            #[cfg(feature = "extended")]
            n if n == Reason::ContourStart as u8 => ErrorKind::ContourStart,
            #[cfg(feature = "extended")]
            n if n == Reason::ThreadStart as u8 => ErrorKind::ThreadStart,
            #[cfg(feature = "extended")]
            n if n == Reason::NotOfContour as u8 => ErrorKind::NotOfContour,
            #[cfg(feature = "extended")]
            n if n == Reason::RotaryInCycle as u8 => ErrorKind::RotaryInCycle(letter),
            #[cfg(feature = "extended")]
            n if n == Reason::SplinePlane as u8 => ErrorKind::SplinePlane,
            n if n == Reason::NoProbeMove as u8 => ErrorKind::NoProbeMove,
            #[cfg(feature = "extended")]
            n if n == Reason::NurbsOpen as u8 => ErrorKind::NurbsOpen,
            #[cfg(feature = "extended")]
            n if n == Reason::TooFewPoints as u8 => ErrorKind::TooFewPoints,
            #[cfg(feature = "extended")]
            n if n == Reason::RotatedFrame as u8 => ErrorKind::RotatedFrame,
            #[cfg(feature = "extended")]
            n if n == Reason::NeedsProgram as u8 => ErrorKind::NeedsProgram,
            #[cfg(feature = "extended")]
            n if n == Reason::UnderCompensation as u8 => ErrorKind::UnderCompensation,
            // Reason::NumberTooLarge.
            _ => ErrorKind::NumberTooLarge,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_keep_what_they_are_of() {
        let fault = Fault::at(Reason::Negative, b'F');
        assert_eq!((fault.letter(), fault.place()), (b'F', Place::Word));
        let fault = Fault::at_code(Reason::MissingWord, Group::NonModal).of(b'P');
        let place = Place::Code(Group::NonModal as u8);
        assert_eq!((fault.letter(), fault.place()), (b'P', place));
        assert_eq!(
            fault.kind(Measure::of(crate::Nm(0))),
            ErrorKind::MissingWord(b'P')
        );
        assert_eq!(
            Fault::at(Reason::NotZero, b'X').kind(Measure::of(crate::Nm(0))),
            ErrorKind::NotZero(b'X')
        );
        assert_eq!(size_of::<Result<(), Fault>>(), 4);
    }
}
