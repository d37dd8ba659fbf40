//! Values of expressions: decimals of up to 18 places that record whether they are exact.

use crate::values::decimal::Decimal;
use core::cmp::Ordering;

/// The number of an expression or a parameter: `digits / 10^places`, with at most
/// [`Value::MAX_PLACES`] places.
///
/// Sums, differences and products are exact while 63 bits hold their digits. Otherwise they are
/// rounded once (halves away from zero) to as many places as fit. Quotients are rounded to 18
/// places or 18 digits.
///
/// A value that was ever rounded, and every result of a function that cannot be exact, is marked:
/// [`Value::is_exact`]. For the operators `EQ` to `LE`, marked values within 10^-9 of each other
/// are equal. Where a whole number is needed (FIX, FUP, parameter numbers), a marked value within
/// 10^-9 of a whole number counts as that number: `3*[1/3]` is 1. Exact values are compared
/// exactly.
#[derive(Copy, Clone, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Value {
    /// Never `i64::MIN`.
    digits: i64,
    /// At most 18.
    places: u8,
    rounded: bool,
}

/// The largest magnitude of the digits.
const MOST: u64 = i64::MAX as u64;

/// `10^n` for n in 0..=19, the powers a `u64` holds.
const POWERS: [u64; 20] = {
    let mut powers = [1; 20];
    let mut n = 1;
    while n < powers.len() {
        powers[n] = powers[n - 1] * 10;
        n += 1;
    }
    powers
};

/// `10^n` for n up to 19; larger n never occur.
pub(super) fn power(n: u8) -> u64 {
    POWERS.get(usize::from(n)).copied().unwrap_or(u64::MAX)
}

/// Quotient and remainder; zeros for a divisor of 0, which never occurs.
fn divide(value: u64, divisor: u64) -> (u64, u64) {
    match (value.checked_div(divisor), value.checked_rem(divisor)) {
        (Some(quotient), Some(rest)) => (quotient, rest),
        _ => (0, 0),
    }
}

/// The next digit of a long division and its remainder; `rest < divisor <= 2^63`.
fn next_digit(rest: u64, divisor: u64) -> (u64, u64) {
    if let Some(ten) = rest.checked_mul(10) {
        return divide(ten, divisor);
    }
    let (mut rest, mut digit) = (u128::from(rest).wrapping_mul(10), 0u64);
    // At most nine times: rest < 10 divisor.
    while rest >= u128::from(divisor) && digit < 10 {
        rest = rest.wrapping_sub(u128::from(divisor));
        digit = digit.wrapping_add(1);
    }
    (digit, rest as u64)
}

/// `value / 10^k` rounded down, in limbs of 32 bits, so that no 128-bit division is linked in.
fn divide_by_power(mut value: u128, mut k: u8) -> u128 {
    while k > 0 {
        let part = k.min(9);
        let divisor = power(part);
        let (mut quotient, mut rest, mut shift) = (0u128, 0u64, 128u32);
        while shift > 0 {
            shift = shift.wrapping_sub(32);
            // rest < 10^9 < 2^30, so the 62-bit dividend fits.
            let limb = (rest << 32) | (value.wrapping_shr(shift) as u64 & 0xffff_ffff);
            let (digits, left) = divide(limb, divisor);
            quotient = (quotient << 32) | u128::from(digits);
            rest = left;
        }
        value = quotient;
        k = k.wrapping_sub(part);
    }
    value
}

impl Value {
    /// Zero: the value of a numbered parameter before its first assignment.
    pub const ZERO: Value = Value::whole_number(0);

    /// One: the value of true.
    pub const ONE: Value = Value::whole_number(1);

    /// The largest number of places of a value.
    pub const MAX_PLACES: u8 = 18;

    const fn whole_number(digits: i64) -> Value {
        Value {
            digits,
            places: 0,
            rounded: false,
        }
    }

    /// `digits / 10^places`, exact; `None` for more than [`Value::MAX_PLACES`] places or digits of
    /// `i64::MIN`.
    pub fn new(digits: i64, places: u8) -> Option<Value> {
        let value = Value {
            digits,
            places,
            rounded: false,
        };
        (places <= Value::MAX_PLACES && digits != i64::MIN).then_some(value)
    }

    /// Whether the value was never rounded.
    pub const fn is_exact(self) -> bool {
        !self.rounded
    }

    /// All digits as one signed integer.
    pub const fn digits(self) -> i64 {
        self.digits
    }

    /// Number of digits after the point.
    pub const fn places(self) -> u8 {
        self.places
    }

