//! The words and codes given in a block, as the stages of the modal state query them.

use super::{Block, Span};
use crate::blocks::fault::{Fault, Place, Reason};
use crate::codes::axes::Axes;
use crate::codes::code::{Code, Group};
#[cfg(all(feature = "program", feature = "extended"))]
use crate::codes::letters::LETTERS;
use crate::codes::letters::{AXES, Letters, axis_letter, bit, first_of, slot_of};
#[cfg(feature = "extended")]
use crate::codes::letters::{POLAR_ANGLE, POLAR_RADIUS};
use crate::error::Error;
use crate::features::EXTENDED;
use crate::values::decimal::Decimal;
use crate::values::nm::Measure;

/// Slot of U; the slots of V and W follow.
const INCREMENTS: u8 = 21;

/// The words of axes, those of polar coordinates included.
const AXIS_WORDS: u32 = Letters::new(b"XYZABCUV").0;

/// The letters under which polar coordinates are stored.
#[cfg(feature = "extended")]
pub(crate) const POLAR: Letters = Letters::new(&[POLAR_RADIUS, POLAR_ANGLE]);

/// The letters that need a code that uses them.
const CLAIMED: Letters = Letters::new(b"IJKRPDEHLQ");

impl Block {
    /// The value of a word, by its upper-case letter; `None` when the block has none (always for G
    /// and M).
    pub fn word(&self, letter: u8) -> Option<Decimal> {
        self.value(letter).copied()
    }

    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub(crate) fn value(&self, letter: u8) -> Option<&Decimal> {
        self.slot(slot_of(letter))
    }

    /// Whether one of these words is given.
    #[inline]
    pub(crate) const fn has_any(&self, letters: Letters) -> bool {
        self.present & letters.0 != 0
    }

    /// Whether all of these words are given.
    #[inline]
    pub(crate) const fn has_all(&self, letters: Letters) -> bool {
        self.present & letters.0 == letters.0
    }

    /// The largest number of decimal places among these words.
    pub(crate) fn most_places(&self, letters: Letters) -> u8 {
        let (mut given, mut most) = (self.present & letters.0, 0);
        for value in &self.values {
            if given == 0 {
                break;
            }
            if given & 1 != 0 {
                most = value.places().max(most);
            }
            given >>= 1;
        }
        most
    }

    /// Whether a word is below zero.
    pub(crate) fn is_negative(&self, letter: u8) -> bool {
        self.value(letter).is_some_and(|value| value.is_negative())
    }

    /// Whether the block starts with `/`, so that it is skipped if block delete is on.
    pub const fn is_deleted(&self) -> bool {
        self.deleted
    }

    /// Whether the block requests nothing: no code and no word except `N`.
    pub fn is_empty(&self) -> bool {
        self.present & !bit(b'N') == 0 && self.groups == 0
    }

    /// The number after `N`, if it is a whole number of 32 bits. The program ignores it.
    pub fn line_number(&self) -> Option<u32> {
        self.word(b'N')
            .and_then(Decimal::whole)
            .and_then(|number| u32::try_from(number).ok())
    }

    #[inline]
    fn slot(&self, slot: u8) -> Option<&Decimal> {
        if self.present & 1u32.wrapping_shl(u32::from(slot)) == 0 {
            return None;
        }
        self.values.get(usize::from(slot))
    }

    /// The word of axis 0 to 5, whatever its letter. ([`Block::word`] finds each axis by the letter
    /// of its index in X Y Z A B C, even if its own letter is different.)
    #[inline]
    pub fn axis(&self, axis: usize) -> Option<&Decimal> {
        if axis < AXES {
            self.slot(axis as u8)
        } else {
            None
        }
    }

    /// The words of the axes in order, each with whether it is given.
    #[inline(always)]
    pub(crate) fn axis_words(&self) -> impl Iterator<Item = (&Decimal, bool)> {
        let mut given = self.present;
        self.values.iter().map(move |value| {
            let this = given & 1 != 0;
            given >>= 1;
            (value, this)
        })
    }

