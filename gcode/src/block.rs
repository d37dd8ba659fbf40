//! A block: the words of one line, checked as far as a line alone can tell.

use crate::code::{Code, EXTENDED, Group};
use crate::decimal::Decimal;
use crate::dialect::Dialect;
use crate::error::{Error, ErrorKind};
use crate::fault::{Fault, Place, Reason};
use crate::nm::{Measure, Nm};
use crate::word::{Word, words};

/// Letters that carry a value; a letter's place in this list is its slot. The first six are the axes.
const LETTERS: [u8; SLOTS] = *b"XYZABCIJKRPFSTNDEHLQOUVW";
const SLOTS: usize = 24;

/// Slot of each letter A to Z, or [`NO_SLOT`], of which nothing is ever given.
const SLOT_OF: [u8; 26] = {
    let mut table = [NO_SLOT; 26];
    let mut slot = 0;
    while slot < SLOTS {
        table[(LETTERS[slot] - b'A') as usize] = slot as u8;
        slot += 1;
    }
    table
};
const NO_SLOT: u8 = 31;

/// Slot of U; V and W follow.
const INCREMENTS: u8 = 21;

/// How many letters are axes: X Y Z A B C.
pub(crate) const AXES: usize = 6;

/// The letters that must have a code that uses them.
const CLAIMED: Letters = Letters::new(b"IJKRPDEHLQ");

/// The letters that are never negative, and those of them that are numbers of something.
const PLAIN: Letters = Letters::new(b"FSTHNO");
const NUMBERS: Letters = Letters::new(b"THO");

/// The letter of an axis; `?` beyond the sixth.
pub(crate) fn axis_letter(axis: usize) -> u8 {
    LETTERS
        .get(axis)
        .copied()
        .filter(|_| axis < AXES)
        .unwrap_or(b'?')
}

#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
struct Span {
    at: u16,
    end: u16,
}

impl Span {
    /// Places beyond the 65535th are given as that one: a quarter of the size for all others.
    fn new(at: usize, end: usize) -> Self {
        let narrow = |place| u16::try_from(place).unwrap_or(u16::MAX);
        Span {
            at: narrow(at),
            end: narrow(end),
        }
    }

    const fn error(self, kind: ErrorKind) -> Error {
        Error {
            kind,
            at: self.at as usize,
            end: self.end as usize,
        }
    }
}

/// A checked line: every letter at most once, at most one code of each modal group, only known codes and letters.
///
/// Its size is fixed (about 0.6 kB) whatever the line's length. What depends on earlier lines is checked by
/// [`Modal::plan`](crate::Modal::plan).
///
/// What is looked at most stands first: short instructions reach 32 bytes from its address.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Block {
    /// Bit n: slot n is given.
    present: u32,
    /// Bit n: a code of group n is given.
    groups: u32,
    codes: [Option<Code>; Group::COUNT],
    deleted: bool,
    code_spans: [Span; Group::COUNT],
    word_spans: [Span; SLOTS],
    values: [Decimal; SLOTS],
}

impl Block {
    const EMPTY: Block = Block {
        present: 0,
        groups: 0,
        deleted: false,
        values: [Decimal::ZERO; SLOTS],
        codes: [None; Group::COUNT],
        word_spans: [Span { at: 0, end: 0 }; SLOTS],
        code_spans: [Span { at: 0, end: 0 }; Group::COUNT],
    };

    /// Reads one block; `text` comes from [`Dialect::blocks`]. Cost: one pass over the text.
    ///
    /// # Errors
    /// The first fault of the line, from the left: its words (E01xx), unknown letters and codes (E0201, E0202),
    /// codes of other dialects (E0212), repeated letters (E0203), two codes of a modal group (E0204), negative F, S, T,
    /// H, P or N (E0502), a dwell without time (E0504). A deleted block (`/`) is empty and has no errors.
    pub fn parse(text: &[u8], dialect: &Dialect) -> Result<Block, Error> {
        let mut block = Block::EMPTY;
        block.take(text, dialect)?;
        Ok(block)
    }

    /// An empty block, to read into.
    pub const fn new() -> Block {
        Block::EMPTY
    }

    /// As [`Block::parse`], into this block: nothing of it is moved or set to zero, which is most of the cost on a small
    /// machine. Empty after an error.
    ///
    /// # Errors
    /// Those of [`Block::parse`].
    pub fn read(&mut self, text: &[u8], dialect: &Dialect) -> Result<(), Error> {
        let taken = self.take(text, dialect);
        if taken.is_err() {
            self.clear();
        }
        taken
    }

