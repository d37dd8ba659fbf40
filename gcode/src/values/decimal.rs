//! Exact decimal numbers as written in a program.

mod arithmetic;

use crate::error::ErrorKind;
use crate::features::EXTENDED;
use crate::values::wide::{divide, product};
use core::fmt;
use fixed::traits::Fixed;

/// An exact decimal: `digits / 10^places`. It keeps the places as written, so `1.50` is not `1.5`
/// (although both are the same length), because the last printed digit shows the intended accuracy.
/// With the feature `extended` it also keeps the sign of a zero, because the sign of a word of a
/// wrapped rotary axis is a direction ([`Axes::with_wrapped`](crate::Axes::with_wrapped)).
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Decimal {
    digits: i64,
    /// The number of places. With the feature `extended` a zero that is written with a minus sign
    /// has the bit [`MINUS`] too: a field of its own takes up to 30 instructions a word.
    places: u8,
}

/// The bit of [`Decimal::places`] of `-0`. There are at most [`Decimal::MAX_PLACES`] places.
const MINUS: u8 = 0x80;

/// The largest power of ten that an `i64` holds.
const MOST: u8 = 18;

/// `10^n`, or `None` beyond 10^18. Only for numbers with many digits: a loop is shorter than a
/// table.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
const fn power(mut n: u8) -> Option<u64> {
    if n > MOST {
        return None;
    }
    let mut power = 1u64;
    while n > 0 {
        power = power.wrapping_mul(10); // at most 10^18
        n = n.wrapping_sub(1);
    }
    Some(power)
}

/// `10^n`, or `None` beyond 10^6.
const fn small_power(n: u32) -> Option<i32> {
    const POWERS: [i32; 7] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000];
    if (n as usize) < POWERS.len() {
        Some(POWERS[n as usize])
    } else {
        None
    }
}

/// `digits * factor * 10^shift`, rounded once; `None` when it does not fit. Values that fit in
/// registers are not kept on the stack.
#[cfg_attr(target_pointer_width = "64", inline(always))]
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
const fn times(digits: i64, factor: i32, shift: i32) -> Option<i64> {
    let small = digits as i32 as i64 == digits && factor.unsigned_abs() <= 2147;
    if small && shift >= 0 {
        if let Some(scale) = small_power(shift as u32) {
            // 2147 * 10^6 < 2^31, so this is one multiplication of 32 by 32 bits, which fits 63.
            let scale = factor.wrapping_mul(scale);
            return Some((digits as i32 as i64).wrapping_mul(scale as i64));
        }
    }
    let (magnitude, by) = (digits.unsigned_abs(), factor.unsigned_abs());
    let scaled = if cfg!(target_pointer_width = "64") {
        times_by_powers(magnitude, by, shift)
    } else {
        times_by_tens(magnitude, by, shift)
    };
    match scaled {
        Some(magnitude) if (digits < 0) != (factor < 0) => Some(magnitude.wrapping_neg()),
        magnitude => magnitude,
    }
}

/// Without signs, for many digits, or places to round away.
#[inline(never)]
const fn times_by_powers(digits: u64, factor: u32, mut shift: i32) -> Option<i64> {
    // Below 2^95.
    let mut scaled = product(digits, factor as u64);
    if scaled == 0 {
        return Some(0);
    }
    while shift > 0 {
        // Too large already; otherwise below 2^64 * 10.
        if scaled >> 64 != 0 {
            return None;
        }
        scaled = product(scaled as u64, 10);
        shift = shift.wrapping_sub(1);
    }
    // In two steps for more than 18 places; the digits dropped by the first step do not change the
    // rounding.
    while shift < 0 {
        let step = if shift < -(MOST as i32) {
            MOST
        } else {
            shift.wrapping_neg() as u8
        };
        let Some(divisor) = power(step) else {
            return None;
        };
        shift = shift.wrapping_add(step as i32);
        if shift == 0 {
            // The power is even.
            scaled = scaled.wrapping_add((divisor >> 1) as u128);
        }
        scaled = divide(scaled, divisor);
    }
    if scaled > i64::MAX as u128 {
        None
    } else {
        Some(scaled as i64)
    }
}

