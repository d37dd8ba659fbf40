//! A block: the words of one line, checked as far as the line alone allows.

pub(crate) mod given;

use crate::blocks::fault::{Fault, Reason};
use crate::codes::code::{Code, Group};
use crate::codes::dialect::Dialect;
use crate::codes::letters::{Letters, SLOTS, bit, polar, slot_of};
#[cfg(feature = "extended")]
use crate::codes::{
    dialect::Flavour,
    printer::{self, Rest},
};
use crate::error::{Error, ErrorKind};
use crate::features::EXTENDED;
use crate::values::decimal::Decimal;
use crate::values::nm::{Measure, Nm};
#[cfg(feature = "extended")]
use crate::words::comment::comment_within;
use crate::words::word::{Word, words};

/// The letters that are never negative; `NUMBERS` are those that number something.
const PLAIN: Letters = Letters::new(b"FSTHNO");
const NUMBERS: Letters = Letters::new(b"THO");

#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
struct Span {
    at: u16,
    end: u16,
}

impl Span {
    /// Columns beyond 65535 are stored as 65535. This takes a quarter of the size.
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

/// A checked line: every letter at most once, at most one code of each modal group, only known
/// codes and letters.
///
/// Its size is fixed (about 0.6 kB), whatever the length of the line.
/// [`Modal::plan`](crate::Modal::plan) checks everything that depends on earlier lines.
///
/// The fields that are used most come first, because short instructions reach 32 bytes from the
/// address.
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

    /// Reads one block; `text` comes from [`Dialect::blocks`].
    ///
    /// # Errors
    /// The first fault of the line, from the left: its words (E01xx), unknown letters and codes
    /// (E0201, E0202), codes of other dialects (E0212), repeated letters (E0203), two codes of a
    /// modal group (E0204), negative F, S, T, H, P or N (E0502), a dwell without time (E0504). A
    /// deleted block (`/`) is empty and has no errors.
    ///
    /// # Cost
    /// One pass over the text.
    pub fn parse(text: &[u8], dialect: &Dialect) -> Result<Block, Error> {
        let mut block = Block::EMPTY;
        block.take(text, dialect)?;
        Ok(block)
    }

    /// Creates an empty block, to read into.
    pub const fn new() -> Block {
        Block::EMPTY
    }

    /// Reads into this block as [`Block::parse`] does, but moves nothing and sets nothing to zero.
    /// On a small machine that is most of the cost. The block is empty after an error.
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

