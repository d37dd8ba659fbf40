//! Division of 64 bits by 32.

/// floor(`dividend` / `divisor`), 0 for a divisor of 0.
///
/// With 32-bit registers this takes two divisions of 32 bits (Knuth, The Art of Computer
/// Programming 2, algorithm D, with digits of 16 bits) instead of a library call that divides 64 by
/// 64 bits. On a Cortex-M4 that is a fifth of the instructions.
#[inline]
pub(crate) fn quotient(dividend: u64, divisor: u32) -> u64 {
    if cfg!(target_pointer_width = "64") {
        dividend.checked_div(divisor.into()).unwrap_or(0)
    } else {
        by_digits(dividend, divisor)
    }
}

fn by_digits(dividend: u64, divisor: u32) -> u64 {
    let mut high = (dividend >> 32) as u32;
    let mut whole = 0;
    if high >= divisor {
        whole = high.checked_div(divisor).unwrap_or(0);
        high = high.wrapping_sub(whole.wrapping_mul(divisor));
    }
    // high < divisor from here on, so the quotient has 32 bits. The divisor is scaled to 32 bits,
    // and the dividend by the same shift.
    let zeros = divisor.leading_zeros();
    let divisor = divisor.wrapping_shl(zeros);
    let rest = (u64::from(high) << 32 | dividend & 0xffff_ffff).wrapping_shl(zeros);
    let low = rest as u32;
    let (first, rest) = digit((rest >> 32) as u32, low >> 16, divisor);
    let (second, _) = digit(rest, low & 0xffff, divisor);
    u64::from(whole) << 32 | u64::from(first << 16 | second)
}

/// Returns one digit of 16 bits of (`high` 2^16 + `next`) / `divisor`, and the remainder. `divisor`
/// has its highest bit set and is above `high`.
fn digit(high: u32, next: u32, divisor: u32) -> (u32, u32) {
    let [upper, lower] = [divisor >> 16, divisor & 0xffff];
    // Too large by at most 2.
    let mut guess = high.checked_div(upper).unwrap_or(0).min(0xffff);
    let rest = u64::from(high) << 16 | u64::from(next);
    let rest = rest.wrapping_sub(u64::from(guess.wrapping_mul(upper)) << 16) as i64;
    // guess lower < 2^32
    let mut rest = rest.wrapping_sub(guess.wrapping_mul(lower).into());
    while rest < 0 {
        guess = guess.wrapping_sub(1);
        rest = rest.wrapping_add(divisor.into());
    }
    (guess, rest as u32)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::by_digits;

    /// Random numbers of all sizes, and all numbers near powers of two.
    #[test]
    fn digits_divide_exactly() {
        let mut random = oorandom::Rand64::new(1);
        let mut next = || random.rand_u64();
        for _ in 0..1_000_000 {
            let dividend = next() >> (next() % 64);
            let divisor = (next() >> (32 + next() % 32)) as u32;
            assert_eq!(
                Some(by_digits(dividend, divisor.max(1))),
                dividend.checked_div(divisor.max(1).into())
            );
        }
        let near = |bits: u32| (-2..=2).map(move |off| (1_i128 << bits) + off);
        for dividend in (0..65)
            .flat_map(near)
            .filter_map(|number| u64::try_from(number).ok())
        {
            for divisor in (0..33)
                .flat_map(near)
                .filter_map(|number| u32::try_from(number).ok())
            {
                if let Some(exact) = dividend.checked_div(divisor.into()) {
                    assert_eq!(
                        by_digits(dividend, divisor),
                        exact,
                        "{dividend} / {divisor}"
                    );
                }
            }
        }
    }
}