    /// Bit n: the word of axis n is given.
    pub(crate) fn axes(&self) -> u16 {
        // The slots of U, V and W are those of X, Y and Z in the same order.
        let increments = if EXTENDED {
            (self.present >> INCREMENTS) & 0b111
        } else {
            0
        };
        ((self.present & 0b11_1111) | increments) as u16
    }

    /// The increment (U, V, W) of axis 0..3; only the extended codes have them.
    #[inline]
    pub(crate) fn increment(&self, axis: usize) -> Option<&Decimal> {
        if EXTENDED && axis < 3 {
            self.slot(INCREMENTS.wrapping_add(axis as u8))
        } else {
            None
        }
    }

    /// Refuses increments (U, V, W) with anything except a contour cycle.
    pub(crate) fn check_increments(&self) -> Result<(), Fault> {
        let given = (0..3).find(|&axis| self.increment(axis).is_some());
        let contour = || self.code(Group::Motion).and_then(Code::contour_cycle);
        match given {
            Some(axis) if contour().is_none() => {
                let letter = self.letter_of(axis);
                Err(Fault::at(Reason::UnknownWord, letter))
            }
            _ => Ok(()),
        }
    }

    /// The code that needs the lines around this one, with its group.
    #[cfg(all(feature = "program", feature = "extended"))]
    pub(crate) fn flow_code(&self) -> Option<(Code, Group)> {
        [Group::Override, Group::Stop]
            .into_iter()
            .filter_map(|group| Some((self.code(group)?, group)))
            .find(|(code, _)| code.needs_program())
    }

    /// Refuses codes that need the lines around this one.
    #[cfg(feature = "extended")]
    pub(crate) fn check_needs_no_program(&self) -> Result<(), Fault> {
        for group in [Group::Override, Group::Stop] {
            if self.code(group).is_some_and(Code::needs_program) {
                return Err(Fault::at_code(Reason::NeedsProgram, group));
            }
        }
        Ok(())
    }

    /// Refuses all codes except the motion, and all words except these and N.
    #[cfg(all(feature = "program", feature = "extended"))]
    pub(crate) fn check_alone(&self, letters: &[u8]) -> Result<(), Fault> {
        if self.groups & !1u32.wrapping_shl(Group::Motion as u32) != 0 {
            return Err(Fault::at_motion(Reason::TwoUsersOfWords));
        }
        let foreign = |letter: u8| letter != b'N' && !letters.contains(&letter);
        let mut given = LETTERS
            .into_iter()
            .filter(|&letter| self.present & bit(letter) != 0);
        match given.find(|&letter| foreign(letter)) {
            Some(letter) => Err(Fault::at(Reason::UnusedWord, letter)),
            None => Ok(()),
        }
    }

    /// The letter that gives an axis in this block: U, V or W, or its own.
    pub(crate) fn letter_of(&self, axis: usize) -> u8 {
        let increments = *b"UVW";
        match increments.get(axis) {
            Some(&letter) if self.increment(axis).is_some() => letter,
            _ => axis_letter(axis),
        }
    }

    /// Whether the block has a word that some code must use.
    #[inline]
    pub(crate) fn has_claims(&self) -> bool {
        self.present & CLAIMED.0 != 0
    }

    /// Refuses a word of this block that none of its codes uses, and a word that two of them use.
    /// `more` are the letters of modes in effect that have no code in the block.
    pub(crate) fn check_users(&self, more: Letters) -> Result<(), Fault> {
        let given = self.present & CLAIMED.0;
        if given == 0 {
            return Ok(());
        }
        let (mut once, mut twice) = (more.0, 0);
        for code in self.codes.iter().flatten() {
            let claim = code.letters().0;
            twice |= once & claim;
            once |= claim;
        }
        let (unused, shared) = (given & !once, given & twice);
        if unused != 0 {
            return Err(Fault::at(Reason::UnusedWord, first_of(unused)));
        }
        if shared != 0 {
            return Err(Fault::at(Reason::TwoUsersOfWords, first_of(shared)));
        }
        Ok(())
    }

