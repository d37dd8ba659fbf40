//! Products, roots and quotients of 128 bits.
//!
//! Processors of 64 bits divide, and take the library's. On smaller ones that would link in wide divisions: there roots and
//! quotients come digit by digit, and each function is called, not inlined, as its code is longer than the call.

/// The whole product. A call costs less than the code of one, where it takes ten multiplications of 32 bits.
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
    if cfg!(target_pointer_width = "64") {
        value.isqrt() as u64
    } else {
        root_by_digits(value)
    }
}

/// A digit of the root from two bits of the value, with nothing wider than 64 bits but the value.
#[inline(never)]
fn root_by_digits(value: u128) -> u64 {
    let skipped = value.leading_zeros() & !1;
    let mut coming = value.wrapping_shl(skipped);
    let (mut rest, mut root) = (0u64, 0u64);
    for _ in 0..128u32.wrapping_sub(skipped) >> 1 {
        // rest <= 2 root < 2^62 before the last of at most 62 digits.
        rest = (rest << 2) | (coming >> 126) as u64;
        coming <<= 2;
        let trial = (root << 2) | 1;
        root <<= 1;
        if rest >= trial {
            rest = rest.wrapping_sub(trial);
            root |= 1;
        }
    }
    root
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
        divide_by_digits(value, divisor)
    }
}

/// A binary digit of the quotient at a time, with a rest of 64 bits.
#[inline(never)]
const fn divide_by_digits(value: u128, divisor: u64) -> u128 {
    if divisor == 0 || value == 0 {
        return 0;
    }
    let skipped = value.leading_zeros();
    // From the left the digits still to come, from the right those of the quotient.
    let mut turning = value.wrapping_shl(skipped);
    let mut rest = 0u64;
    let mut digit = skipped;
    while digit < 128 {
        // rest < divisor < 2^63.
        rest = (rest << 1) | (turning >> 127) as u64;
        turning <<= 1;
        if rest >= divisor {
            rest = rest.wrapping_sub(divisor);
            turning |= 1;
        }
        digit = digit.wrapping_add(1);
    }
    turning
}

/// Rounds `value / 2^bits` to the nearest, halves away from zero; `bits` in 1..=100, |value| < 2^126.
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

/// The root of a ratio, as two integers and a power of two: `above / below * 2^exponent`.
///
/// Both roots are taken of numbers shifted up to 123 or 124 bits, so they have 62 bits and the ratio is good to 2^-60 of
/// itself.
#[derive(Copy, Clone)]
pub(crate) struct Ratio {
    above: u64,
    below: u64,
    exponent: i32,
}

/// A root of 62 bits, and by how many bits it is too long.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn long_root(value: u128) -> (u64, u32) {
    let up = value.leading_zeros().saturating_sub(4) & !1;
    (root(value.wrapping_shl(up)), up >> 1)
}

impl Ratio {
    /// Of two squares below 2^124.
    pub(crate) fn of_roots(numerator: u128, denominator: u128) -> Ratio {
        let ((above, up), (below, down)) = (long_root(numerator), long_root(denominator));
        Ratio {
            above,
            below,
            // Both at most 62.
            exponent: (down as i32).wrapping_sub(up as i32),
        }
    }

    /// A factor below 2^53 times the ratio, in 2^-6, truncated; the result is below 2^58.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(crate) fn of(self, factor: i64) -> i64 {
        let product = product(factor.unsigned_abs(), self.above);
        // The quotient is below 2^58 and the divisor below 2^62: so is the product below 2^120, shifted or not.
        let shift = self.exponent.wrapping_add(6);
        let shifted = if shift < 0 {
            product.wrapping_shr(shift.unsigned_abs())
        } else {
            product.wrapping_shl(shift.unsigned_abs())
        };
        let magnitude = divide(shifted, self.below) as i64;
        if factor < 0 {
            magnitude.wrapping_neg()
        } else {
            magnitude
        }
    }
}

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

    #[test]
    fn digits_give_what_the_library_gives() {
        for value in numbers(123) {
            assert_eq!(root_by_digits(value), value.isqrt() as u64, "{value}");
            assert_eq!(root(value), value.isqrt() as u64, "{value}");
        }
        assert_eq!(root_by_digits((1 << 124) - 1), (1 << 62) - 1);
        for value in numbers(127).chain([u128::MAX]) {
            for divisor in numbers(62).map(|divisor| divisor as u64) {
                let exact = value.checked_div(divisor.into()).unwrap_or(0);
                assert_eq!(
                    divide_by_digits(value, divisor),
                    exact,
                    "{value} / {divisor}"
                );
                assert_eq!(divide(value, divisor), exact, "{value} / {divisor}");
            }
        }
    }
}