/// The same in steps of ten, in 96 bits of registers: only a multiplication is called.
#[inline(never)]
const fn times_by_tens(digits: u64, factor: u32, mut shift: i32) -> Option<i64> {
    // Below 2^63 * 2^31, the lowest 32 bits apart.
    let below = (digits as u32 as u64).wrapping_mul(factor as u64);
    let above = (digits >> 32).wrapping_mul(factor as u64);
    let mut high = above.wrapping_add(below >> 32);
    let mut low = below as u32;
    if high | low as u64 == 0 {
        return Some(0);
    }
    while shift > 0 {
        // Too large already; otherwise below 2^64 * 10.
        if high >> 32 != 0 {
            return None;
        }
        let below = (low as u64).wrapping_mul(10);
        high = high.wrapping_mul(10).wrapping_add(below >> 32);
        low = below as u32;
        shift = shift.wrapping_sub(1);
    }
    let mut rest = 0u32;
    while shift < 0 {
        rest = 0;
        let mut bits = 96;
        while bits > 0 {
            // rest < 10.
            rest = (rest << 1) | (high >> 63) as u32;
            high = (high << 1) | (low >> 31) as u64;
            low <<= 1;
            if rest >= 10 {
                rest = rest.wrapping_sub(10);
                low |= 1;
            }
            bits = u32::wrapping_sub(bits, 1);
        }
        shift = shift.wrapping_add(1);
    }
    if high >> 31 != 0 {
        return None;
    }
    // The last digit that was dropped is the first after the point. The value is below 2^63; one
    // more may be 2^63.
    let scaled = ((high << 32) | low as u64).wrapping_add((rest >= 5) as u64) as i64;
    if scaled < 0 { None } else { Some(scaled) }
}

impl Decimal {
    /// Zero, without places.
    pub const ZERO: Decimal = Decimal {
        digits: 0,
        places: 0,
    };

    /// The largest number of places.
    pub const MAX_PLACES: u8 = 30;

    /// Creates `digits / 10^places`; `None` for more than [`Decimal::MAX_PLACES`] places or for
    /// `i64::MIN` digits (which have no positive counterpart).
    pub const fn new(digits: i64, places: u8) -> Option<Decimal> {
        if places > Decimal::MAX_PLACES || digits == i64::MIN {
            None
        } else {
            Some(Decimal { digits, places })
        }
    }

    /// All digits as one signed integer.
    pub const fn digits(self) -> i64 {
        self.digits
    }

    /// Number of digits after the point.
    pub const fn places(self) -> u8 {
        if EXTENDED {
            self.places & !MINUS
        } else {
            self.places
        }
    }

    /// Whether the value is below zero.
    pub const fn is_negative(self) -> bool {
        self.digits < 0
    }

    /// Whether the value is zero.
    pub const fn is_zero(self) -> bool {
        self.digits == 0
    }

    /// Whether it was written with a minus sign: [`Decimal::is_negative`], or `-0`.
    #[cfg(feature = "extended")]
    pub const fn has_minus(self) -> bool {
        self.digits < 0 || self.places & MINUS != 0
    }

    /// `value * factor * 10^exponent`, rounded once, halves away from zero; `None` when it does not
    /// fit.
    ///
    /// `scaled(1, 6)` converts millimetres to nanometres. `scaled(254, 5)` converts inches, exactly
    /// for all digits up to the nanometre.
    ///
    /// # Cost
    /// Normally one multiplication or one 64-bit division.
    #[inline(always)]
    pub const fn scaled(self, factor: i32, exponent: u8) -> Option<i64> {
        let shift = (exponent as i32).wrapping_sub(self.places as i32); // of `-0`: any gives 0
        times(self.digits, factor, shift)
    }

    /// The value as an integer if it is one (`2`, `2.0`, `2.`); `None` otherwise.
    pub const fn whole(self) -> Option<i64> {
        self.exactly(0)
    }

    /// `value * 10^exponent` if that is an integer that fits.
    pub(crate) const fn exactly(self, exponent: u8) -> Option<i64> {
        let rounded = self.scaled(1, exponent);
        // The places of `-0` are more than any exponent, and its power is none: it is 0 below.
        if self.places <= exponent {
            return rounded;
        }
        // Fewer than 20 digits after 19 places round to nothing unless they are 0.
        let (Some(rounded), Some(power)) = (rounded, power(self.places.wrapping_sub(exponent)))
        else {
            return if self.is_zero() { Some(0) } else { None };
        };
        // Rounded up it is at most 2^63 / 10 + 1, and the product is within 2^64: it wraps only
        // where it differs.
        if rounded.wrapping_mul(power as i64) == self.digits {
            Some(rounded)
        } else {
            None
        }
    }

    /// One unit of the last place, as an exact decimal.
    pub const fn last_place(self) -> Decimal {
        Decimal {
            digits: 1,
            places: self.places(),
        }
    }

