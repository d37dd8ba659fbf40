//! Number types of signals and gains.

mod integer;
mod long;

use core::fmt::Debug;

use fixed::types::extra::{LeEqU8, LeEqU16, LeEqU32};
use fixed::{FixedI8, FixedI16, FixedI32};

/// A type of signals or gains: the signed integers and fixed-point types of up to 64 bits, and
/// `f32`. Signals and gains of one controller are all of 64 bits, all of up to 32, or all `f32`.
///
/// The controller computes with a fixed-point number as an integer in units of its last digit, so
/// sums are exact. `f32` rounds at every operation.
pub trait Number: Copy + Debug + Default + PartialEq + sealed::Sealed {
    /// The register type of the computation.
    type Word: Word;
    /// Number of fractional bits.
    const FRACTION_BITS: u32;
    /// Converts the number to its register, in units of its last digit.
    fn to_word(self) -> Self::Word;
    /// Converts a register to the number, saturating.
    fn from_word(word: Self::Word) -> Self;
}

/// A register type and the double-width type of its products. Implemented for `i32`, `i64` and
/// `f32`, for internal use.
pub trait Word: Copy + Debug + Default + PartialEq + PartialOrd + sealed::Sealed {
    /// Type of products and their sums.
    type Wide: Copy + Debug + Default + PartialEq + PartialOrd;
    /// Range from a lowest to a highest wide number.
    type Span: Copy + Debug + PartialEq;
    /// Most fractional bits of gains, so that a limit times a gain's fraction fits.
    const MOST_FRACTION_BITS: u32;
    /// Returns the difference, saturating. For `f32` a difference that is not finite becomes 0, so
    /// that a broken sensor causes no drive.
    fn minus(self, other: Self) -> Self;
    /// Converts gains to the stored form. Integers are doubled, so that half of a gain is exact;
    /// `f32` stays as it is. Returns `None` if the magnitudes of the integers add up to more than
    /// 2^29, or if an `f32` is not finite.
    fn gains<const N: usize>(gains: [Self; N]) -> Option<[Self; N]>;
    /// Returns the number times `by` / `over`, rounded to nearest. Returns `None` if it does not
    /// fit or `over` is 0.
    fn scaled(self, by: u32, over: u32) -> Option<Self>;
    /// Returns the coefficient of a filter that has this many digits of 2^-bits.
    fn coefficient(digits: i32, bits: u32) -> Self;
    /// Returns half of a stored gain.
    fn half(self) -> Self;
    /// Returns the sum of two stored gains.
    fn and(self, other: Self) -> Self;
    /// Returns the product: exact, for `f32` rounded.
    fn times(self, other: Self) -> Self::Wide;
    /// Returns the product of a coefficient and a wide number of `bits` fractional bits that is
    /// within the range of a signal, rounded downwards to these bits.
    fn times_wide(self, wide: Self::Wide, bits: u32) -> Self::Wide;
    /// Returns the sum. The bounds stated in [`Pid`](crate::Pid) keep it in range.
    fn plus(one: Self::Wide, other: Self::Wide) -> Self::Wide;
    /// Returns the difference, saturating.
    fn less(one: Self::Wide, other: Self::Wide) -> Self::Wide;
    /// Returns the sum, limited to the range of a [`Term`](crate::Term).
    fn term(one: Self::Wide, other: Self::Wide) -> Self::Wide;
    /// Returns the range from `low` to `high`, times 2^bits. Returns `None` if `low` is above
    /// `high` or one is not a number.
    fn span(low: Self, high: Self, bits: u32) -> Option<Self::Span>;
    /// Limits the number to the range. A number within the range is the faster case.
    fn within(wide: Self::Wide, span: &Self::Span) -> Self::Wide;
    /// Returns the word times 2^bits.
    fn widened(self, bits: u32) -> Self::Wide;
    /// Returns the wide number divided by 2^bits, rounded to the nearest integer, ties upwards,
    /// saturating.
    fn rounded(wide: Self::Wide, bits: u32) -> Self;
    /// Same as [`rounded`](Self::rounded) for a result that is known to fit: no range test.
    fn rounded_within(wide: Self::Wide, bits: u32) -> Self;
    /// Returns `wide` x `weight` / 65536, rounded downwards.
    fn weighted(wide: Self::Wide, weight: u16) -> Self::Wide;
}

