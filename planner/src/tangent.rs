//! Unit vectors.

use crate::{quotient::quotient, ramp::whole_root};

/// The value of 1.0 in a unit vector.
pub(crate) const ONE: u32 = 1 << 30;

/// The direction of a path in `N` axes: a unit vector in units of 2^-30. `N` is at most 15.
///
/// # Examples
/// ```
/// use husillo_planner::Tangent;
///
/// let slope = Tangent::new([3_000, 4_000]).unwrap();
/// assert_eq!(slope.speed_limit(&[6_000_000, 16_000_000]), 10_000_000); // X has its 6 mm/s
/// assert_eq!(Tangent::<2>::new([0, 0]), None);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tangent<const N: usize>([i32; N]);

impl<const N: usize> Tangent<N> {
    /// Returns the direction of a vector of any length and unit; `None` when the vector is zero.
    ///
    /// Each component is accurate to 2 units of 2^-30.
    ///
    /// # Cost
    /// One square root and one division of 64 bits.
    pub fn new(vector: [i64; N]) -> Option<Self> {
        Self::with_length(vector).map(|(direction, _)| direction)
    }

    /// Returns the direction of a vector, and its length in the unit of the vector. Both follow
    /// from the same root. The length is rounded to nearest below 2^29, and accurate to 2^-28 of it
    /// beyond.
    ///
    /// # Examples
    /// ```
    /// let (slope, length) = husillo_planner::Tangent::with_length([3_000, -4_000]).unwrap();
    /// assert_eq!(length, 5_000);
    /// assert_eq!(slope, husillo_planner::Tangent::new([3, -4]).unwrap());
    /// ```
    pub fn with_length(vector: [i64; N]) -> Option<(Self, u64)> {
        let largest = vector.iter().fold(0, |largest, component| {
            component.unsigned_abs().max(largest)
        });
        if largest == 0 {
            return None;
        }
        // Scales the largest component to exactly 30 bits: 15 squares of 60 bits fit in 64 bits.
        let zeros = largest.leading_zeros();
        let scaled = vector.map(|component| {
            let size = component.unsigned_abs().wrapping_shl(zeros) >> 34;
            // size < 2^30.
            (size as i64).wrapping_mul(component.signum())
        });
        let sum = scaled.iter().fold(0_u64, |sum, component| {
            // The square has at most 60 bits.
            sum.saturating_add(component.wrapping_mul(*component) as u64)
        });
        // The norm is at least 2^29, so the factor is at most 2^32 and products have 62 bits.
        let root = u64::from(whole_root(sum));
        let norm = root.wrapping_add((sum.wrapping_sub(root.wrapping_mul(root)) > root).into());
        let factor = quotient(1 << 61, norm as u32) as i64;
        let direction =
            Self(scaled.map(|component| {
                (component.wrapping_mul(factor).wrapping_add(1 << 30) >> 31) as i32
            }));
        let length = match zeros.checked_sub(34) {
            // The root has so many bits below the unit, at most 29.
            Some(bits) => root
                .wrapping_add(1_u64.wrapping_shl(bits) >> 1)
                .wrapping_shr(bits),
            // It is below 2^32, and the longest vector below 2^66.
            None => root.saturating_mul(1_u64.wrapping_shl(34_u32.wrapping_sub(zeros))),
        };
        Some((direction, length))
    }

    /// Creates a direction from components in units of 2^-30. The caller guarantees that their
    /// squares add up to 2^60.
    ///
    /// For tangents that were computed by other means. Components beyond +-2^30 are limited to
    /// that.
    pub fn from_units(components: [i32; N]) -> Self {
        Self(components.map(|component| component.clamp(-(1 << 30), 1 << 30)))
    }

    /// The components in units of 2^-30.
    pub const fn components(&self) -> [i32; N] {
        self.0
    }

    /// Returns the opposite direction.
    pub fn reversed(&self) -> Self {
        Self(self.0.map(i32::wrapping_neg))
    }

    /// Highest path speed at which no axis exceeds its limit; all in nm/s (or in any other common
    /// unit).
    pub fn speed_limit(&self, axes: &[u32; N]) -> u32 {
        let sizes = self.0.map(i32::unsigned_abs);
        let limits = axes.iter().map(|limit| u64::from(*limit));
        let limit = along(limits.zip(sizes), ONE);
        u32::try_from(limit).unwrap_or(u32::MAX)
    }

    /// Highest acceleration along the path at which no axis exceeds its limit, in nm/s^2. The
    /// limits of the axes are cut to 2^40.
    pub fn acceleration_limit(&self, axes: &[u64; N]) -> u64 {
        let sizes = self.0.map(i32::unsigned_abs);
        along(axes.iter().copied().zip(sizes), ONE)
    }
}

/// The least of limit / size over the axes, times `one`; `u64::MAX` when all sizes are 0.
///
/// Limits are cut to 2^40. Sizes are at most 2^31, `one` is at most 2^31. Takes one division.
pub(crate) fn along(axes: impl Iterator<Item = (u64, u32)>, one: u32) -> u64 {
    let mut least = None;
    for (limit, size) in axes {
        if size == 0 {
            continue;
        }
        let limit = limit.min(1 << 40);
        least = match least {
            // Compares limit / size with other / other_size by products of 71 bits.
            Some((other, other_size)) if wide(limit, other_size) >= wide(other, size) => least,
            _ => Some((limit, size)),
        };
    }
    let Some((limit, size)) = least else {
        return u64::MAX;
    };
    match limit.checked_mul(one.into()) {
        Some(product) => quotient(product, size),
        None => {
            // Divides the upper half of the product first, then the lower half; saturates.
            let whole = quotient(limit, size);
            let rest = limit.wrapping_sub(whole.wrapping_mul(size.into()));
            let part = quotient(rest.wrapping_mul(one.into()), size);
            whole.saturating_mul(one.into()).saturating_add(part)
        }
    }
}

fn wide(limit: u64, size: u32) -> u128 {
    u128::from(limit).wrapping_mul(size.into())
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::Tangent;

    /// Lengths are those of exact arithmetic, rounded to nearest, where a unit is not too fine.
    #[test]
    fn lengths_are_rounded_to_nearest() {
        let mut random = oorandom::Rand64::new(1);
        let mut component = || {
            let size = random.rand_u64() >> (35 + random.rand_u64() % 29);
            let is_negative = random.rand_u64().is_multiple_of(2);
            if is_negative {
                -(size as i64)
            } else {
                size as i64
            }
        };
        for _ in 0..1_000_000 {
            let vector = [component(), component(), component()];
            let found = Tangent::with_length(vector).map_or(0, |(_, length)| length);
            let sum: u128 = vector
                .iter()
                .map(|size| u128::from(size.unsigned_abs()).pow(2))
                .sum();
            // The root of four times the square has one bit below the unit.
            let exact = (sum * 4).isqrt().div_ceil(2);
            assert_eq!(u128::from(found), exact, "{vector:?}");
        }
    }

    /// Lengths beyond 2^30 lose bits below 2^-28 of them.
    #[test]
    fn long_vectors_keep_28_bits() {
        for bits in 30..63 {
            let side = 1_i64 << bits;
            let (_, length) = Tangent::with_length([side, -side / 2]).unwrap();
            let exact = side as f64 * 1.25_f64.sqrt();
            assert!(
                (length as f64 - exact).abs() <= exact * (-28_f64).exp2(),
                "{bits}"
            );
        }
    }
}