    /// The whole number that it is or counts as; `None` otherwise.
    pub fn whole(self) -> Option<i64> {
        let near = self.rounded_half();
        (self.compare(near) == Ordering::Equal).then_some(near.digits)
    }

    /// Converts to the number of a word: an exact value unchanged, a rounded one to 12 places.
    pub fn to_decimal(self) -> Decimal {
        let value = if self.rounded { self.limited(12) } else { self };
        Decimal::new(value.digits, value.places).unwrap_or(Decimal::ZERO)
    }

    pub(super) const fn truth(value: bool) -> Value {
        Value::whole_number(value as i64)
    }

    pub(super) const fn is_negative(self) -> bool {
        self.digits < 0
    }

    pub(super) const fn is_zero(self) -> bool {
        self.digits == 0
    }

    pub(super) const fn marked_rounded(self) -> Value {
        Value {
            rounded: true,
            ..self
        }
    }

    pub(super) const fn negated(self) -> Value {
        Value {
            digits: self.digits.wrapping_neg(),
            ..self
        }
    }

    pub(super) fn magnitude(self) -> Value {
        Value {
            digits: self.digits.wrapping_abs(),
            ..self
        }
    }

    /// A magnitude below 2^127 with up to 37 places, rounded once to fit; `None` when the whole
    /// part does not fit.
    pub(super) fn fitted(
        magnitude: u128,
        places: u8,
        negative: bool,
        rounded: bool,
    ) -> Option<Value> {
        let mut drop = places.saturating_sub(Value::MAX_PLACES);
        // 2^63 * 10^19 > 2^126, so the loop ends before 20.
        while magnitude > u128::from(MOST).wrapping_mul(u128::from(power(drop))) && drop < 19 {
            drop = drop.wrapping_add(1);
        }
        let places = places.checked_sub(drop)?;
        let (mut digits, mut lost) = (magnitude, false);
        if drop > 0 {
            let unit = u128::from(power(drop));
            // Below 2^127 + 2^63.
            digits = divide_by_power(magnitude.wrapping_add(unit >> 1), drop);
            lost = digits.wrapping_mul(unit) != magnitude;
        }
        let digits = i64::try_from(digits).ok()?;
        Some(Value {
            digits: if negative {
                digits.wrapping_neg()
            } else {
                digits
            },
            places,
            rounded: rounded | lost,
        })
    }

    /// The same value rounded to at most so many places.
    pub(super) fn limited(self, places: u8) -> Value {
        let Some(drop) = self.places.checked_sub(places).filter(|&drop| drop > 0) else {
            return self;
        };
        let unit = power(drop);
        let magnitude = self.digits.unsigned_abs();
        let (whole, rest) = divide(magnitude, unit);
        // unit is even; the quotient is at most 2^63 / 10.
        let digits = whole.wrapping_add(u64::from(rest >= unit >> 1)) as i64;
        Value {
            digits: if self.digits < 0 {
                digits.wrapping_neg()
            } else {
                digits
            },
            places,
            rounded: self.rounded | (rest != 0),
        }
    }

    /// The value without trailing zeros.
    pub(super) fn stripped(mut self) -> Value {
        while self.places > 0 {
            let (rest, digit) = divide(self.digits.unsigned_abs(), 10);
            if digit != 0 {
                break;
            }
            self.digits = if self.digits < 0 {
                (rest as i64).wrapping_neg()
            } else {
                rest as i64
            };
            self.places = self.places.wrapping_sub(1);
        }
        self
    }

    /// Digits at 18 places: below 2^63 * 10^18 < 2^123.
    const fn widened(self) -> i128 {
        let scale = match Value::MAX_PLACES.checked_sub(self.places) {
            Some(n) if (n as usize) < POWERS.len() => POWERS[n as usize],
            _ => 1,
        };
        (self.digits as i128).wrapping_mul(scale as i128)
    }

    /// The sum; `None` when it is too large.
    pub(super) fn plus(self, other: Value) -> Option<Value> {
        let rounded = self.rounded | other.rounded;
        if self.places == other.places {
            // The sum is never i64::MIN: both are above -2^63, and -2^63 has its own check.
            if let Some(digits) = self
                .digits
                .checked_add(other.digits)
                .filter(|&d| d != i64::MIN)
            {
                return Some(Value {
                    digits,
                    places: self.places,
                    rounded,
                });
            }
        }
        let places = self.places.max(other.places);
        let at = |value: Value| {
            // 2^63 * 10^18 < 2^123, so the sum fits.
            i128::from(value.digits)
                .wrapping_mul(i128::from(power(places.wrapping_sub(value.places))))
        };
        let sum = at(self).wrapping_add(at(other));
        Value::fitted(sum.unsigned_abs(), places, sum < 0, rounded)
    }