/// Marks the branch that calls it as unlikely for the compiler.
#[cold]
#[inline]
fn seldom() {}

/// Bound of a term that is added to the law, 2^61. The integral and the products are within 2^61 as
/// well, so the sum is below 2^63.
const TERM: i64 = 1 << 61;
/// The largest sum of magnitudes of gains, in units of their last digit.
const GAINS: u32 = 1 << 29;

impl Word for i32 {
    type Wide = i64;
    type Span = Span;
    const MOST_FRACTION_BITS: u32 = 29;

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.saturating_sub(other)
    }

    fn gains<const N: usize>(gains: [Self; N]) -> Option<[Self; N]> {
        let size = gains
            .iter()
            .try_fold(0_u32, |sum, gain| sum.checked_add(gain.unsigned_abs()))?;
        (size <= GAINS).then(|| gains.map(|gain| gain.wrapping_mul(2)))
    }

    fn scaled(self, by: u32, over: u32) -> Option<Self> {
        // Below 2^64 with the half.
        let size = u64::from(self.unsigned_abs()).wrapping_mul(by.into());
        let nearest = size
            .wrapping_add(u64::from(over >> 1))
            .checked_div(over.into())?;
        let nearest = i32::try_from(nearest).ok()?;
        Some(if self < 0 {
            nearest.wrapping_neg()
        } else {
            nearest
        })
    }

    fn coefficient(digits: i32, _bits: u32) -> Self {
        digits
    }

    fn half(self) -> Self {
        self >> 1
    }

    fn and(self, other: Self) -> Self {
        // At most 2^30 together.
        self.wrapping_add(other)
    }

    #[inline(always)]
    fn times(self, other: Self) -> i64 {
        product(self, other)
    }

    #[inline(always)]
    fn times_wide(self, wide: i64, bits: u32) -> i64 {
        // The high part is within the limits of a signal, the low one below 2^bits.
        let low = wide & 1_i64.wrapping_shl(bits).wrapping_sub(1);
        product(self, wide.wrapping_shr(bits) as i32)
            .wrapping_add(product(self, low as i32).wrapping_shr(bits))
    }

    #[inline(always)]
    fn plus(one: i64, other: i64) -> i64 {
        one.wrapping_add(other)
    }

    #[inline(always)]
    fn less(one: i64, other: i64) -> i64 {
        one.saturating_sub(other)
    }

    fn term(one: i64, other: i64) -> i64 {
        one.saturating_add(other).clamp(-TERM, TERM)
    }

    fn span(low: i32, high: i32, bits: u32) -> Option<Span> {
        (low <= high).then(|| Span {
            low: low.widened(bits),
            width: high.widened(bits).abs_diff(low.widened(bits)),
        })
    }

    #[inline(always)]
    fn within(wide: i64, span: &Span) -> i64 {
        // One comparison tests both ends: a number below `low` wraps to more than any width.
        let above = wide.wrapping_sub(span.low) as u64;
        if above <= span.width {
            wide
        } else {
            seldom();
            let low_end = wide < span.low;
            span.low
                .wrapping_add_unsigned(if low_end { 0 } else { span.width })
        }
    }

    #[inline(always)]
    fn widened(self, bits: u32) -> i64 {
        // At most 30 bits: 2^61.
        i64::from(self).wrapping_shl(bits)
    }

    fn rounded(wide: i64, bits: u32) -> i32 {
        let whole = wide.saturating_add(half(bits)).wrapping_shr(bits);
        i32::try_from(whole).unwrap_or(if whole < 0 { i32::MIN } else { i32::MAX })
    }

    #[inline(always)]
    fn rounded_within(wide: i64, bits: u32) -> i32 {
        wide.wrapping_add(half(bits)).wrapping_shr(bits) as i32
    }

    fn weighted(wide: i64, weight: u16) -> i64 {
        let weight = i64::from(weight);
        // The halves have 48 and 16 bits, the weight has 16.
        let (high, low) = (wide >> 16, wide & 0xffff);
        high.wrapping_mul(weight)
            .wrapping_add(low.wrapping_mul(weight) >> 16)
    }
}

