//! Numbers wider than 64 bits, for set-up: nothing here runs once an event.

/// Squares of times and what one event adds to them have so many fraction bits.
pub(crate) const FRACTION_BITS: u32 = 32;

/// `numerator` / `denominator` by long division in 32-bit digits, rounded down; 0 for a divisor of
/// 0.
pub(crate) fn divide(numerator: u128, denominator: u32) -> u128 {
    let (mut quotient, mut rest) = (0_u128, 0_u64);
    for shift in [96_u32, 64, 32, 0] {
        // rest < denominator < 2^32: a digit more fits 64 bits, and its quotient 32.
        let digit = numerator.wrapping_shr(shift) as u32;
        let part = rest.wrapping_shl(32) | u64::from(digit);
        let whole = part.checked_div(denominator.into()).unwrap_or(0);
        rest = part.wrapping_sub(whole.wrapping_mul(denominator.into()));
        quotient = quotient.wrapping_shl(32) | u128::from(whole);
    }
    quotient
}

/// `numerator` / `denominator` rounded down, by shift and subtract; `u64::MAX` where that does not
/// fit.
pub(crate) fn quotient(numerator: u128, denominator: u128) -> u64 {
    let width = denominator.leading_zeros();
    let most = width.saturating_sub(numerator.leading_zeros());
    if denominator == 0 || most > 63 {
        return u64::MAX;
    }
    let (mut rest, mut result) = (numerator, 0_u64);
    for shift in (0..=most).rev() {
        // shift <= width: the denominator loses nothing.
        let part = denominator.wrapping_shl(shift);
        result = result.wrapping_shl(1);
        if rest >= part {
            rest = rest.wrapping_sub(part);
            result |= 1;
        }
    }
    result
}

/// `part` / `whole` in units of 2^-32, for `part <= whole`; right to one unit.
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
    // Squares stay below 2^64 before their fraction, see `Rates`.
    (whole as u64).isqrt() as u32
}