    /// Converts to the nearest number of a `fixed` type, rounded once, halves away from zero;
    /// `None` when it does not fit.
    ///
    /// # Cost
    /// One shift and one subtraction per fraction bit. It is meant for set-up values, not for every
    /// step.
    pub fn to_fixed<F: Fixed>(self) -> Option<F>
    where
        F::Bits: TryFrom<u128> + TryFrom<i128>,
    {
        let magnitude = self.digits.unsigned_abs();
        let mut divisor = 1u128; // 10^30 < 2^100
        for _ in 0..self.places() {
            divisor = divisor.wrapping_mul(10);
        }
        let (mut bits, mut rest) = match u64::try_from(divisor) {
            Ok(divisor) => {
                // The divisor is at least 1, so division by zero cannot occur.
                let whole = magnitude.checked_div(divisor)?;
                (
                    u128::from(whole),
                    u128::from(magnitude.wrapping_sub(whole.wrapping_mul(divisor))),
                )
            }
            // divisor > 2^64 > magnitude
            Err(_) => (0, u128::from(magnitude)),
        };
        for _ in 0..F::FRAC_NBITS {
            if bits >> 127 != 0 {
                return None;
            }
            rest <<= 1; // rest < divisor < 2^100
            bits <<= 1;
            if rest >= divisor {
                rest = rest.wrapping_sub(divisor);
                bits |= 1;
            }
        }
        if rest << 1 >= divisor {
            bits = bits.checked_add(1)?;
        }
        let bits = if self.is_negative() {
            F::Bits::try_from(0i128.checked_sub_unsigned(bits)?).ok()?
        } else {
            F::Bits::try_from(bits).ok()?
        };
        Some(F::from_bits(bits))
    }

    /// Up to nine digits, `places` of them after the point. `None` for `-0`, which is rare, so that
    /// other words do not pay for it.
    #[inline(always)]
    pub(crate) fn short(digits: u32, places: u8, negative: bool) -> Option<Decimal> {
        // Below 10^9 < 2^31, so 32 bits hold the sign.
        let mut digits = digits as i32;
        if negative {
            if EXTENDED && digits == 0 {
                return None;
            }
            digits = digits.wrapping_neg();
        }
        Some(Decimal {
            digits: i64::from(digits),
            places,
        })
    }

    /// The same, and `-0` too.
    #[inline(always)]
    pub(crate) fn any_short(digits: u32, places: u8, negative: bool) -> Decimal {
        let minus_zero = Decimal {
            digits: 0,
            places: places | MINUS,
        };
        Decimal::short(digits, places, negative).unwrap_or(minus_zero)
    }

    /// Appends a digit written before the point, or after it (`place`). Trailing zeros that no
    /// longer fit are dropped; they do not change the value.
    pub(crate) fn push(&mut self, digit: u8, place: bool) -> Result<(), ErrorKind> {
        // The largest value whose tenfold fits; with the digit it is below 2^64.
        let fits = self.digits <= i64::MAX / 10 && !(place && self.places >= Decimal::MAX_PLACES);
        let ten = (self.digits << 3).wrapping_add(self.digits << 1);
        let next = ten.wrapping_add(i64::from(digit));
        if fits && next >= 0 {
            self.digits = next;
            self.places = self.places.wrapping_add(place.into());
            return Ok(());
        }
        match (place, digit) {
            (true, 0) => Ok(()),
            (true, _) => Err(ErrorKind::TooManyDigits),
            (false, _) => Err(ErrorKind::NumberTooLarge),
        }
    }

