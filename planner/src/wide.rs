//! Numbers wider than 64 bits, for set-up only: nothing here runs per event.

/// Fraction bits of squares of times and of their increase per event.
pub(crate) const FRACTION_BITS: u32 = 32;

/// `numerator` / `denominator`, rounded down, by long division in 32-bit digits; 0 for a divisor
/// of 0.
pub(crate) fn divide(numerator: u128, denominator: u32) -> u128 {
    let (mut quotient, mut rest) = (0_u128, 0_u64);
    for shift in [96_u32, 64, 32, 0] {
        // rest < denominator < 2^32: one more digit fits in 64 bits, and its quotient in 32.
        let digit = numerator.wrapping_shr(shift) as u32;
        let part = rest.wrapping_shl(32) | u64::from(digit);
        let whole = part.checked_div(denominator.into()).unwrap_or(0);
        rest = part.wrapping_sub(whole.wrapping_mul(denominator.into()));
        quotient = quotient.wrapping_shl(32) | u128::from(whole);
    }
    quotient
}

/// `numerator` / `denominator`, rounded down, by shift and subtract; `u64::MAX` on overflow.
pub(crate) fn quotient(numerator: u128, denominator: u128) -> u64 {
    let width = denominator.leading_zeros();
    let most = width.saturating_sub(numerator.leading_zeros());
    if denominator == 0 || most > 63 {
        return u64::MAX;
    }
    let (mut rest, mut result) = (numerator, 0_u64);
    for shift in (0..=most).rev() {
        // shift <= width, so the denominator loses no bits.
        let part = denominator.wrapping_shl(shift);
        result = result.wrapping_shl(1);
        if rest >= part {
            rest = rest.wrapping_sub(part);
            result |= 1;
        }
    }
    result
}

/// `part` / `whole` in units of 2^-32 for `part <= whole`, accurate to one unit.
pub(crate) fn share(part: u128, whole: u128) -> u64 {
    let shift = 96_u32.saturating_sub(whole.leading_zeros());
    let digits = (part.wrapping_shr(shift) as u64).wrapping_shl(32);
    digits
        .checked_div(whole.wrapping_shr(shift) as u64)
        .unwrap_or(0)
}

/// The root of the integer part of a square with [`FRACTION_BITS`], rounded down.
pub(crate) fn root(square: u128) -> u32 {
    let whole = square.wrapping_shr(FRACTION_BITS);
    // The integer part is below 2^64, see `Rates`.
    (whole as u64).isqrt() as u32
}