    /// Empties the block; the contents of the arrays are then ignored.
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
                #[cfg(feature = "extended")]
                if dialect.flavour == Flavour::Printer && self.take_rest(text, at) {
                    break;
                }
                return Err(Error { kind, at, end });
            }
        }
        self.deleted = words.is_deleted();
        self.check()
            .map_err(|fault| self.error(fault, Measure::of(Nm(0))))
    }

    /// The rest of a line of a printer from the code at this offset on, if the code is alone before
    /// it and takes such words: axes without values, settings, messages.
    #[cfg(feature = "extended")]
    #[cold]
    fn take_rest(&mut self, text: &[u8], at: usize) -> bool {
        if self.groups != 0 || self.present & !bit(b'N') != 0 {
            return false;
        }
        let code = text.get(at..).unwrap_or_default();
        let known =
            printer::code_at(code).and_then(|(letter, number)| printer::rest(letter, number));
        let Some(rest) = known else { return false };
        let code_end = at.saturating_add(1);
        let span = Span::new(at, code_end);
        let (group, code) = match rest {
            Rest::Ignored => return true,
            Rest::MotorsOff => (Group::Io, Code::MotorsOff),
            Rest::Pause => (Group::Stop, Code::Stop),
            Rest::Home => {
                self.take_homed(text, code_end);
                (Group::NonModal, Code::Home)
            }
        };
        if let (Some(slot), Some(place)) = (
            self.codes.get_mut(group as usize),
            self.code_spans.get_mut(group as usize),
        ) {
            (*slot, *place) = (Some(code), span);
            self.groups |= 1u32.wrapping_shl(group as u32);
        }
        true
    }

    /// The letters X, Y and Z of G28, whatever their values; others are ignored.
    #[cfg(feature = "extended")]
    fn take_homed(&mut self, text: &[u8], from: usize) {
        let mut behind_comment = from;
        for (at, byte) in (0..text.len()).zip(text).skip(from) {
            if at < behind_comment {
                continue;
            }
            match byte.to_ascii_uppercase() {
                b';' | b'*' => return,
                b'(' => match comment_within(text.get(at..).unwrap_or_default(), false) {
                    // Both are lengths of parts of the text.
                    Ok(length) => behind_comment = at.saturating_add(length),
                    Err(_) => return,
                },
                letter @ (b'X' | b'Y' | b'Z') => {
                    let slot = usize::from(slot_of(letter));
                    self.present |= bit(letter);
                    if let (Some(entry), Some(place)) =
                        (self.values.get_mut(slot), self.word_spans.get_mut(slot))
                    {
                        // The column after the letter: below the length of the text.
                        *entry = Decimal::ZERO;
                        *place = Span::new(at, at.wrapping_add(1));
                    }
                }
                _ => {}
            }
        }
    }

    /// Creates a block of words that were read elsewhere, in their order. A line with expressions
    /// is read in this manner.
    ///
    /// # Errors
    /// The first error among the words; otherwise as [`Block::parse`].
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

    /// Creates a block of codes and words without columns.
    #[cfg(all(feature = "program", feature = "extended"))]
    pub(crate) fn of(
        codes: impl IntoIterator<Item = Code>,
        words: impl IntoIterator<Item = (u8, Decimal)>,
    ) -> Block {
        let mut block = Block::EMPTY;
        for code in codes {
            block.set_code(code.group(), Some(code));
        }
        for (letter, value) in words {
            let slot = usize::from(slot_of(letter));
            if let Some(entry) = block.values.get_mut(slot) {
                *entry = value;
                block.present |= bit(letter);
            }
        }
        block
    }

    /// Replaces or removes the code of a group, and keeps its columns.
    #[cfg(all(feature = "program", feature = "extended"))]
    pub(crate) fn set_code(&mut self, group: Group, code: Option<Code>) {
        let bit = 1u32.wrapping_shl(group as u32);
        self.groups = match code {
            Some(_) => self.groups | bit,
            None => self.groups & !bit,
        };
        if let Some(slot) = self.codes.get_mut(group as usize) {
            *slot = code;
        }
    }

    /// Removes a word and returns its value.
    #[cfg(all(feature = "program", feature = "extended"))]
    pub(crate) fn take_word(&mut self, letter: u8) -> Option<Decimal> {
        let value = self.word(letter);
        self.present &= !bit(letter);
        value
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

    /// Checks that need all words.
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
        // S is a time on printers only: `Modal::set_dwell`.
        let has_time = self.has(b'P') || EXTENDED && self.has(b'S');
        if self.code(Group::NonModal) == Some(Code::Dwell) && !has_time {
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
        let mut code = Code::read(letter, tenths, dialect.flavour).ok_or(unknown)?;
        if !code.is_in(dialect.flavour) {
            let alias = code.alias(dialect.flavour);
            code = alias.ok_or(ErrorKind::NotOfDialect(letter, tenths))?;
        }
        let group = code.group() as usize;
        if let (Some(slot), Some(place)) =
            (self.codes.get_mut(group), self.code_spans.get_mut(group))
        {
            // Many programs start with G80 next to another motion code; the other one counts.
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
        if dialect.letters().0 & 1u32.wrapping_shl(u32::from(slot)) == 0 {
            return match EXTENDED {
                true => self.push_other(letter, value, span, dialect),
                false => Err(ErrorKind::UnknownWord(letter)),
            };
        }
        self.store(slot, letter, value, span)
    }

    /// The same for a word that is not stored under its own letter.
    #[cold]
    #[inline(never)]
    fn push_other(
        &mut self,
        letter: u8,
        value: Decimal,
        span: Span,
        dialect: &Dialect,
    ) -> Result<(), ErrorKind> {
        let slot = other_slot(letter, dialect).ok_or(ErrorKind::UnknownWord(letter))?;
        self.store(slot, letter, value, span)
    }

    /// Stores a word of the dialect.
    #[inline(always)]
    fn store(&mut self, slot: u8, letter: u8, value: Decimal, span: Span) -> Result<(), ErrorKind> {
        let bit = 1u32.wrapping_shl(u32::from(slot));
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
}

/// The slot of a word that is not stored under its own letter: an axis, or a polar coordinate.
fn other_slot(letter: u8, dialect: &Dialect) -> Option<u8> {
    let polar = polar(letter).filter(|_| dialect.has_polar()).map(slot_of);
    dialect.axes().slot(letter).or(polar)
}

impl Default for Block {
    fn default() -> Self {
        Block::EMPTY
    }
}

fn check_length(text: &[u8], dialect: &Dialect) -> Result<(), Error> {
    let Some(limit) = dialect.buffer() else {
        return Ok(());
    };
    // The `;` that ended the block takes one character.
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
