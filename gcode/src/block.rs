//! A block: the words of one line, checked as far as a line alone can tell.

use crate::code::{Code, Group};
use crate::decimal::Decimal;
use crate::dialect::Dialect;
use crate::error::{Error, ErrorKind};
use crate::fault::{Fault, Place};
use crate::word::{Word, words};

/// Letters that carry a value; a letter's place in this list is its slot. The first six are the axes.
const LETTERS: [u8; SLOTS] = *b"XYZABCIJKRPFSTNDEHLQOUVW";
const SLOTS: usize = 24;

/// Slot of each letter A to Z, or [`NO_SLOT`].
const SLOT_OF: [u8; 26] = {
    let mut table = [NO_SLOT; 26];
    let mut slot = 0;
    while slot < SLOTS {
        table[(LETTERS[slot] - b'A') as usize] = slot as u8;
        slot += 1;
    }
    table
};
const NO_SLOT: u8 = 0xff;

/// Slot of U; V and W follow.
const INCREMENTS: u8 = 21;

/// How many letters are axes: X Y Z A B C.
pub(crate) const AXES: usize = 6;

/// The letters that must have a code that uses them.
const CLAIMED_IN_ORDER: &[u8] = b"IJKRPDEHLQ";
const CLAIMED: Letters = Letters::new(CLAIMED_IN_ORDER);

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
#[derive(Clone, Debug)]
pub struct Block {
    /// Bit n: slot n is given.
    present: u32,
    /// Bit n: a code of group n is given.
    groups: u32,
    deleted: bool,
    values: [Decimal; SLOTS],
    codes: [Option<Code>; Group::COUNT],
    word_spans: [Span; SLOTS],
    code_spans: [Span; Group::COUNT],
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
    fn clear(&mut self) {
        (self.present, self.groups, self.deleted) = (0, 0, false);
    }

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
            self.push(word?, dialect)?;
        }
        self.deleted = words.is_deleted();
        self.check().map_err(|fault| self.error(fault))
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
            block.push(word?, dialect)?;
        }
        block.check().map_err(|fault| block.error(fault))?;
        Ok(block)
    }

    #[inline(always)]
    fn push(&mut self, word: Word, dialect: &Dialect) -> Result<(), Error> {
        let span = Span::new(word.at, word.end);
        let pushed = match word.letter {
            b'G' | b'M' => self.push_code(word.letter, word.value, span, dialect),
            letter => self.push_word(letter, word.value, span, dialect),
        };
        pushed.map_err(|kind| Error {
            kind,
            at: word.at,
            end: word.end,
        })
    }

    /// What can only be told when all words are there.
    fn check(&self) -> Result<(), Fault> {
        self.check_negative_p()?;
        self.check_program_number()?;
        if self.code(Group::NonModal) == Some(Code::Dwell) && self.word(b'P').is_none() {
            return Err(Fault::at_code(ErrorKind::NoDwellTime, Group::NonModal));
        }
        Ok(())
    }

    /// `P` may be negative only where it is a coordinate: in G5.
    fn check_negative_p(&self) -> Result<(), Fault> {
        let negative = self.word(b'P').is_some_and(Decimal::is_negative);
        if negative && !matches!(self.code(Group::Motion), None | Some(Code::Cubic)) {
            return Err(Fault::at(ErrorKind::Negative(b'P'), b'P'));
        }
        Ok(())
    }

    /// `O1234` is the number of a program and stands alone, or with `N`.
    fn check_program_number(&self) -> Result<(), Fault> {
        let alone = bit(b'O') | bit(b'N');
        let others = self.present & !alone != 0 || self.groups != 0;
        if self.present & bit(b'O') != 0 && others {
            return Err(Fault::at(ErrorKind::NumberNotAlone, b'O'));
        }
        Ok(())
    }

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
            match slot.filter(|_| self.groups & bit != 0) {
                Some(_) if cancel(code) => {}
                Some(before) if !cancel(before) => return Err(ErrorKind::TwoCodesOfOneGroup),
                _ => (*slot, *place, self.groups) = (Some(code), span, self.groups | bit),
            }
        }
        Ok(())
    }

    fn push_word(
        &mut self,
        letter: u8,
        value: Decimal,
        span: Span,
        dialect: &Dialect,
    ) -> Result<(), ErrorKind> {
        let slot = slot_of(letter)
            .filter(|_| dialect.has_word(letter))
            .ok_or(ErrorKind::UnknownWord(letter))?;
        let bit = 1u32.wrapping_shl(u32::from(slot));
        if self.present & bit != 0 {
            return Err(ErrorKind::RepeatedWord(letter));
        }
        if bit & PLAIN.0 != 0 && value.is_negative() {
            return Err(ErrorKind::Negative(letter));
        }
        if bit & NUMBERS.0 != 0 {
            let whole = value.whole().and_then(|whole| u32::try_from(whole).ok());
            whole.ok_or(ErrorKind::NotWhole(letter))?;
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
        self.slot(slot_of(letter)?).copied()
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

    /// Bit n: the word of axis n is given.
    pub(crate) fn axes(&self) -> u16 {
        // The slots of U, V and W are those of X, Y and Z in the same order.
        let increments = (self.present >> INCREMENTS) & 0b111;
        ((self.present & 0b11_1111) | increments) as u16
    }

    /// The increment (U, V, W) of axis 0..3.
    #[inline]
    pub(crate) fn increment(&self, axis: usize) -> Option<&Decimal> {
        if axis < 3 {
            self.slot(INCREMENTS.wrapping_add(axis as u8))
        } else {
            None
        }
    }

    /// Refuses increments (U, V, W) beside anything but a contour cycle.
    pub(crate) fn check_increments(&self) -> Result<(), Fault> {
        let given = (0..3).find(|&axis| self.increment(axis).is_some());
        match (given, self.code(Group::Motion)) {
            (None, _) | (_, Some(Code::ContourCycle(_))) => Ok(()),
            (Some(axis), _) => {
                let letter = self.letter_of(axis);
                Err(Fault::at(ErrorKind::UnknownWord(letter), letter))
            }
        }
    }

    /// Refuses all codes but the motion, and all words but these and N.
    #[cfg(feature = "extended")]
    pub(crate) fn check_alone(&self, letters: &[u8]) -> Result<(), Fault> {
        if self.groups & !1u32.wrapping_shl(Group::Motion as u32) != 0 {
            return Err(Fault::at_motion(ErrorKind::TwoUsersOfWords));
        }
        let foreign = |letter: u8| letter != b'N' && !letters.contains(&letter);
        let mut given = LETTERS
            .into_iter()
            .filter(|&letter| self.present & bit(letter) != 0);
        match given.find(|&letter| foreign(letter)) {
            Some(letter) => Err(Fault::at(ErrorKind::UnusedWord(letter), letter)),
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
        let mut groups = self.groups;
        while groups != 0 {
            let group = groups.trailing_zeros();
            groups &= groups.wrapping_sub(1);
            if let Some(code) = self.codes.get(group as usize).copied().flatten() {
                let claim = code.letters().0;
                twice |= once & claim;
                once |= claim;
            }
        }
        let find = |wrong: u32| {
            CLAIMED_IN_ORDER
                .iter()
                .find(|&&letter| wrong & bit(letter) != 0)
                .copied()
        };
        if let Some(letter) = find(given & !once) {
            return Err(Fault::at(ErrorKind::UnusedWord(letter), letter));
        }
        match find(given & twice) {
            Some(letter) => Err(Fault::at(ErrorKind::TwoUsersOfWords, letter)),
            None => Ok(()),
        }
    }

    /// The number of a program: `O` alone in its block (dialect `iso`).
    pub fn program_number(&self) -> Option<u32> {
        self.word(b'O')
            .and_then(Decimal::whole)
            .and_then(|number| u32::try_from(number).ok())
    }

    #[inline]
    pub(crate) fn code(&self, group: Group) -> Option<Code> {
        if self.groups & 1u32.wrapping_shl(group as u32) == 0 {
            return None;
        }
        self.codes.get(group as usize).copied().flatten()
    }

    /// Whether there is nothing but one of G0 to G3 at the most, the words of a move, `F` and `N`.
    pub(crate) fn is_move(&self) -> bool {
        const OF_MOVES: u32 = Letters::new(b"XYZABCUVWIJKRPFN").0;
        let others = self.groups & !1u32.wrapping_shl(Group::Motion as u32);
        others == 0
            && self.present & !OF_MOVES == 0
            && matches!(
                self.code(Group::Motion),
                None | Some(Code::Rapid | Code::Linear | Code::Clockwise | Code::CounterClockwise)
            )
    }

    /// The error of a fault: where its words stand.
    #[cold]
    pub(crate) fn error(&self, fault: Fault) -> Error {
        let span = match fault.place {
            Place::Word(letter) => self.span_of(letter),
            Place::Code(group) => self.span_of_code(group),
            Place::Axes => self.span_of_axes(),
            Place::Motion => self
                .span_of_code(Group::Motion)
                .or_else(|| self.first_axis()),
        };
        span.unwrap_or_default().error(fault.kind)
    }

    fn span_of(&self, letter: u8) -> Option<Span> {
        let slot = slot_of(letter).filter(|_| self.present & bit(letter) != 0)?;
        self.word_spans.get(usize::from(slot)).copied()
    }

    fn span_of_code(&self, group: Group) -> Option<Span> {
        self.code(group)?;
        self.code_spans.get(group as usize).copied()
    }

    fn spans_of_axes(&self) -> impl Iterator<Item = Span> {
        LETTERS
            .into_iter()
            .take(AXES)
            .filter_map(|letter| self.span_of(letter))
    }

    fn span_of_axes(&self) -> Option<Span> {
        self.spans_of_axes().reduce(|all, span| Span {
            at: all.at.min(span.at),
            end: all.end.max(span.end),
        })
    }

    fn first_axis(&self) -> Option<Span> {
        self.spans_of_axes().min_by_key(|span| span.at)
    }
}

impl Default for Block {
    fn default() -> Self {
        Block::EMPTY
    }
}

/// Slot of an upper-case letter.
const fn slot_of(letter: u8) -> Option<u8> {
    let place = letter.wrapping_sub(b'A') as usize;
    if place < SLOT_OF.len() && SLOT_OF[place] != NO_SLOT {
        Some(SLOT_OF[place])
    } else {
        None
    }
}

/// The bit of an upper-case letter in [`Block::present`]; 0 for one without a slot.
const fn bit(letter: u8) -> u32 {
    match slot_of(letter) {
        Some(slot) => 1u32.wrapping_shl(slot as u32),
        None => 0,
    }
}

/// A set of letters of words.
#[derive(Copy, Clone)]
pub(crate) struct Letters(u32);

impl Letters {
    pub(crate) const NONE: Letters = Letters(0);

    pub(crate) const fn new(mut letters: &[u8]) -> Letters {
        let mut mask = 0;
        while let Some((&letter, rest)) = letters.split_first() {
            mask |= bit(letter);
            letters = rest;
        }
        Letters(mask)
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