    /// Nothing given: what the arrays hold is no longer looked at.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn clear(&mut self) {
        (self.present, self.groups, self.deleted) = (0, 0, false);
        self.codes = [None; Group::COUNT];
    }

    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn take(&mut self, text: &[u8], dialect: &Dialect) -> Result<(), Error> {
        self.clear();
        check_length(text, dialect)?;
        let mut words = words(text);
        while let Some(word) = words.next() {
            if words.is_deleted() && dialect.block_delete() {
                self.clear();
                self.deleted = true;
                return Ok(());
            }
            let word = word?;
            if let Err(kind) = self.push(&word, dialect) {
                let Word { at, end, .. } = word;
                return Err(Error { kind, at, end });
            }
        }
        self.deleted = words.is_deleted();
        self.check()
            .map_err(|fault| self.error(fault, Measure::of(Nm(0))))
    }

    /// A block of words that were read elsewhere, in their order: those of a line with expressions.
    ///
    /// # Errors
    /// The first error among the words, otherwise as [`Block::parse`].
    pub fn from_words<W: IntoIterator<Item = Result<Word, Error>>>(
        words: W,
        dialect: &Dialect,
    ) -> Result<Block, Error> {
        let mut block = Block::EMPTY;
        for word in words {
            let word = word?;
            let Word { at, end, .. } = word;
            let pushed = block.push(&word, dialect);
            pushed.map_err(|kind| Error { kind, at, end })?;
        }
        block
            .check()
            .map_err(|fault| block.error(fault, Measure::of(Nm(0))))?;
        Ok(block)
    }

    #[cfg_attr(target_has_atomic = "32", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn push(&mut self, word: &Word, dialect: &Dialect) -> Result<(), ErrorKind> {
        let span = Span::new(word.at, word.end);
        match word.letter {
            b'G' | b'M' => self.push_code(word.letter, word.value, span, dialect),
            letter => self.push_word(letter, word.value, span, dialect),
        }
    }

    /// What can only be told when all words are there.
    #[inline(always)]
    fn check(&self) -> Result<(), Fault> {
        if self.present & (bit(b'P') | bit(b'O')) == 0 && self.code(Group::NonModal).is_none() {
            return Ok(());
        }
        self.check_words()
    }

    #[inline(never)]
    fn check_words(&self) -> Result<(), Fault> {
        self.check_negative_p()?;
        self.check_program_number()?;
        if self.code(Group::NonModal) == Some(Code::Dwell) && !self.has(b'P') {
            return Err(Fault::at_code(Reason::NoDwellTime, Group::NonModal));
        }
        Ok(())
    }

    /// `P` may be negative only where it is a coordinate: in G5.
    fn check_negative_p(&self) -> Result<(), Fault> {
        if self.is_negative(b'P') && !matches!(self.code(Group::Motion), None | Some(Code::Cubic)) {
            return Err(Fault::at(Reason::Negative, b'P'));
        }
        Ok(())
    }

    /// `O1234` is the number of a program and stands alone, or with `N`.
    fn check_program_number(&self) -> Result<(), Fault> {
        let alone = bit(b'O') | bit(b'N');
        let others = self.present & !alone != 0 || self.groups != 0;
        if self.present & bit(b'O') != 0 && others {
            return Err(Fault::at(Reason::NumberNotAlone, b'O'));
        }
        Ok(())
    }

    #[inline]
    fn push_code(
        &mut self,
        letter: u8,
        value: Decimal,
        span: Span,
        dialect: &Dialect,
    ) -> Result<(), ErrorKind> {
        let tenths = value
            .exactly(1)
            .and_then(|tenths| u16::try_from(tenths).ok());
        let unknown = ErrorKind::UnknownCode(letter, tenths);
        let tenths = tenths.ok_or(unknown)?;
        let code = Code::read(letter, tenths, dialect.flavour).ok_or(unknown)?;
        if !code.is_in(dialect.flavour) {
            return Err(ErrorKind::NotOfDialect(letter, tenths));
        }
        let group = code.group() as usize;
        if let (Some(slot), Some(place)) =
            (self.codes.get_mut(group), self.code_spans.get_mut(group))
        {
            // G80 beside another motion code is the preamble of many a program: the other one counts.
            let cancel = |code| code == Code::CancelMotion && dialect.joins_cancel();
            let bit = 1u32.wrapping_shl(group as u32);
            if let Some(before) = *slot {
                if cancel(code) {
                    return Ok(());
                }
                if !cancel(before) {
                    return Err(ErrorKind::TwoCodesOfOneGroup);
                }
            }
            (*slot, *place, self.groups) = (Some(code), span, self.groups | bit);
        }
        Ok(())
    }

    #[cfg_attr(target_pointer_width = "64", inline(always))]
    fn push_word(
        &mut self,
        letter: u8,
        value: Decimal,
        span: Span,
        dialect: &Dialect,
    ) -> Result<(), ErrorKind> {
        let slot = slot_of(letter);
        let bit = 1u32.wrapping_shl(u32::from(slot));
        if dialect.letters().0 & bit == 0 {
            return Err(ErrorKind::UnknownWord(letter));
        }
        if self.present & bit != 0 {
            return Err(ErrorKind::RepeatedWord(letter));
        }
        if bit & PLAIN.0 != 0 {
            if value.is_negative() {
                return Err(ErrorKind::Negative(letter));
            }
            if bit & NUMBERS.0 != 0 {
                let whole = value.whole().and_then(|whole| u32::try_from(whole).ok());
                whole.ok_or(ErrorKind::NotWhole(letter))?;
            }
        }
        self.present |= bit;
        let slot = usize::from(slot);
        if let (Some(entry), Some(place)) =
            (self.values.get_mut(slot), self.word_spans.get_mut(slot))
        {
            (*entry, *place) = (value, span);
        }
        Ok(())
    }

    /// The value of a word, by its upper-case letter; `None` when the block has none (always for G and M).
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

    /// The most places that one of these words has.
    pub(crate) fn most_places(&self, letters: Letters) -> u8 {
        let (mut given, mut most) = (self.present & letters.0, 0);
        for value in &self.values {
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

    /// Whether the block was skipped, or would be with block delete on: it starts with `/`.
    pub const fn is_deleted(&self) -> bool {
        self.deleted
    }

    /// Whether the block asks for nothing: no code and no word but `N`.
    pub fn is_empty(&self) -> bool {
        self.present & !bit(b'N') == 0 && self.groups == 0
    }

    /// The number behind `N`, if it is a whole number of 32 bits. It means nothing to the program.
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

    /// The word of axis 0..6.
    #[inline]
    pub(crate) fn axis(&self, axis: usize) -> Option<&Decimal> {
        if axis < AXES {
            self.slot(axis as u8)
        } else {
            None
        }
    }

    /// The words of the axes in their order, each with whether it is given.
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

    /// The increment (U, V, W) of axis 0..3; without the extended codes no dialect has them.
    #[inline]
    pub(crate) fn increment(&self, axis: usize) -> Option<&Decimal> {
        if EXTENDED && axis < 3 {
            self.slot(INCREMENTS.wrapping_add(axis as u8))
        } else {
            None
        }
    }

    /// Refuses increments (U, V, W) beside anything but a contour cycle.
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

    /// Refuses all codes but the motion, and all words but these and N.
    #[cfg(feature = "extended")]
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

    /// The letter by which an axis is given here: U, V or W, or its own.
    pub(crate) fn letter_of(&self, axis: usize) -> u8 {
        let increments = *b"UVW";
        match increments.get(axis) {
            Some(&letter) if self.increment(axis).is_some() => letter,
            _ => axis_letter(axis),
        }
    }

    /// Whether there is a word that some code must use.
    #[inline]
    pub(crate) fn has_claims(&self) -> bool {
        self.present & CLAIMED.0 != 0
    }

    /// Refuses a word of this block that none of its codes uses, and one that two of them use. `more` are the letters
    /// of what is in effect without a code of its own in the block.
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

    /// Whether a word is given; of a letter that is known when this is compiled it is one test.
    #[inline(always)]
    pub(crate) const fn has(&self, letter: u8) -> bool {
        self.present & bit(letter) != 0
    }

    /// Whether none of the groups but these is given.
    #[inline]
    pub(crate) fn has_only(&self, groups: u32) -> bool {
        self.groups & !groups == 0
    }

    /// The codes by their groups.
    #[inline]
    pub(crate) const fn codes(&self) -> &[Option<Code>; Group::COUNT] {
        &self.codes
    }

    /// A word as `value * factor * 10^exponent`, rounded once; without it the number stays as it is.
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

    /// A word that is a whole number up to a limit; without it the number stays as it is.
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

    /// Whether there is no code but of the motion, and no word but those of a move, `F` and `N`.
    #[inline]
    pub(crate) fn is_move(&self) -> bool {
        const OF_MOVES: u32 = Letters::new(b"XYZABCUVWIJKRPFN").0;
        self.has_only(1 << Group::Motion as u32) && self.present & !OF_MOVES == 0
    }

    /// The error of a fault: where its words stand. The measure is that of an arc that does not fit.
    #[cold]
    #[inline(never)]
    pub(crate) fn error(&self, fault: Fault, measure: Measure) -> Error {
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
                    _ => 0b11_1111,
                };
                self.span_of(words, place == Place::Motion)
            }
        };
        span.unwrap_or_default().error(fault.kind(measure))
    }

    /// Where the first of some words stands, or all of them, as far as they are given.
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

