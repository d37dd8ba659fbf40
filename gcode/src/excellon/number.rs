//! A number as it is written: without a point its zeros matter.

use super::format::{Format, Units, Zeros};
use crate::decimal::Decimal;
use crate::nm::Nm;

/// A number with the digits that were written, not yet a length.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Number {
    /// Below 10^18.
    digits: i64,
    /// Digits written, leading zeros included: at most 18.
    written: u8,
    /// Digits behind the point, where one is written.
    places: Option<u8>,
    negative: bool,
}

/// The most digits of one number, so that they fit 64 bits.
pub(super) const MOST_DIGITS: u8 = 18;

impl Number {
    /// No digits yet.
    pub(super) const EMPTY: Number = Number {
        digits: 0,
        written: 0,
        places: None,
        negative: false,
    };

    /// Appends a digit; `false` when there is no room.
    pub(super) fn push(&mut self, digit: u8) -> bool {
        if self.written >= MOST_DIGITS {
            return false;
        }
        // digits < 10^17 before this, as fewer than 18 were written.
        let tenfold = self.digits.wrapping_mul(10);
        self.digits = tenfold.wrapping_add(i64::from(digit));
        self.written = self.written.wrapping_add(1);
        if let Some(places) = &mut self.places {
            *places = places.wrapping_add(1);
        }
        true
    }

    /// Sets the point behind the digits so far; `false` when there is one.
    pub(super) fn set_point(&mut self) -> bool {
        let first = self.places.is_none();
        if first {
            self.places = Some(0);
        }
        first
    }

    pub(super) fn set_negative(&mut self) {
        self.negative = true;
    }

    /// Digits written, leading zeros included, 1 to 18.
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

    /// Whether the last digit is a zero.
    pub const fn has_trailing_zero(&self) -> bool {
        self.written > 0 && self.digits % 10 == 0
    }

    /// The value of a whole number without sign and without digits behind a point.
    pub const fn whole(&self) -> Option<u64> {
        match (self.places, self.negative) {
            (None | Some(0), false) => Some(self.digits.unsigned_abs()),
            _ => None,
        }
    }

    /// The value where a missing point is one at the end, as in tool diameters.
    pub fn plain(&self) -> Option<Decimal> {
        self.decimal(self.places.unwrap_or(0))
    }

    /// The value in units of the file; `None` when its digits do not fit 64 bits. With `TZ` it is
    /// `digits / 10^places`; with `LZ` the point is behind the first `whole` digits, so that digits beyond
    /// `whole + places` are further places.
    pub fn value(&self, format: &Format) -> Option<Decimal> {
        if let Some(places) = self.places {
            return self.decimal(places);
        }
        match format.zeros {
            Zeros::Trailing => self.decimal(format.digits.places()),
            Zeros::Leading => {
                let whole = format.digits.whole();
                match self.written.checked_sub(whole) {
                    Some(places) => self.decimal(places),
                    None => {
                        // At most 10^9 in the exponent, as whole <= 9.
                        let left_out = u32::from(whole.wrapping_sub(self.written));
                        let digits = 10_i64
                            .checked_pow(left_out)
                            .and_then(|scale| self.digits.checked_mul(scale))?;
                        Number { digits, ..*self }.decimal(0)
                    }
                }
            }
        }
    }

    /// The length in nanometres, rounded once, halves away from zero; `None` beyond [`Nm::LIMIT`].
    pub fn length(&self, format: &Format) -> Option<Nm> {
        length(self.value(format)?, format.units)
    }

    fn decimal(&self, places: u8) -> Option<Decimal> {
        let digits = if self.negative {
            self.digits.wrapping_neg()
        } else {
            self.digits
        };
        Decimal::new(digits, places)
    }
}

/// A value in file units as nanometres.
pub(super) fn length(value: Decimal, units: Units) -> Option<Nm> {
    let nm = match units {
        Units::Millimetres => value.scaled(1, 6),
        Units::Inches => value.scaled(254, 5),
    };
    Nm(nm?).within_limit()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excellon::Digits;

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
        number(text).length(&format).map(|nm| nm.0)
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
            // Digits beyond the format are further places.
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
        assert!(number("010").has_leading_zero() && number("010").has_trailing_zero());
        assert!(!number("10").has_leading_zero() && !number("11").has_trailing_zero());
        assert!(number("0").has_leading_zero() && !Number::EMPTY.has_leading_zero());
        assert_eq!(number("0070").whole(), Some(70));
        assert_eq!(number("-1").whole(), None);
        let mut full = number("123456789012345678");
        assert!(!full.push(9) && !full.has_leading_zero());
    }
}