    /// The product; `None` when it is too large.
    pub(super) fn times(self, other: Value) -> Option<Value> {
        let rounded = self.rounded | other.rounded;
        let places = self.places.wrapping_add(other.places); // at most 36
        if places <= Value::MAX_PLACES {
            let product = self.digits.checked_mul(other.digits);
            if let Some(digits) = product.filter(|&digits| digits != i64::MIN) {
                return Some(Value {
                    digits,
                    places,
                    rounded,
                });
            }
        }
        let product = u128::from(self.digits.unsigned_abs())
            .wrapping_mul(u128::from(other.digits.unsigned_abs()));
        let negative = (self.digits < 0) != (other.digits < 0);
        Value::fitted(product, places, negative, rounded)
    }

    /// The quotient, to 18 places or as many digits as fit; `None` when it is too large or the
    /// divisor is zero.
    ///
    /// This is a long division, six digits at a time for divisors below 2^44.
    pub(super) fn divided_by(self, other: Value) -> Option<Value> {
        const CHUNK: u64 = 1_000_000;
        let (numerator, divisor) = (self.digits.unsigned_abs(), other.digits.unsigned_abs());
        let mut quotient = numerator.checked_div(divisor)?;
        let mut rest = numerator.checked_rem(divisor)?;
        // -18..=18
        let mut places = (self.places as i8).wrapping_sub(other.places as i8);
        while places < 18 && (places < 0 || rest != 0) {
            let ahead = rest
                .checked_mul(CHUNK)
                .filter(|_| (0..=12).contains(&places));
            let (next, left, digits) = match (ahead, quotient.checked_mul(CHUNK)) {
                (Some(rest), Some(quotient)) if quotient <= MOST.wrapping_sub(CHUNK) => {
                    let (chunk, left) = divide(rest, divisor);
                    (Some(quotient.wrapping_add(chunk)), left, 6)
                }
                _ => {
                    let (digit, left) = next_digit(rest, divisor);
                    let next = quotient
                        .checked_mul(10)
                        .and_then(|ten| ten.checked_add(digit));
                    (next.filter(|&next| next <= MOST), left, 1)
                }
            };
            let Some(next) = next else { break };
            (quotient, rest) = (next, left);
            places = places.wrapping_add(digits);
        }
        let places = u8::try_from(places).ok()?;
        // divisor - rest is above zero.
        if rest != 0 && rest >= divisor.wrapping_sub(rest) {
            quotient = quotient.wrapping_add(1);
        }
        let digits = i64::try_from(quotient).ok()?;
        let value = Value {
            digits: if (self.digits < 0) != (other.digits < 0) {
                digits.wrapping_neg()
            } else {
                digits
            },
            places,
            rounded: self.rounded | other.rounded | (rest != 0),
        };
        Some(if rest == 0 { value.stripped() } else { value })
    }

    /// The remainder of a division, from 0 up to the magnitude of the divisor; `None` for a divisor
    /// of zero.
    pub(super) fn modulo(self, other: Value) -> Option<Value> {
        if other.digits == 0 {
            return None;
        }
        let places = self.places.max(other.places);
        let rounded = self.rounded | other.rounded;
        // Below 10^18 * 2^63 < 2^123.
        let divisor = u128::from(other.digits.unsigned_abs())
            .wrapping_mul(u128::from(power(places.wrapping_sub(other.places))));
        let numerator = self.digits.unsigned_abs();
        let rest = match u64::try_from(divisor) {
            // Larger than any numerator, which then has more places.
            Err(_) => u128::from(numerator),
            Ok(divisor) => {
                let mut rest = numerator.checked_rem(divisor)?;
                for _ in self.places..places {
                    rest = next_digit(rest, divisor).1;
                }
                u128::from(rest)
            }
        };
        let rest = match self.digits < 0 && rest != 0 {
            true => divisor.wrapping_sub(rest),
            false => rest,
        };
        let value = Value::fitted(rest, places, false, rounded)?;
        let top = Value::fitted(divisor, places, false, rounded)?;
        Some(match value.compare(top) {
            Ordering::Equal => Value::ZERO.marked_rounded(),
            _ => value,
        })
    }

