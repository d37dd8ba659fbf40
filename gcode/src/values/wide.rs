//! Products, roots and quotients of 128 bits.
//!
//! 64-bit processors divide, and use the library. On smaller ones that would link in wide
//! divisions, so roots and quotients are computed digit by digit. Each function is called, not
//! inlined, because its code is longer than the call.

/// The full product. A call is shorter than the code, which takes ten multiplications of 32 bits.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) const fn product(a: u64, b: u64) -> u128 {
    (a as u128).wrapping_mul(b as u128)
}

/// `x^2 + y^2` for components below 2^53.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) fn square(x: i64, y: i64) -> u128 {
    let (x, y) = (x.unsigned_abs(), y.unsigned_abs());
    product(x, x).wrapping_add(product(y, y))
}

/// The largest integer whose square is at most `value`, which is below 2^124.
#[inline]
pub(crate) fn root(value: u128) -> u64 {
    root_to(value, WHOLE_DIGITS).0
}

/// Binary digits of the whole part of a root of 128 bits.
pub(crate) const WHOLE_DIGITS: u32 = 64;

/// The root of a value below 2^124, rounded down, and the number of its binary digits. It has at
/// most `digits` of them, [`WHOLE_DIGITS`] of which are before the point, and none after the 62nd
/// significant one.
#[inline]
pub(crate) fn root_to(value: u128, digits: u32) -> (u64, u32) {
    if cfg!(target_pointer_width = "64") {
        root_by_library(value, digits)
    } else {
        root_by_digits(value, digits)
    }
}

fn root_by_library(value: u128, digits: u32) -> (u64, u32) {
    // At most 128, because there are at most 64 pairs of zeros. The first significant digit ends up
    // at 2^61.
    let zeros = value.leading_zeros() >> 1;
    let digits = digits.min(zeros.wrapping_add(62));
    let shifted = match digits.checked_sub(WHOLE_DIGITS) {
        Some(more) => value.wrapping_shl(more.wrapping_mul(2)),
        None => value.wrapping_shr(WHOLE_DIGITS.wrapping_sub(digits).wrapping_mul(2)),
    };
    // Most are short, and the root of a short value needs no division of 128 bits.
    let root = match u64::try_from(shifted) {
        Ok(short) => short.isqrt(),
        Err(_) => shifted.isqrt() as u64,
    };
    (root, digits)
}

/// One digit of the root from two bits of the value; only the value is wider than 64 bits.
#[inline(never)]
fn root_by_digits(value: u128, digits: u32) -> (u64, u32) {
    let (mut high, mut low) = ((value >> 64) as u64, value as u64);
    let (mut rest, mut root, mut done) = (0u64, 0u64, 0);
    if high == 0 {
        (high, low, done) = (low, 0, 32);
    }
    while done < digits && root >> 61 == 0 {
        // rest <= 2 root < 2^62.
        rest = (rest << 2) | (high >> 62);
        high = (high << 2) | (low >> 62);
        low <<= 2;
        let trial = (root << 2) | 1;
        root <<= 1;
        if rest >= trial {
            rest = rest.wrapping_sub(trial);
            root |= 1;
        }
        done = u32::wrapping_add(done, 1);
    }
    (root, done)
}

/// `value / divisor` rounded down; the divisor is below 2^63. 0 for a divisor of 0.
#[inline]
pub(crate) const fn divide(value: u128, divisor: u64) -> u128 {
    if cfg!(target_pointer_width = "64") {
        match value.checked_div(divisor as u128) {
            Some(quotient) => quotient,
            None => 0,
        }
    } else {
        let high = (value >> 64) as u64;
        let above = quotient_by_digits(0, high, divisor, WHOLE_DIGITS);
        let rest = high.wrapping_sub(above.wrapping_mul(divisor));
        let below = quotient_by_digits(rest, value as u64, divisor, WHOLE_DIGITS);
        (above as u128) << 64 | below as u128
    }
}

/// `digits` binary digits of a quotient, 64 of them before the point. `rest` is below the divisor,
/// which is below 2^63.
#[inline(never)]
const fn quotient_by_digits(mut rest: u64, mut low: u64, divisor: u64, mut digits: u32) -> u64 {
    let mut quotient = 0;
    if divisor == 0 {
        return 0;
    }
    while digits > 0 {
        // rest < divisor < 2^63.
        rest = (rest << 1) | (low >> 63);
        low <<= 1;
        quotient <<= 1;
        if rest >= divisor {
            rest = rest.wrapping_sub(divisor);
            quotient |= 1;
        }
        digits = digits.wrapping_sub(1);
    }
    quotient
}

