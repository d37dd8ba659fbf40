//! Numbers of 64 bits: registers of 64 bits, products of 128.

use fixed::FixedI64;
use fixed::types::extra::LeEqU64;

use super::{Number, Word, sealed::Sealed};

/// Bound of a term that is added to the law, 2^125. The integral and the products are within 2^125
/// as well, so the sum is below 2^127.
const TERM: i128 = 1 << 125;
/// The largest sum of magnitudes of gains, in units of their last digit.
const GAINS: u64 = 1 << 61;

impl Sealed for i64 {}
impl<Fraction: LeEqU64> Sealed for FixedI64<Fraction> {}

impl Number for i64 {
    type Word = i64;
    const FRACTION_BITS: u32 = 0;

    #[inline(always)]
    fn to_word(self) -> i64 {
        self
    }

    #[inline(always)]
    fn from_word(word: i64) -> i64 {
        word
    }
}

impl<Fraction: LeEqU64> Number for FixedI64<Fraction> {
    type Word = i64;
    const FRACTION_BITS: u32 = Fraction::U32;

    #[inline(always)]
    fn to_word(self) -> i64 {
        self.to_bits()
    }

    #[inline(always)]
    fn from_word(word: i64) -> Self {
        Self::from_bits(word)
    }
}

impl Word for i64 {
    type Wide = i128;
    type Span = [i128; 2];
    const MOST_FRACTION_BITS: u32 = 61;

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.saturating_sub(other)
    }

    fn gains<const N: usize>(gains: [Self; N]) -> Option<[Self; N]> {
        let size = gains
            .iter()
            .try_fold(0_u64, |sum, gain| sum.checked_add(gain.unsigned_abs()))?;
        (size <= GAINS).then(|| gains.map(|gain| gain.wrapping_mul(2)))
    }

    fn scaled(self, by: u32, over: u32) -> Option<Self> {
        // Below 2^96.
        let size = u128::from(self.unsigned_abs()).wrapping_mul(by.into());
        let nearest = size
            .wrapping_add(u128::from(over >> 1))
            .checked_div(over.into())?;
        let nearest = i64::try_from(nearest).ok()?;
        Some(if self < 0 {
            nearest.wrapping_neg()
        } else {
            nearest
        })
    }

    fn coefficient(digits: i32, _bits: u32) -> Self {
        digits.into()
    }

    fn half(self) -> Self {
        self >> 1
    }

    fn and(self, other: Self) -> Self {
        // At most 2^62 together.
        self.wrapping_add(other)
    }

    #[inline(always)]
    fn times(self, other: Self) -> i128 {
        // Two factors of at most 2^63.
        i128::from(self).wrapping_mul(other.into())
    }

    #[inline(always)]
    fn times_wide(self, wide: i128, bits: u32) -> i128 {
        // The high part is within the limits of a signal, the low one below 2^bits.
        let low = wide & 1_i128.wrapping_shl(bits).wrapping_sub(1);
        self.times(wide.wrapping_shr(bits) as i64)
            .wrapping_add(self.times(low as i64).wrapping_shr(bits))
    }

    #[inline(always)]
    fn plus(one: i128, other: i128) -> i128 {
        one.wrapping_add(other)
    }

    #[inline(always)]
    fn less(one: i128, other: i128) -> i128 {
        one.saturating_sub(other)
    }

    fn term(one: i128, other: i128) -> i128 {
        one.saturating_add(other).clamp(-TERM, TERM)
    }

    fn span(low: i64, high: i64, bits: u32) -> Option<[i128; 2]> {
        (low <= high).then(|| [low, high].map(|end| end.widened(bits)))
    }

    #[inline(always)]
    fn within(wide: i128, &[low, high]: &[i128; 2]) -> i128 {
        wide.min(high).max(low)
    }

    #[inline(always)]
    fn widened(self, bits: u32) -> i128 {
        // At most 62 bits: 2^125.
        i128::from(self).wrapping_shl(bits)
    }

    fn rounded(wide: i128, bits: u32) -> i64 {
        let whole = wide.saturating_add(half(bits)).wrapping_shr(bits);
        i64::try_from(whole).unwrap_or(if whole < 0 { i64::MIN } else { i64::MAX })
    }

    #[inline(always)]
    fn rounded_within(wide: i128, bits: u32) -> i64 {
        wide.wrapping_add(half(bits)).wrapping_shr(bits) as i64
    }

    fn weighted(wide: i128, weight: u16) -> i128 {
        let weight = i128::from(weight);
        // The halves have 112 and 16 bits, the weight has 16.
        let (high, low) = (wide >> 16, wide & 0xffff);
        high.wrapping_mul(weight)
            .wrapping_add(low.wrapping_mul(weight) >> 16)
    }
}

/// Returns half of 2^bits. `bits` is at most 62.
#[inline(always)]
fn half(bits: u32) -> i128 {
    1_i128.wrapping_shl(bits) >> 1
}
