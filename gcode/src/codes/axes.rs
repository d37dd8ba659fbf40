//! The axes of a machine, by their letters.

use crate::codes::letters::{AXES, axis_letter};
#[cfg(feature = "extended")]
use crate::codes::letters::{Letters, bit, slot_of};

/// The axes of a machine by their letters, in the order of the coordinates of a command: X, Y, Z,
/// and up to three of A, B, C, U, V, W and E.
///
/// A, B and C are rotary: their words are degrees under G20 and under G21, and an [`Nm`](crate::Nm)
/// of such a coordinate is a millionth of a degree. U, V, W and E are linear.
///
/// # Examples
/// ```
/// use husillo_gcode::Axes;
///
/// let axes = Axes::new(b"XYZAC").and_then(|axes| axes.with_wrapped(b"C")).unwrap();
/// assert_eq!((axes.len(), axes.letter(4), axes.index(b'A')), (5, Some(b'C'), Some(3)));
/// assert!(axes.is_rotary(3) && axes.is_wrapped(4) && !axes.is_wrapped(3));
/// assert_eq!(Axes::new(b"XYA"), None);
/// ```
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Axes {
    /// The letters after X, Y and Z; 0 where there is no axis.
    more: [u8; MORE],
    /// Bit n: axis n is rotary.
    rotary: u8,
    /// Bit n: axis n is wrapped.
    wrapped: u8,
}

/// The number of axes after X, Y and Z.
const MORE: usize = AXES - 3;

/// The letters that axes after X, Y and Z may have; the first three are rotary.
const LETTERS: [u8; 7] = *b"ABCUVWE";

/// The set of the letters of axes that are not axes of every machine.
#[cfg(feature = "extended")]
const OPTIONAL: Letters = Letters::new(b"ABC");

impl Axes {
    /// X, Y and Z.
    pub const XYZ: Axes = Axes {
        more: [0; MORE],
        rotary: 0,
        wrapped: 0,
    };

    /// X, Y, Z, A, B and C: the axes of every dialect but `printer`, unless
    /// [`Dialect::with_axes`](crate::Dialect::with_axes) sets others. A machine with fewer
    /// coordinates has the first of them.
    pub const XYZABC: Axes = Axes {
        more: *b"ABC",
        rotary: 0b11_1000,
        wrapped: 0,
    };

    /// X, Y, Z and E: a printer.
    pub const XYZE: Axes = Axes {
        more: [b'E', 0, 0],
        rotary: 0,
        wrapped: 0,
    };

    /// Creates a set of axes from their upper-case letters. Returns `None` unless the letters are
    /// X, Y, Z, and then up to three different ones of A, B, C, U, V, W and E.
    pub const fn new(letters: &[u8]) -> Option<Axes> {
        let [b'X', b'Y', b'Z', rest @ ..] = letters else {
            return None;
        };
        let mut rest = rest;
        let mut axes = Axes::XYZ;
        let mut place = 0;
        while let Some((&letter, others)) = rest.split_first() {
            if place >= MORE || axes.index(letter).is_some() || !is_axis(letter) {
                return None;
            }
            axes.more[place] = letter;
            if matches!(letter, b'A' | b'B' | b'C') {
                axes.rotary |= 1 << (place + 3);
            }
            place += 1;
            rest = others;
        }
        Some(axes)
    }

    /// Returns the same axes, with the axes of these letters wrapped. Returns `None` if one of them
    /// is not a rotary axis of this set.
    ///
    /// An absolute position of a wrapped axis is less than a turn. Its sign is the direction in
    /// which the axis moves to it. So `A-90` moves to 90 degrees in the negative direction, and
    /// `A-0` moves to zero in the negative direction. Increments are not wrapped.
    ///
    /// # Source
    /// LinuxCNC, `WRAPPED_ROTARY`: `interp_find.cc`, `unwrap_rotary`.
    pub const fn with_wrapped(mut self, mut letters: &[u8]) -> Option<Axes> {
        while let Some((&letter, rest)) = letters.split_first() {
            match self.index(letter) {
                Some(axis) if self.is_rotary(axis) => self.wrapped |= 1 << axis,
                _ => return None,
            }
            letters = rest;
        }
        Some(self)
    }

    /// The number of axes, 3 to 6.
    #[expect(clippy::len_without_is_empty, reason = "there are always three axes")]
    pub const fn len(&self) -> usize {
        let mut more = 0;
        while more < MORE && self.more[more] != 0 {
            more += 1;
        }
        more + 3
    }

    /// The letter of an axis; `None` for one that this set does not have.
    pub const fn letter(&self, axis: usize) -> Option<u8> {
        match axis {
            0..3 => Some(b"XYZ"[axis]),
            3..AXES if self.more[axis - 3] != 0 => Some(self.more[axis - 3]),
            _ => None,
        }
    }

    /// The letters of all axes, in order.
    pub fn letters(&self) -> impl Iterator<Item = u8> {
        let axes = *self;
        (0..AXES).map_while(move |axis| axes.letter(axis))
    }

