//! Conversion of lengths to ticks in 64-bit integers.

/// Returns `a * b / c`, rounded to nearest. Saturates, and is `u64::MAX` for `c = 0`.
///
/// Exact while `(a mod c) * b < 2^64`. Beyond that `a mod c` and `c` lose low bits together, with a
/// relative error below 2^-25 (`b < 2^38` in every use: at most 60 times the frequency of a timer).
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
#[cfg_attr(target_pointer_width = "64", inline)]
pub const fn mul_div(a: u64, b: u64, c: u64) -> u64 {
    let (Some(quotient), Some(mut rest)) = (a.checked_div(c), a.checked_rem(c)) else {
        return u64::MAX;
    };
    let mut divisor = c;
    let mut product = times(rest, b);
    while product.is_none() {
        rest >>= 1;
        divisor >>= 1;
        product = times(rest, b);
    }
    let product = match product {
        Some(product) => product,
        None => 0,
    };
    let fraction = match product.saturating_add(divisor / 2).checked_div(divisor) {
        Some(fraction) => fraction,
        None => 0,
    };
    match times(quotient, b) {
        Some(whole) => whole.saturating_add(fraction),
        None => u64::MAX,
    }
}

/// Returns `a * b / c` times 2^16, rounded down. Saturates, and is `u64::MAX` for `c = 0`.
///
/// There is no fraction where `a * b` does not fit in 64 bits.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
#[cfg_attr(target_pointer_width = "64", inline)]
pub const fn mul_div_q16(a: u64, b: u64, c: u64) -> u64 {
    let Some(product) = times(a, b) else {
        return mul_div(a, b, c).saturating_mul(1 << 16);
    };
    let (Some(quotient), Some(mut rest)) = (product.checked_div(c), product.checked_rem(c)) else {
        return u64::MAX;
    };
    // rest < c: both lose low bits together until 16 more bits fit.
    let spare = rest.leading_zeros();
    let shift = 16_u32.saturating_sub(spare);
    rest >>= shift;
    let fraction = match (rest << 16).checked_div(c >> shift) {
        Some(fraction) => fraction,
        None => 0,
    };
    quotient.saturating_mul(1 << 16).saturating_add(fraction)
}

/// Multiplies as [`u64::checked_mul`], as one function: that takes 100 bytes of code on a
/// Cortex-M0.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
#[cfg_attr(target_pointer_width = "64", inline)]
pub const fn times(a: u64, b: u64) -> Option<u64> {
    a.checked_mul(b)
}

/// Returns the share `part / total` of `whole`, accurate to 2^-31 of it. `part` is at most `total`.
#[inline]
pub const fn share(whole: u64, part: u64, total: u64) -> u64 {
    // Both are scaled to 32 bits, so the product of a remainder and the part fits in 64.
    let shift = 32_u32.saturating_sub(total.leading_zeros());
    let total = total.wrapping_shr(shift);
    let total = if total == 0 { 1 } else { total };
    mul_div(whole, part.wrapping_shr(shift), total)
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
        // One metre at 1 mm/min with a timer of 32 MHz.
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
}