impl Default for Block {
    fn default() -> Self {
        Block::EMPTY
    }
}

/// The letter of the first slot in a set.
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
pub(crate) fn first_of(mut slots: u32) -> u8 {
    for letter in LETTERS {
        if slots & 1 != 0 {
            return letter;
        }
        slots >>= 1;
    }
    b'?'
}

/// Slot of an upper-case letter, or [`NO_SLOT`].
const fn slot_of(letter: u8) -> u8 {
    let place = letter.wrapping_sub(b'A') as usize;
    if place < SLOT_OF.len() {
        SLOT_OF[place]
    } else {
        NO_SLOT
    }
}

/// The bit of an upper-case letter in [`Block::present`]; 0 for one without a slot.
const fn bit(letter: u8) -> u32 {
    1u32.wrapping_shl(slot_of(letter) as u32) & !(1 << NO_SLOT)
}

/// A set of letters of words.
#[derive(Copy, Clone)]
pub(crate) struct Letters(u32);

impl Letters {
    pub(crate) const NONE: Letters = Letters(0);
    pub(crate) const ALL: Letters = Letters::new(&LETTERS);

    pub(crate) const fn new(letters: &[u8]) -> Letters {
        Letters::NONE.and(letters)
    }

    pub(crate) const fn and(self, mut letters: &[u8]) -> Letters {
        let mut mask = self.0;
        while let Some((&letter, rest)) = letters.split_first() {
            mask |= bit(letter);
            letters = rest;
        }
        Letters(mask)
    }

