//! A quantity per unit of sweep.

use crate::timer::{bits, scaled_quotient};

/// A quantity per unit of sweep, with as many fraction bits as keep its products within 62 bits.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Rate {
    mantissa: u64,
    /// From 1 to 63, except for the default.
    fraction_bits: u8,
}

impl Rate {
    /// `length` 2^-`length_bits` `factor`, rounded down, for sweeps of at most `largest_sweep`. A
    /// value too large for products of 62 bits with at least one fraction bit is limited.
    pub(crate) fn new(length: u64, factor: u64, length_bits: u8, largest_sweep: u32) -> Rate {
        // Both factors have 64 bits.
        let product = u128::from(length).wrapping_mul(factor.into());
        let product_bits = 128_u32.wrapping_sub(product.leading_zeros());
        let room = 62_u32.saturating_sub(bits(largest_sweep.into())).max(1);
        let excess = product_bits.saturating_sub(room);
        // Limited to 63 bits, and to what the length has.
        let length_bits = u32::from(length_bits);
        let excess = excess.max(length_bits.saturating_sub(63));
        let Some(fraction_bits @ 1..) = length_bits.checked_sub(excess) else {
            return Rate {
                mantissa: 1_u64.wrapping_shl(room).wrapping_sub(1),
                fraction_bits: 1,
            };
        };
        Rate {
            // At most `room` bits are left; there are at most 63 fraction bits.
            mantissa: product.wrapping_shr(excess) as u64,
            fraction_bits: fraction_bits as u8,
        }
    }

    /// The next larger value. Products are then at most 2^62 plus a sweep.
    pub(crate) fn up(self) -> Rate {
        Rate {
            mantissa: self.mantissa.wrapping_add(1),
            ..self
        }
    }

    /// The product with this sweep, times 2^`fraction_bits`; at most 2^62.
    #[inline]
    pub(crate) fn times(&self, sweep: u32) -> u64 {
        self.mantissa.wrapping_mul(sweep.into())
    }

    /// The whole part and the fraction of a product.
    #[inline]
    pub(crate) fn split(&self, product: u64) -> (u64, u64) {
        let bits = u32::from(self.fraction_bits);
        let whole = product.wrapping_shr(bits);
        (whole, product.wrapping_sub(whole.wrapping_shl(bits)))
    }

    /// The product with any sweep, times 2^`fraction_bits`.
    pub(crate) fn times_long(&self, sweep: u64) -> u128 {
        u128::from(self.mantissa).wrapping_mul(sweep.into())
    }

    /// The whole part and the fraction of a long product.
    pub(crate) fn split_long(&self, product: u128) -> (u128, u64) {
        let bits = u32::from(self.fraction_bits);
        let whole = product.wrapping_shr(bits);
        // The fraction is below 2^63.
        let fraction = product.wrapping_sub(whole.wrapping_shl(bits));
        (whole, fraction as u64)
    }

    pub(crate) const fn fraction_bits(&self) -> u8 {
        self.fraction_bits
    }
}

/// Length per unit of sweep with 62 or 63 significant bits, and the number of its fraction bits.
///
/// `length` is below 2^45, `total_sweep` is not 0.
pub(crate) fn unit(length: u64, total_sweep: u64) -> (u64, u8) {
    // The quotient is below 2^(bits(length) - bits(total) + 1), so it has 63 bits with these
    // fraction bits. The result is 18 to 126.
    let fraction_bits = 62_u32
        .wrapping_add(bits(total_sweep))
        .wrapping_sub(bits(length)) as u8;
    (
        scaled_quotient(length, total_sweep, fraction_bits).0,
        fraction_bits,
    )
}