    /// The index of the axis of an upper-case letter.
    pub const fn index(&self, letter: u8) -> Option<usize> {
        let mut axis = 0;
        while let Some(known) = self.letter(axis) {
            if known == letter {
                return Some(axis);
            }
            axis += 1;
        }
        None
    }

    /// Whether the coordinates of an axis are degrees.
    pub const fn is_rotary(&self, axis: usize) -> bool {
        axis < AXES && self.rotary >> axis & 1 != 0
    }

    /// Whether absolute positions of an axis are wrapped; see [`Axes::with_wrapped`].
    pub const fn is_wrapped(&self, axis: usize) -> bool {
        axis < AXES && self.wrapped >> axis & 1 != 0
    }

    /// The axes to whose path a feed per minute applies in a move with these lengths, as a bit mask
    /// from X on. These are X, Y and Z if one of them moves, otherwise the other linear axes,
    /// otherwise the rotary axes. So F is in degrees per minute only if nothing but rotary axes
    /// moves.
    ///
    /// # Source
    /// NIST IR 6556, 2.1.2.5; LinuxCNC, `emccanon.cc`, `getStraightVelocity`.
    pub fn fed<const N: usize>(&self, lengths: &[u64; N]) -> u8 {
        const FIRST: u8 = 0b111;
        let (mut moving, mut bit) = (0_u8, 1_u8);
        for length in lengths {
            if *length != 0 {
                moving |= bit;
            }
            bit = bit.wrapping_shl(1);
        }
        let groups = [FIRST, !FIRST & !self.rotary, self.rotary];
        let fed = groups.into_iter().find(|group| group & moving != 0);
        fed.unwrap_or(FIRST)
    }

    /// Whether any axis is wrapped.
    #[cfg(feature = "extended")]
    pub(crate) const fn has_wrapped(&self) -> bool {
        self.wrapped != 0
    }

    /// The letters of words of a dialect with these axes: those that are stored under their own
    /// letter. The other axes are found by [`Axes::slot`].
    #[cfg(feature = "extended")]
    pub(crate) const fn words(&self, dialect: Letters) -> Letters {
        let mut letters = dialect.0 & !OPTIONAL.0;
        let mut axis = 3;
        while let Some(letter) = self.letter(axis) {
            if letter == b'E' {
                // The axis takes its letter away from codes.
                letters &= !bit(b'E');
            } else if slot_of(letter) as usize == axis {
                letters |= bit(letter);
            }
            axis += 1;
        }
        Letters(letters)
    }

    /// The slot of the word of an axis after X, Y and Z.
    #[cold]
    pub(crate) fn slot(&self, letter: u8) -> Option<u8> {
        let axis = self.index(letter).filter(|&axis| axis >= 3);
        axis.map(|axis| axis as u8)
    }

    /// The letter in the program of an axis whose word is stored under this letter; other letters
    /// are unchanged.
    pub(crate) fn written(&self, stored: u8) -> u8 {
        let axis = (3..AXES).find(|&axis| axis_letter(axis) == stored);
        axis.and_then(|axis| self.letter(axis)).unwrap_or(stored)
    }
}

const fn is_axis(letter: u8) -> bool {
    let mut place = 0;
    while place < LETTERS.len() {
        if LETTERS[place] == letter {
            return true;
        }
        place += 1;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_give_their_axes() {
        for (letters, is_known) in [
            (&b"XYZ"[..], true),
            (b"XYZABC", true),
            (b"XYZCB", true),
            (b"XYZUVW", true),
            (b"XYZE", true),
            (b"XYZAA", false),
            (b"XYZX", false),
            (b"XYZI", false),
            (b"XZA", false),
            (b"XYZABCU", false),
        ] {
            let axes = Axes::new(letters);
            assert_eq!(axes.is_some(), is_known);
            if let Some(axes) = axes {
                assert!(axes.letters().eq(letters.iter().copied()));
                assert_eq!(axes.len(), letters.len());
            }
        }
        assert_eq!(Axes::new(b"XYZABC"), Some(Axes::XYZABC));
        assert_eq!(Axes::new(b"XYZE"), Some(Axes::XYZE));
        assert_eq!(Axes::new(b"XYZU").unwrap().with_wrapped(b"U"), None);
    }

    #[test]
    #[cfg(feature = "extended")]
    fn words_of_axes_have_their_slots() {
        let all = Letters::new(b"XYZABCIJKEF");
        let axes = Axes::new(b"XYZBE").unwrap();
        let words = axes.words(all);
        assert_eq!(words.0, Letters::new(b"XYZIJKF").0);
        assert_eq!(
            (axes.slot(b'B'), axes.slot(b'E'), axes.slot(b'A')),
            (Some(3), Some(4), None)
        );
        assert_eq!(
            (axes.written(b'A'), axes.written(b'C'), axes.written(b'F')),
            (b'B', b'C', b'F')
        );
        assert_eq!(Axes::XYZABC.words(all).0, all.0);
    }
}
