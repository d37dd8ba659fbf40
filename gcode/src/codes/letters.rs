//! The letters of words, their slots in a block, and sets of them.

/// Letters that carry a value; the index of a letter in this list is its slot. The first six are
/// the axes.
pub(crate) const LETTERS: [u8; SLOTS] = *b"XYZABCIJKRPFSTNDEHLQOUVW";
pub(crate) const SLOTS: usize = 24;

/// The letters under which the polar coordinates `@` and `^` are stored. They are axis words of X
/// and Y like the increments U and V, which no dialect with polar coordinates has.
pub(crate) const POLAR_RADIUS: u8 = b'U';
pub(crate) const POLAR_ANGLE: u8 = b'V';

/// The letter under which a sign of polar coordinates is stored.
pub(crate) const fn polar(sign: u8) -> Option<u8> {
    match sign {
        b'@' => Some(POLAR_RADIUS),
        b'^' => Some(POLAR_ANGLE),
        _ => None,
    }
}

/// The sign of polar coordinates that is stored under a letter; other letters are unchanged.
#[cfg(feature = "extended")]
pub(crate) const fn polar_sign(stored: u8) -> u8 {
    match stored {
        POLAR_RADIUS => b'@',
        POLAR_ANGLE => b'^',
        letter => letter,
    }
}

/// Slot of each letter A to Z, or [`NO_SLOT`] for a letter that has none.
const SLOT_OF: [u8; 26] = {
    let mut table = [NO_SLOT; 26];
    let mut slot = 0;
    while slot < SLOTS {
        table[(LETTERS[slot] - b'A') as usize] = slot as u8;
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
    let place = letter.wrapping_sub(b'A') as usize;
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