/// Range from `low` to `low + width`. Both ends are within 2^61.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Span {
    low: i64,
    width: u64,
}

/// Returns the exact product.
#[inline(always)]
fn product(one: i32, other: i32) -> i64 {
    // ARMv6-M, the only supported target without these atomics, multiplies 32 bits to 32. The
    // 64-bit product of the library takes twice as long there.
    if cfg!(all(target_arch = "arm", not(target_has_atomic = "32"))) {
        product_of_halves(one, other)
    } else {
        // Two factors of at most 2^31.
        i64::from(one).wrapping_mul(i64::from(other))
    }
}

/// Computes the exact product from products of 16 bits. Source: Warren, *Hacker's Delight*, 2nd
/// ed., 8-2, `mulhs`.
#[inline(always)]
fn product_of_halves(one: i32, other: i32) -> i64 {
    let [(low_a, high_a), (low_b, high_b)] = [one, other].map(|word| (word & 0xffff, word >> 16));
    // Unsigned halves are below 2^16, signed ones within 2^15. Mixed products are within 2^31 -
    // 2^15, so adding 2^16 - 1 cannot overflow.
    let low = low_a.wrapping_mul(low_b) as u32 >> 16;
    let middle = high_a.wrapping_mul(low_b).wrapping_add(low as i32);
    let other_middle = low_a.wrapping_mul(high_b).wrapping_add(middle & 0xffff);
    let high = high_a
        .wrapping_mul(high_b)
        .wrapping_add(middle >> 16)
        .wrapping_add(other_middle >> 16);
    i64::from(high) << 32 | i64::from(one.wrapping_mul(other) as u32)
}

/// Returns half of 2^bits. `bits` is 1 to 30.
#[inline(always)]
fn half(bits: u32) -> i64 {
    1_i64.wrapping_shl(bits) >> 1
}

impl Word for f32 {
    type Wide = f32;
    type Span = [f32; 2];
    const MOST_FRACTION_BITS: u32 = 0;

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        let difference = self - other;
        if difference.is_finite() {
            difference
        } else {
            0.0
        }
    }

    fn gains<const N: usize>(gains: [Self; N]) -> Option<[Self; N]> {
        gains.iter().all(|gain| gain.is_finite()).then_some(gains)
    }

    fn scaled(self, by: u32, over: u32) -> Option<Self> {
        Some(self * (by as f32 / over as f32)).filter(|product| product.is_finite())
    }

    fn coefficient(digits: i32, bits: u32) -> Self {
        // 2^-bits, for bits below 127.
        let digit = f32::from_bits(127_u32.wrapping_sub(bits).wrapping_shl(23));
        digits as f32 * digit
    }

    fn half(self) -> Self {
        self * 0.5
    }

    fn and(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn times(self, other: Self) -> f32 {
        self * other
    }

    #[inline(always)]
    fn times_wide(self, wide: f32, _bits: u32) -> f32 {
        self * wide
    }

    #[inline(always)]
    fn plus(one: f32, other: f32) -> f32 {
        one + other
    }

    #[inline(always)]
    fn less(one: f32, other: f32) -> f32 {
        one - other
    }

    fn term(one: f32, other: f32) -> f32 {
        one + other
    }

    fn span(low: f32, high: f32, _bits: u32) -> Option<[f32; 2]> {
        (low <= high).then_some([low, high])
    }

    #[inline(always)]
    fn within(wide: f32, &[low, high]: &[f32; 2]) -> f32 {
        // `clamp` is not used because it can panic.
        if wide < low {
            low
        } else if wide > high {
            high
        } else {
            wide
        }
    }

    #[inline(always)]
    fn widened(self, _bits: u32) -> f32 {
        self
    }

    fn rounded(wide: f32, _bits: u32) -> f32 {
        wide
    }

    #[inline(always)]
    fn rounded_within(wide: f32, _bits: u32) -> f32 {
        wide
    }

    fn weighted(wide: f32, weight: u16) -> f32 {
        wide * (f32::from(weight) / 65536.0)
    }
}

