//! Numbers as written. In a number without a point the zeros matter.

use crate::format::{Format, Units, Zeros};
use crate::length::length_nm;

/// A number with its written digits, before conversion to a length.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Number {
    /// Below 10^18.
    digits: i64,
    /// Digits written, leading zeros included: at most 18.
    written: u8,
    /// Digits after the point, if a point is written.
    places: Option<u8>,
    negative: bool,
}

/// Largest number of digits, so that they fit 64 bits.
pub(crate) const MOST_DIGITS: u8 = 18;

impl Number {
    /// A number without digits.
    pub(crate) const EMPTY: Number = Number {
        digits: 0,
        written: 0,
        places: None,
        negative: false,
    };

    /// Appends a digit. Returns `false` if there is no room.
    pub(crate) fn push(&mut self, digit: u8) -> bool {
        if self.written >= MOST_DIGITS {
            return false;
        }
        // Fewer than 18 digits were written, so digits < 10^17 before this.
        let tenfold = self.digits.wrapping_mul(10);
        self.digits = tenfold.wrapping_add(i64::from(digit));
        self.written = self.written.wrapping_add(1);
        if let Some(places) = &mut self.places {
            *places = places.wrapping_add(1);
        }
        true
    }

    /// Sets the point after the digits so far. Returns `false` if there is one already.
    pub(crate) fn set_point(&mut self) -> bool {
        let first = self.places.is_none();
        if first {
            self.places = Some(0);
        }
        first
    }

    pub(crate) fn set_negative(&mut self) {
        self.negative = true;
    }

    /// Returns the number of written digits with leading zeros, 1 to 18.
    pub const fn written(&self) -> u8 {
        self.written
    }

    /// Whether a point is written.
    pub const fn has_point(&self) -> bool {
        self.places.is_some()
    }

    /// Whether the value is zero.
    pub const fn is_zero(&self) -> bool {
        self.digits == 0
    }

    /// Whether the first digit is a zero.
    pub fn has_leading_zero(&self) -> bool {
        let least = 10_i64.checked_pow(u32::from(self.written.wrapping_sub(1)));
        self.written > 0 && least.is_some_and(|least| self.digits < least)
    }

    /// Returns the value of an integer without sign and without digits after a point.
    pub const fn whole(&self) -> Option<u64> {
        match (self.places, self.negative) {
            (None | Some(0), false) => Some(self.digits.unsigned_abs()),
            _ => None,
        }
    }

    /// Returns the length in nanometres. A missing point counts as a point at the end, as in tool
    /// diameters. The point is `shift` digits further left than written.
    pub fn plain_nm(&self, units: Units, shift: u8) -> Option<i64> {
        let places = self.places.unwrap_or(0).wrapping_add(shift); // at most 18 + 3
        length_nm(self.signed(), places, units)
    }

    /// Returns the length in nanometres, rounded once, halves away from zero. Returns `None` beyond
    /// [`LIMIT_NM`](crate::LIMIT_NM).
    ///
    /// With `TZ` the length is `digits / 10^places` units of the file. With `LZ` the point follows
    /// the first `whole` digits. Digits beyond `whole + places` are further decimal places.
    pub fn length_nm(&self, format: &Format) -> Option<i64> {
        let length = |places| length_nm(self.signed(), places, format.units);
        if let Some(places) = self.places {
            return length(places);
        }
        match format.zeros {
            Zeros::Trailing => length(format.digits.places()),
            Zeros::Leading => {
                let whole = format.digits.whole();
                match self.written.checked_sub(whole) {
                    Some(places) => length(places),
                    None => {
                        // The scale is at most 10^9, because whole <= 9.
                        let left_out = u32::from(whole.wrapping_sub(self.written));
                        let digits = 10_i64
                            .checked_pow(left_out)
                            .and_then(|scale| self.signed().checked_mul(scale))?;
                        length_nm(digits, 0, format.units)
                    }
                }
            }
        }
    }

    const fn signed(&self) -> i64 {
        if self.negative {
            self.digits.wrapping_neg()
        } else {
            self.digits
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Digits;

    fn number(text: &str) -> Number {
        let mut number = Number::EMPTY;
        for byte in text.bytes() {
            match byte {
                b'.' => assert!(number.set_point()),
                b'-' => number.set_negative(),
                digit => assert!(number.push(digit - b'0')),
            }
        }
        number
    }

    fn nm(text: &str, units: Units, zeros: Zeros, whole: u8, places: u8) -> Option<i64> {
        let digits = Digits::new(whole, places).unwrap();
        let format = Format {
            units,
            zeros,
            digits,
        };
        number(text).length_nm(&format)
    }

    #[test]
    fn the_number_rule() {
        use Units::{Inches, Millimetres};
        use Zeros::{Leading, Trailing};
        for (text, units, zeros, whole, places, expected) in [
            ("2.1142", Inches, Trailing, 2, 4, 53_700_680),
            ("-3.2126", Inches, Leading, 2, 4, -81_600_040),
            ("25679", Millimetres, Trailing, 3, 3, 25_679_000),
            ("015607", Inches, Leading, 2, 4, 39_641_780),
            ("002365", Millimetres, Leading, 4, 4, 23_650_000),
            ("019018", Millimetres, Trailing, 3, 3, 19_018_000),
            ("438400", Millimetres, Trailing, 3, 3, 438_400_000),
            ("0152", Inches, Leading, 2, 3, 38_608_000),
            ("1", Inches, Leading, 2, 4, 254_000_000),
            ("-1", Inches, Trailing, 2, 4, -2_540),
            // Digits beyond the format are further decimal places.
            ("01234567", Inches, Leading, 2, 4, 31_358_002),
            (".5", Millimetres, Trailing, 3, 3, 500_000),
            ("55.", Millimetres, Trailing, 3, 3, 55_000_000),
        ] {
            assert_eq!(
                nm(text, units, zeros, whole, places),
                Some(expected),
                "{text}"
            );
        }
        let large = "999999999999999999";
        assert_eq!(nm(large, Inches, Trailing, 2, 0), None);
        assert_eq!(
            nm(large, Inches, Leading, 2, 4),
            Some(25 * 100_000_000 + 40_000_000)
        );
    }

    #[test]
    fn zeros_are_seen() {
        assert!(number("010").has_leading_zero());
        assert!(!number("10").has_leading_zero());
        assert!(number("0").has_leading_zero() && !Number::EMPTY.has_leading_zero());
        assert_eq!(number("0070").whole(), Some(70));
        assert_eq!(number("-1").whole(), None);
        let mut full = number("123456789012345678");
        assert!(!full.push(9) && !full.has_leading_zero());
    }
}