    /// Compares two values; rounded values within 10^-9 are equal.
    pub(super) fn compare(self, other: Value) -> Ordering {
        let (left, right) = (self.widened(), other.widened());
        let slack = match self.rounded | other.rounded {
            true => 1_000_000_000,
            false => 1,
        };
        if left.abs_diff(right) < slack {
            Ordering::Equal
        } else {
            left.cmp(&right)
        }
    }

    /// The nearest whole number, halves away from zero.
    pub(super) fn rounded_half(self) -> Value {
        Value {
            rounded: false,
            ..self.limited(0)
        }
    }

    /// The next whole number at or below it (FIX).
    pub(super) fn floor(self) -> Value {
        let near = self.rounded_half();
        match self.compare(near) {
            // At most 0.5 above, so nothing overflows.
            Ordering::Less => Value::whole_number(near.digits.wrapping_sub(1)),
            _ => near,
        }
    }

    /// The next whole number at or above it (FUP).
    pub(super) fn ceiling(self) -> Value {
        self.negated().floor().negated()
    }

    /// Raises to a whole power by squaring; `None` when it is too large.
    pub(super) fn to_whole_power(self, exponent: i64) -> Option<Value> {
        let mut left = exponent.unsigned_abs();
        let (mut result, mut square) = (Value::ONE, self);
        let power = loop {
            if left & 1 != 0 {
                match result.times(square) {
                    Some(product) => result = product,
                    None => break None,
                }
            }
            left >>= 1;
            if left == 0 {
                break Some(result);
            }
            match square.times(square) {
                Some(product) => square = product,
                None => break None,
            }
        };
        match power {
            _ if exponent >= 0 => power,
            Some(power) => Value::ONE.divided_by(power),
            // The inverse of a value beyond 9 * 10^18.
            None => Some(Value::ZERO.marked_rounded()),
        }
    }
}

impl core::fmt::Display for Value {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        Decimal::new(self.digits, self.places)
            .unwrap_or(Decimal::ZERO)
            .fmt(f)
    }
}

