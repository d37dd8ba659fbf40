//! The letters of words, their slots in a block, and sets of them.

/// Letters that carry a value; the index of a letter in this list is its slot. The first six are
/// the axes. The last two are signs, of polar coordinates.
#[cfg(feature = "extended")]
pub(crate) const LETTERS: [u8; SLOTS] = *b"XYZABCIJKRPFSTNDEHLQOUVW@^";
#[cfg(not(feature = "extended"))]
pub(crate) const LETTERS: [u8; SLOTS] = *b"XYZABCIJKRPFSTNDEHLQOUVW";
pub(crate) const SLOTS: usize = if cfg!(feature = "extended") { 26 } else { 24 };

/// Slot of each letter A to Z, of `@` and of `^`, or [`NO_SLOT`] for a byte that has none.
const SLOT_OF: [u8; 32] = {
    let mut table = [NO_SLOT; 32];
    let mut slot = 0;
    while slot < SLOTS {
        table[(LETTERS[slot] - b'@') as usize] = slot as u8;
        slot += 1;
    }
    table
};
pub(crate) const NO_SLOT: u8 = 31;

/// How many letters are axes: X Y Z A B C.
pub(crate) const AXES: usize = 6;

/// The letter of an axis; `?` beyond the sixth.
pub(crate) fn axis_letter(axis: usize) -> u8 {
    LETTERS
        .get(axis)
        .copied()
        .filter(|_| axis < AXES)
        .unwrap_or(b'?')
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
pub(crate) const fn slot_of(letter: u8) -> u8 {
    let place = letter.wrapping_sub(b'@') as usize;
    if place < SLOT_OF.len() {
        SLOT_OF[place]
    } else {
        NO_SLOT
    }
}

/// The bit of an upper-case letter in [`Block::present`]; 0 for one without a slot.
pub(crate) const fn bit(letter: u8) -> u32 {
    1u32.wrapping_shl(slot_of(letter) as u32) & !(1 << NO_SLOT)
}

/// A set of letters of words.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Letters(pub(crate) u32);

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