    /// A positive number with a minus sign. (`i64::MIN` is never stored.)
    pub(crate) fn negated(self) -> Decimal {
        let is_zero = EXTENDED && self.is_zero();
        Decimal {
            digits: self.digits.wrapping_neg(),
            places: self.places | if is_zero { MINUS } else { 0 },
        }
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.digits.unsigned_abs();
        let has_minus = self.digits < 0 || self.places & MINUS != 0;
        let (sign, places) = (if has_minus { "-" } else { "" }, self.places());
        if places == 0 {
            return write!(f, "{sign}{magnitude}");
        }
        let width = usize::from(places);
        // Beyond 10^18 the divisor exceeds all but 19-digit numbers; 10^19 still fits u64, 10^20
        // exceeds every number.
        let divisor = 10u64.checked_pow(u32::from(places));
        let whole = divisor
            .and_then(|divisor| magnitude.checked_div(divisor))
            .unwrap_or(0);
        let rest = divisor
            .and_then(|divisor| magnitude.checked_rem(divisor))
            .unwrap_or(magnitude);
        write!(f, "{sign}{whole}.{rest:0width$}")
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use fixed::types::{I16F16, I32F32, U0F128};
    use std::string::ToString;

    fn decimal(digits: i64, places: u8) -> Decimal {
        Decimal::new(digits, places).unwrap()
    }

    #[test]
    #[cfg(feature = "extended")]
    fn a_zero_keeps_its_sign_and_places() {
        let minus = Decimal::any_short(0, 2, true);
        assert_eq!(minus, decimal(0, 2).negated());
        assert_ne!(minus, decimal(0, 2));
        assert!(minus.has_minus() && minus.is_zero() && !minus.is_negative());
        assert_eq!((minus.places(), minus.digits()), (2, 0));
        assert_eq!(minus.to_string(), "-0.00");
        assert_eq!((minus.scaled(254, 5), minus.whole()), (Some(0), Some(0)));
        assert_eq!(minus.to_fixed::<I16F16>(), Some(I16F16::ZERO));
        assert_eq!(minus.last_place(), decimal(1, 2));
        assert!(decimal(-1, 0).has_minus() && !decimal(0, 0).has_minus());
    }

    #[test]
    fn scales_exactly_and_rounds_halves_away_from_zero() {
        assert_eq!(decimal(12345, 3).scaled(1, 6), Some(12_345_000));
        assert_eq!(decimal(1, 0).scaled(254, 5), Some(25_400_000));
        assert_eq!(decimal(1, 4).scaled(254, 5), Some(2_540));
        assert_eq!(decimal(5, 7).scaled(1, 6), Some(1));
        assert_eq!(decimal(-5, 7).scaled(1, 6), Some(-1));
        assert_eq!(decimal(4_999_999, 13).scaled(1, 6), Some(0));
        assert_eq!(decimal(i64::MAX, 0).scaled(1, 6), None);
        assert_eq!(decimal(0, 0).scaled(1, 40), Some(0));
        // 922.3372036854775807 inches: the product alone does not fit 64 bits.
        assert_eq!(decimal(i64::MAX, 16).scaled(254, 5), Some(23_427_364_974));
        assert_eq!(decimal(-i64::MAX, 30).scaled(254, 5), Some(0));
        assert_eq!(decimal(i64::MAX, 20).scaled(-254, 5), Some(-2_342_736));
    }

    #[test]
    #[cfg_attr(miri, ignore = "too much of it to interpret")]
    fn both_ways_scale_alike() {
        let numbers = (0..63).flat_map(|bit| {
            let power = 1u64 << bit;
            [
                power - 1,
                power,
                power + 1,
                i64::MAX as u64 >> (62 - bit),
                power | 12345,
            ]
        });
        for digits in numbers.filter(|&digits| i64::try_from(digits).is_ok()) {
            for factor in [0, 1, 5, 127, 254, 3048, 1 << 31] {
                for shift in -31..=9 {
                    assert_eq!(
                        times_by_tens(digits, factor, shift),
                        times_by_powers(digits, factor, shift),
                        "{digits} {factor} {shift}"
                    );
                }
            }
        }
    }

    #[test]
    fn prints_as_written() {
        for (digits, places, text) in [
            (150, 2, "1.50"),
            (-5, 3, "-0.005"),
            (7, 0, "7"),
            (3, 21, "0.000000000000000000003"),
        ] {
            assert_eq!(decimal(digits, places).to_string(), text);
        }
        assert_eq!(decimal(i64::MAX, 19).to_string(), "0.9223372036854775807");
    }

    #[test]
    fn whole_numbers() {
        assert_eq!(decimal(200, 2).whole(), Some(2));
        assert_eq!(decimal(201, 2).whole(), None);
        assert_eq!(decimal(382, 1).exactly(1), Some(382));
        assert_eq!(decimal(1012, 2).exactly(1), None);
        assert_eq!(decimal(0, 30).whole(), Some(0));
        assert_eq!(decimal(1, 30).whole(), None);
    }

    #[test]
    fn to_fixed_rounds_once() {
        assert_eq!(
            decimal(15, 1).to_fixed::<I16F16>(),
            Some(I16F16::from_num(1.5))
        );
        assert_eq!(
            decimal(-1, 1).to_fixed::<I16F16>(),
            Some(I16F16::from_bits(-6554))
        );
        assert_eq!(decimal(32768, 0).to_fixed::<I16F16>(), None);
        assert_eq!(decimal(-32768, 0).to_fixed::<I16F16>(), Some(I16F16::MIN));
        assert_eq!(decimal(1, 30).to_fixed::<I32F32>(), Some(I32F32::ZERO));
        assert_eq!(
            decimal(5, 1).to_fixed::<U0F128>(),
            Some(U0F128::from_bits(1 << 127))
        );
        assert_eq!(decimal(-5, 1).to_fixed::<U0F128>(), None);
        assert_eq!(
            decimal(i64::MAX, 0)
                .to_fixed::<fixed::types::I64F64>()
                .map(|x| x.to_num::<i64>()),
            Some(i64::MAX)
        );
    }
}