impl From<i32> for Value {
    fn from(number: i32) -> Value {
        Value::whole_number(i64::from(number))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    fn value(digits: i64, places: u8) -> Value {
        Value::new(digits, places).unwrap()
    }

    #[test]
    fn quotients_end_or_have_eighteen_digits() {
        let show = |a: Value, b: Value| {
            let quotient = a.divided_by(b).unwrap();
            (quotient.to_string(), quotient.is_exact())
        };
        assert_eq!(show(value(1, 0), value(4, 0)), ("0.25".into(), true));
        assert_eq!(show(value(-1, 0), value(1, 3)), ("-1000".into(), true));
        assert_eq!(
            show(value(2, 0), value(3, 0)),
            ("0.666666666666666667".into(), false)
        );
        assert_eq!(
            show(value(100, 0), value(3, 0)),
            ("33.33333333333333333".into(), false)
        );
        assert_eq!(
            show(value(i64::MAX, 18), value(i64::MAX, 0)).0,
            "0.000000000000000001"
        );
        assert!(value(1, 0).divided_by(value(1, 18)).is_some());
        assert!(value(10, 0).divided_by(value(1, 18)).is_none());
        assert!(value(1, 0).divided_by(Value::ZERO).is_none());
    }

    #[test]
    fn a_third_three_times_is_one() {
        let third = Value::ONE.divided_by(value(3, 0)).unwrap();
        let one = third.times(value(3, 0)).unwrap();
        assert_eq!(
            (one.whole(), one.floor().digits(), one.ceiling().digits()),
            (Some(1), 1, 1)
        );
        assert_eq!(one.modulo(Value::ONE).unwrap().whole(), Some(0));
        assert_eq!(value(999_999_999_999, 12).floor().digits(), 0);
        assert_eq!(one.to_decimal().to_string(), "1.000000000000");
    }

    #[test]
    fn floors_and_powers() {
        assert_eq!(value(-25, 1).floor().digits(), -3);
        assert_eq!(value(-25, 1).ceiling().digits(), -2);
        assert_eq!(value(-25, 1).rounded_half().digits(), -3);
        assert_eq!(value(24, 1).ceiling().digits(), 3);
        assert_eq!(value(11, 1).to_whole_power(3).unwrap().to_string(), "1.331");
        assert_eq!(value(2, 0).to_whole_power(-2).unwrap().to_string(), "0.25");
        assert!(value(10, 0).to_whole_power(19).is_none());
        assert!(value(10, 0).to_whole_power(-30).unwrap().is_zero());
        assert_eq!(value(-7, 0).modulo(value(3, 0)).unwrap().to_string(), "2");
        assert_eq!(
            value(-7, 0).modulo(value(-25, 1)).unwrap().to_string(),
            "0.5"
        );
    }

    /// A result is exact where all operands are and nothing was dropped.
    #[test]
    fn exactness_is_inherited() {
        type Operation = fn(Value, Value) -> Option<Value>;
        let operations: [Operation; 4] =
            [Value::plus, Value::times, Value::divided_by, Value::modulo];
        for (a, b) in [
            (value(6, 0), value(2, 0)),
            (value(6, 0), value(25, 1)),
            (value(i64::MAX - 7, 0), value(1, 0)),
            (value(125, 10), value(5, 18)),
        ] {
            let marked = [a.marked_rounded(), b.marked_rounded()];
            assert!(!marked[0].is_exact() && a.is_exact());
            for operation in operations {
                for (a, b) in [(marked[0], b), (a, marked[1]), (marked[0], marked[1])] {
                    if let Some(result) = operation(a, b) {
                        assert!(!result.is_exact(), "{a} {b} {result}");
                    }
                }
            }
            assert!(a.plus(b).is_none_or(Value::is_exact));
        }
        let third = Value::ONE.divided_by(value(3, 0)).unwrap();
        assert!(!third.limited(3).is_exact() && !value(15, 1).limited(0).is_exact());
        assert!(value(10, 1).limited(0).is_exact());
        assert!(!value(10, 1).marked_rounded().limited(0).is_exact());
        assert!(third.rounded_half().is_exact());
        assert!(!Value::ZERO.is_negative());
    }

    /// A result with more digits than fit is rounded once, halves up; a result that is too large is
    /// an error.
    #[test]
    fn results_at_the_ends_of_the_digits() {
        let shown = |value: Option<Value>| value.map(|value| (value.to_string(), value.is_exact()));
        let some = |text: &str, exact| Some((text.to_string(), exact));
        let most = value(i64::MAX, 0);
        assert_eq!(
            shown(most.plus(Value::ZERO)),
            some("9223372036854775807", true)
        );
        assert_eq!(
            shown(most.plus(value(0, 1))),
            some("9223372036854775807", true)
        );
        assert_eq!(shown(most.plus(value(5, 1))), None);
        let half = value(-(1 << 62), 0);
        assert_eq!(shown(half.plus(half)), None);
        assert_eq!(shown(half.times(value(2, 0))), None);
        let half = value(-(1 << 62), 1);
        assert_eq!(shown(half.plus(half)), some("-922337203685477581", false));
        assert_eq!(
            shown(half.times(value(2, 0))),
            some("-922337203685477581", false)
        );
        assert_eq!(
            shown(value(1, 10).times(value(1, 10))),
            some("0.000000000000000000", false)
        );
        assert_eq!(
            shown(value(-15, 10).times(value(1, 9))),
            some("-0.000000000000000002", false)
        );
        assert_eq!(
            shown(value(15, 10).times(value(-1, 9))),
            some("-0.000000000000000002", false)
        );
        assert_eq!(
            shown(value(-15, 10).times(value(-1, 9))),
            some("0.000000000000000002", false)
        );
        assert_eq!(
            shown(value(14, 10).times(value(1, 9))),
            some("0.000000000000000001", false)
        );
        assert_eq!(
            shown(value(40_000_000_000_000, 0).divided_by(value(3, 0))),
            some("13333333333333.33333", false)
        );
        assert_eq!(value(-100, 2).stripped().to_string(), "-1");
        let third = value(1, 0).divided_by(value(3, 0).marked_rounded());
        assert_eq!(shown(third), some("0.333333333333333333", false));
    }

    /// Exact values differ by their last digit, rounded ones by more than 10^-9.
    #[test]
    fn what_counts_as_equal() {
        let (one, more) = (value(1, 0), value(1_000_000_001, 9));
        let least = value(1_000_000_000_000_000_001, 18);
        let nearly = value(1_000_000_000_999_999_999, 18);
        assert_eq!(one.compare(least), Ordering::Less);
        for (one, other) in [
            (one.marked_rounded(), false),
            (one.marked_rounded(), true),
            (one, true),
        ] {
            let mark = |value: Value| if other { value.marked_rounded() } else { value };
            assert_eq!(one.compare(mark(nearly)), Ordering::Equal);
            assert_eq!(one.compare(mark(more)), Ordering::Less);
            assert_eq!(mark(more).compare(one), Ordering::Greater);
        }
    }
}
