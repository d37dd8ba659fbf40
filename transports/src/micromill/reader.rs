//! The characters of a string, from its beginning.

use super::Axis;

/// The rest of a string.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reader<'a>(pub(super) &'a [u8]);

impl Reader<'_> {
    /// Takes this character, if it is next.
    pub(super) fn takes(&mut self, character: u8) -> bool {
        match self.0.split_first() {
            Some((first, rest)) if *first == character => {
                self.0 = rest;
                true
            }
            _ => false,
        }
    }

    pub(super) fn axis(&mut self) -> Option<Axis> {
        Axis::ALL.into_iter().find(|axis| self.takes(axis.letter()))
    }

    /// Takes `+` or `-`. Returns whether it is `+`.
    pub(super) fn way(&mut self) -> Option<bool> {
        if self.takes(b'+') {
            Some(true)
        } else if self.takes(b'-') {
            Some(false)
        } else {
            None
        }
    }

    /// Takes a number of `least` to `most` digits. `most` is below 10, so the number is below 10^9.
    pub(super) fn digits(&mut self, least: u8, most: u8) -> Option<u32> {
        let (mut value, mut count) = (0_u32, 0_u8);
        while let Some((first, rest)) = self.0.split_first() {
            if !first.is_ascii_digit() || count >= most {
                break;
            }
            let digit = u32::from(first.wrapping_sub(b'0'));
            value = value.wrapping_mul(10).wrapping_add(digit);
            count = count.wrapping_add(1); // at most `most`
            self.0 = rest;
        }
        (count >= least).then_some(value)
    }

    /// Takes the word with this letter, if it is next. The word has an optional sign, one to five
    /// digits of micrometres and up to two decimals. Returns its value in units of 10 nm.
    pub(super) fn coordinate(&mut self, letter: u8) -> Option<Option<i32>> {
        if !self.takes(letter) {
            return Some(None);
        }
        let is_forward = self.way().unwrap_or(true);
        let whole = self.digits(1, 5)?;
        let mut parts = whole.wrapping_mul(100); // below 10^7
        if self.takes(b'.') {
            let tenths = self.digits(1, 1)?;
            let hundredths = self.digits(0, 1)?;
            parts = parts.wrapping_add(tenths.wrapping_mul(10).wrapping_add(hundredths));
        }
        let parts = parts as i32;
        Some(Some(if is_forward {
            parts
        } else {
            parts.wrapping_neg()
        }))
    }

    /// Takes the number of a letter. The letter must be next.
    pub(super) fn word(&mut self, letter: u8, least: u8, most: u8) -> Option<u16> {
        if !self.takes(letter) {
            return None;
        }
        let value = self.digits(least, most)?;
        u16::try_from(value).ok()
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