    pub(crate) const fn without(self, letters: &[u8]) -> Letters {
        Letters(self.0 & !Letters::new(letters).0)
    }
}

fn check_length(text: &[u8], dialect: &Dialect) -> Result<(), Error> {
    let Some(limit) = dialect.buffer() else {
        return Ok(());
    };
    // The `;` that ended the block takes one place.
    let room = usize::from(limit).saturating_sub(1);
    // Counted by a range: the sum of `enumerate` is checked for overflow where such checks are on.
    let mut used = (0..text.len())
        .zip(text)
        .filter(|(_, byte)| !byte.is_ascii_whitespace());
    match used.nth(room) {
        Some((at, _)) => Err(Error {
            kind: ErrorKind::BlockTooLong(limit),
            at,
            end: text.len(),
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    fn fault(text: &str) -> (u16, usize, usize) {
        let error = Block::parse(text.as_bytes(), &Dialect::RS274).unwrap_err();
        (error.kind.code(), error.at, error.end)
    }

    #[test]
    fn keeps_words_by_letter() {
        let block = Block::parse(b"n12 G1 X1.50 F100", &Dialect::RS274).unwrap();
        assert_eq!(block.word(b'X').unwrap().to_string(), "1.50");
        assert_eq!(
            (block.word(b'Y'), block.word(b'G'), block.word(b'#')),
            (None, None, None)
        );
        assert_eq!(block.line_number(), Some(12));
        assert!(!block.is_empty());
        assert!(
            Block::parse(b" N5 (note)\r\n", &Dialect::RS274)
                .unwrap()
                .is_empty()
        );
    }

    #[test]
    fn faults_have_their_place() {
        assert_eq!(fault("N050 G01 X2.0 U0.4 F12"), (201, 14, 18));
        assert_eq!(fault("G1 X1 G299"), (202, 6, 10));
        assert_eq!(fault("G1 X1 G77"), (212, 6, 9));
        assert_eq!(fault("G10.12 X1"), (202, 0, 6));
        assert_eq!(fault("M-3"), (202, 0, 3));
        assert_eq!(fault("G1 X1 x2"), (203, 6, 8));
        assert_eq!(fault("G0 X1 G1"), (204, 6, 8));
        assert_eq!(fault("G1 F-10"), (502, 3, 7));
        assert_eq!(fault("T1.5"), (107, 0, 4));
        assert_eq!(fault("G4 F1"), (504, 0, 2));
    }

    #[test]
    fn block_delete_skips_the_line_unread() {
        let block = Block::parse(b" / G43 H1 [", &Dialect::RS274).unwrap();
        assert!(block.is_deleted() && block.is_empty());
        let on = Dialect::RS274.with_block_delete(false);
        assert!(Block::parse(b"/G0 X1", &on).unwrap().word(b'X').is_some());
    }

    #[test]
    fn micromill_buffer_holds_64_characters() {
        let text = "G02X02969.00Y03400.00I03012.00J03040.00F000000000000000000000008";
        assert!(Block::parse(&text.as_bytes()[..63], &Dialect::MICROMILL).is_ok());
        let error = Block::parse(text.as_bytes(), &Dialect::MICROMILL).unwrap_err();
        assert_eq!((error.kind.code(), error.at, error.end), (104, 63, 64));
    }
}