impl Number for f32 {
    type Word = f32;
    const FRACTION_BITS: u32 = 0;

    #[inline(always)]
    fn to_word(self) -> f32 {
        self
    }

    #[inline(always)]
    fn from_word(word: f32) -> f32 {
        word
    }
}

impl<Fraction: LeEqU32> Number for FixedI32<Fraction> {
    type Word = i32;
    const FRACTION_BITS: u32 = Fraction::U32;

    #[inline(always)]
    fn to_word(self) -> i32 {
        self.to_bits()
    }

    #[inline(always)]
    fn from_word(word: i32) -> Self {
        Self::from_bits(word)
    }
}

impl<Fraction: LeEqU16> Number for FixedI16<Fraction> {
    type Word = i32;
    const FRACTION_BITS: u32 = Fraction::U32;

    #[inline(always)]
    fn to_word(self) -> i32 {
        i32::from(self.to_bits())
    }

    #[inline(always)]
    fn from_word(word: i32) -> Self {
        Self::from_bits(word.clamp(i16::MIN.into(), i16::MAX.into()) as i16)
    }
}

impl<Fraction: LeEqU8> Number for FixedI8<Fraction> {
    type Word = i32;
    const FRACTION_BITS: u32 = Fraction::U32;

    #[inline(always)]
    fn to_word(self) -> i32 {
        i32::from(self.to_bits())
    }

    #[inline(always)]
    fn from_word(word: i32) -> Self {
        Self::from_bits(word.clamp(i8::MIN.into(), i8::MAX.into()) as i8)
    }
}

mod sealed {
    use super::{FixedI8, FixedI16, FixedI32, LeEqU8, LeEqU16, LeEqU32};

    pub trait Sealed {}

    impl Sealed for f32 {}
    impl Sealed for i32 {}
    impl<Fraction: LeEqU32> Sealed for FixedI32<Fraction> {}
    impl<Fraction: LeEqU16> Sealed for FixedI16<Fraction> {}
    impl<Fraction: LeEqU8> Sealed for FixedI8<Fraction> {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_make_the_product() {
        let words = [
            0,
            1,
            -1,
            0x7fff,
            0x8000,
            0xffff,
            0x1_0000,
            -0x8000,
            -0x1_0000,
            123_456_789,
            i32::MAX,
            i32::MIN,
        ];
        for one in words {
            for other in words {
                assert_eq!(
                    product_of_halves(one, other),
                    i64::from(one) * i64::from(other)
                );
            }
        }
    }

    #[test]
    fn spans_hold_at_both_ends() {
        let span = i32::span(i32::MIN, i32::MAX, 30).unwrap();
        let ends = [i32::MIN, i32::MAX].map(|end| end.widened(30));
        for (wide, held) in [
            (-3 * TERM, ends[0]),
            (3 * TERM - 1, ends[1]),
            (0, 0),
            (ends[0], ends[0]),
            (ends[1], ends[1]),
        ] {
            assert_eq!(i32::within(wide, &span), held);
        }
        assert_eq!(i32::span(1, 0, 8), None);
    }
}