/// Rounds `value / 2^bits` to the nearest, halves away from zero; `bits` in 1..=100, |value| <
/// 2^126.
#[cfg(feature = "extended")]
pub(crate) fn shift_rounded(value: i128, bits: u32) -> i128 {
    let magnitude = value
        .unsigned_abs()
        .wrapping_add(1u128.wrapping_shl(bits.wrapping_sub(1)))
        .wrapping_shr(bits) as i128;
    if value < 0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}

/// The root of a ratio: the roots of both numbers with 62 binary digits, so it is accurate to 2^-60
/// of its value.
#[derive(Copy, Clone)]
pub(crate) struct Ratio {
    above: u64,
    below: u64,
    /// Number of digits of the quotient for a resolution of 2^-6.
    digits: u32,
}

impl Ratio {
    /// To be filled.
    pub(crate) const NONE: Ratio = Ratio {
        above: 0,
        below: 0,
        digits: 0,
    };

    /// Of two squares below 2^124; the denominator is not 0.
    #[inline]
    pub(crate) fn of_roots(numerator: u128, denominator: u128) -> Ratio {
        let (above, up) = root_to(numerator, LONG);
        let (below, down) = root_to(denominator, LONG);
        Ratio {
            above,
            below,
            // Both are at most 128; a longer root above is smaller by the same factor than it
            // seems.
            digits: (WHOLE_DIGITS + 6).wrapping_add(down).saturating_sub(up),
        }
    }

    /// A factor below 2^53 times the ratio, in 2^-6, truncated; the result is below 2^58.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(crate) fn of(&self, factor: i64) -> i64 {
        // Below 2^115, so its upper half is below the divisor of 62 bits.
        let product = product(factor.unsigned_abs(), self.above);
        let magnitude = if cfg!(target_pointer_width = "64") {
            let shifted = match self.digits.checked_sub(WHOLE_DIGITS) {
                // The quotient is below 2^58 and the divisor below 2^62, so the product is below
                // 2^120.
                Some(up) => product.wrapping_shl(up),
                None => product.wrapping_shr(WHOLE_DIGITS.wrapping_sub(self.digits)),
            };
            divide(shifted, self.below) as u64
        } else {
            quotient_by_digits(
                (product >> 64) as u64,
                product as u64,
                self.below,
                self.digits,
            )
        } as i64;
        if factor < 0 {
            magnitude.wrapping_neg()
        } else {
            magnitude
        }
    }
}

/// More digits than a root of 62 significant digits has.
const LONG: u32 = 128;

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of every length: a power of two, its neighbours, and alternating bits.
    fn numbers(bits: u32) -> impl Iterator<Item = u128> {
        (0..bits).flat_map(|bit| {
            let power = 1u128 << bit;
            [
                power - 1,
                power,
                power + 1,
                (u128::MAX / 3) >> (127 - bit),
                power | 12345,
            ]
        })
    }

    // Two hundred thousand quotients digit by digit would take hours in an interpreter.
    #[cfg_attr(miri, ignore)]
    #[test]
    fn digits_give_what_the_library_gives() {
        let most = [(1u128 << 124) - 1, 1 << 123];
        for value in numbers(123).chain(most) {
            for digits in [WHOLE_DIGITS, WHOLE_DIGITS + 9, LONG] {
                let (root, done) = root_by_digits(value, digits);
                if value > 0 {
                    let library = root_by_library(value, digits);
                    assert_eq!((root, done), library, "{value} {digits}");
                } else {
                    assert_eq!(root, 0);
                }
            }
            assert_eq!(root(value), value.isqrt() as u64, "{value}");
        }
        for value in numbers(127).chain([u128::MAX]) {
            for divisor in numbers(62).map(|divisor| divisor as u64) {
                let exact = value.checked_div(divisor.into()).unwrap_or(0);
                if value >> 64 < u128::from(divisor) {
                    let (high, low) = ((value >> 64) as u64, value as u64);
                    let digits = quotient_by_digits(high, low, divisor, WHOLE_DIGITS);
                    assert_eq!(u128::from(digits), exact, "{value} / {divisor}");
                }
                assert_eq!(divide(value, divisor), exact, "{value} / {divisor}");
            }
        }
        // With more digits than 64, and with fewer: in 2^-3, and without the last two.
        assert_eq!(quotient_by_digits(0, 100, 7, WHOLE_DIGITS + 3), 114);
        assert_eq!(quotient_by_digits(0, 100, 7, WHOLE_DIGITS - 2), 3);
    }
}
