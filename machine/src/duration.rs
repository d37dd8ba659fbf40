//! Lengths and the ticks they take, in 64-bit integers.

/// `a * b / c`, rounded to nearest; saturates, and is `u64::MAX` for `c = 0`.
///
/// Exact while `(a mod c) * b < 2^64`; beyond that `a mod c` and `c` lose low bits together, which costs
/// a relative error below 2^-25 (`b < 2^38` in every use: 60 times a timer's frequency at most).
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) const fn mul_div(a: u64, b: u64, c: u64) -> u64 {
    let (Some(quotient), Some(mut rest)) = (a.checked_div(c), a.checked_rem(c)) else {
        return u64::MAX;
    };
    let mut divisor = c;
    let mut product = rest.checked_mul(b);
    while product.is_none() {
        rest >>= 1;
        divisor >>= 1;
        product = rest.checked_mul(b);
    }
    let product = match product {
        Some(product) => product,
        None => 0,
    };
    let fraction = match product.saturating_add(divisor / 2).checked_div(divisor) {
        Some(fraction) => fraction,
        None => 0,
    };
    quotient.saturating_mul(b).saturating_add(fraction)
}

/// `a * b / c` times 2^16, rounded down; saturates, and is `u64::MAX` for `c = 0`.
///
/// Without a fraction where `a * b` does not fit 64 bits.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) const fn mul_div_q16(a: u64, b: u64, c: u64) -> u64 {
    let Some(product) = a.checked_mul(b) else {
        return mul_div(a, b, c).saturating_mul(1 << 16);
    };
    let (Some(quotient), Some(mut rest)) = (product.checked_div(c), product.checked_rem(c)) else {
        return u64::MAX;
    };
    // rest < c: both lose low bits together, until 16 more fit.
    let spare = rest.leading_zeros();
    let shift = 16_u32.saturating_sub(spare);
    rest >>= shift;
    let fraction = match (rest << 16).checked_div(c >> shift) {
        Some(fraction) => fraction,
        None => 0,
    };
    quotient.saturating_mul(1 << 16).saturating_add(fraction)
}

/// Euclidean length of a vector with up to 16 components, the last one apart, to the nearest nanometre or 2^-28 of it,
/// whichever is larger.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) fn length(components: &[u64], last: u64) -> u64 {
    let largest = components.iter().copied().fold(last, u64::max);
    let bits = 64 - largest.leading_zeros();
    // Every component is brought to at most 30 bits: 16 squares of 60 bits add up to 64 bits. Small ones get extra
    // bits below the point, so that the root rounds to nearest.
    let (down, up) = (bits.saturating_sub(30), 30_u32.saturating_sub(bits).min(8));
    let sum = components
        .iter()
        .chain([&last])
        .fold(0u64, |sum, component| {
            let part = component >> down << up;
            sum.saturating_add(part.saturating_mul(part))
        });
    let half = (1u64 << up) >> 1;
    let root = root(sum).saturating_add(half) >> up;
    root.checked_shl(down).unwrap_or(u64::MAX)
}

/// The square root, down.
fn root(square: u64) -> u64 {
    if cfg!(target_pointer_width = "64") {
        square.isqrt()
    } else {
        digits(square)
    }
}

/// The same, digit by digit: a sixth of the code.
fn digits(square: u64) -> u64 {
    let (mut root, mut rest, mut bit) = (0_u64, square, 1_u64 << 62);
    while bit != 0 {
        // root + bit is below 2^63.
        let trial = root.wrapping_add(bit);
        root >>= 1;
        if rest >= trial {
            rest = rest.wrapping_sub(trial);
            root = root.wrapping_add(bit);
        }
        bit >>= 2;
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_round_to_nearest() {
        assert_eq!(mul_div(7, 3, 2), 11);
        assert_eq!(mul_div(1, 1, 3), 0);
        assert_eq!(mul_div(u64::MAX, 1, 1), u64::MAX);
        assert_eq!(mul_div(1, 1, 0), u64::MAX);
        // A metre at a millimetre a minute and 32 MHz.
        assert_eq!(
            mul_div(1_000_000_000, 60 * 32_000_000, 1_000_000),
            1_920_000_000_000
        );
    }

    #[test]
    fn large_products_keep_31_bits() {
        let (a, b, c) = (1u64 << 62, (1 << 32) - 5, (1 << 63) - 25);
        let exact = (a as u128 * b as u128 / c as u128) as u64;
        assert!(mul_div(a, b, c).abs_diff(exact) <= (exact >> 31) + 1);
    }

    #[test]
    fn lengths() {
        assert_eq!(length(&[3], 4), 5);
        assert_eq!(length(&[1], 1), 1);
        assert_eq!(length(&[140, 140], 0), 198);
        assert_eq!(length(&[3 << 40], 4 << 40), 5 << 40);
        assert_eq!(length(&[], 0), 0);
    }

    #[test]
    fn both_roots_are_the_same() {
        let mut square = u64::MAX;
        while square > 0 {
            for square in [
                square,
                square.isqrt().pow(2),
                square.isqrt().pow(2).wrapping_sub(1),
            ] {
                assert_eq!(digits(square), square.isqrt(), "{square}");
            }
            square -= square.div_ceil(97);
        }
        assert_eq!(digits(0), 0);
    }
}