    /// The number of a program: `O` alone in its block (dialect `iso`).
    pub fn program_number(&self) -> Option<u32> {
        self.word(b'O')
            .and_then(Decimal::whole)
            .and_then(|number| u32::try_from(number).ok())
    }

    #[inline]
    pub(crate) fn code(&self, group: Group) -> Option<Code> {
        self.codes.get(group as usize).copied().flatten()
    }

    /// Whether a word is given. For a letter known at compile time this is one test.
    #[inline(always)]
    pub(crate) const fn has(&self, letter: u8) -> bool {
        self.present & bit(letter) != 0
    }

    /// Whether only these groups are given.
    #[inline]
    pub(crate) fn has_only(&self, groups: u32) -> bool {
        self.groups & !groups == 0
    }

    /// The codes by their groups.
    #[inline]
    pub(crate) const fn codes(&self) -> &[Option<Code>; Group::COUNT] {
        &self.codes
    }

    /// Reads a word as `value * factor * 10^exponent`, rounded once. Without the word `to` is
    /// unchanged.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    pub(crate) fn scaled(
        &self,
        letter: u8,
        factor: u8,
        exponent: u8,
        to: &mut i64,
    ) -> Result<(), Fault> {
        if let Some(value) = self.value(letter) {
            match value.scaled(i32::from(factor), exponent) {
                Some(scaled) => *to = scaled,
                None => return Err(Fault::at(Reason::NumberTooLarge, letter)),
            }
        }
        Ok(())
    }

    /// Reads a word that is a whole number up to a limit. Without the word `to` is unchanged.
    pub(crate) fn whole(&self, letter: u8, most: u32, to: &mut u32) -> Result<(), Fault> {
        if let Some(value) = self.value(letter) {
            let Some(number) = value.whole() else {
                return Err(Fault::at(Reason::NotWhole, letter));
            };
            if number as u64 > u64::from(most) {
                return Err(Fault::at(Reason::OutOfRange, letter));
            }
            *to = number as u32;
        }
        Ok(())
    }

    /// Whether there is only a motion code, and only words of a move, `F` and `N`.
    #[inline]
    pub(crate) fn is_move(&self) -> bool {
        const OF_MOVES: u32 = Letters::new(b"XYZABCIJKRPFN").0;
        self.has_only(1 << Group::Motion as u32) && self.present & !OF_MOVES == 0
    }

    /// The error of a fault, with the columns of its words. `measure` is that of an arc that does
    /// not fit.
    #[cold]
    #[inline(never)]
    pub(crate) fn error(&self, fault: Fault, measure: Measure) -> Error {
        self.error_on(&Axes::XYZABC, fault, measure)
    }

    /// The same on a machine with these axes, with their letters as they are written.
    #[cold]
    pub(crate) fn error_on(&self, axes: &Axes, fault: Fault, measure: Measure) -> Error {
        let place = fault.place();
        let code = match place {
            Place::Code(group) => Some(usize::from(group)),
            Place::Motion => self.code(Group::Motion).map(|_| Group::Motion as usize),
            _ => None,
        };
        let span = match code {
            Some(group) => self.code_spans.get(group).copied(),
            None => {
                let words = match place {
                    Place::Word => bit(fault.letter()),
                    _ => AXIS_WORDS,
                };
                self.span_of(words, place == Place::Motion)
            }
        };
        let written = if EXTENDED {
            fault.with_letter(axes.written(fault.letter()))
        } else {
            fault
        };
        span.unwrap_or_default().error(written.kind(measure))
    }

    /// The columns of the first of these words, or of all of them, as far as they are given.
    fn span_of(&self, words: u32, first: bool) -> Option<Span> {
        let mut given = words & self.present;
        let mut all: Option<Span> = None;
        for &span in &self.word_spans {
            if given & 1 != 0 {
                all = match all {
                    None => Some(span),
                    Some(other) if first && span.at < other.at => Some(span),
                    Some(other) if first => Some(other),
                    Some(other) => Some(Span {
                        at: span.at.min(other.at),
                        end: span.end.max(other.end),
                    }),
                };
            }
            given >>= 1;
        }
        all
    }
}
