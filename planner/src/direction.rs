//! Unit vectors.

use crate::quotient::quotient;

/// 1 in a unit vector.
pub(crate) const ONE: u32 = 1 << 30;

/// A direction in `N` axes: a vector of length 1, in units of 2^-30. `N` is at most 15.
///
/// ```
/// use husillo_planner::Direction;
///
/// let slope = Direction::new([3_000, 4_000]).unwrap();
/// assert_eq!(slope.speed_limit(&[6_000_000, 16_000_000]), 10_000_000); // X has its 6 mm/s
/// assert_eq!(Direction::<2>::new([0, 0]), None);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Direction<const N: usize>([i32; N]);

impl<const N: usize> Direction<N> {
    /// The direction of a vector of any length and unit; `None` when it is zero.
    ///
    /// Right to 2 units of 2^-30 in each component. A square root and a division of 64 bits.
    pub fn new(vector: [i64; N]) -> Option<Self> {
        let largest = vector.iter().fold(0, |largest, component| {
            component.unsigned_abs().max(largest)
        });
        if largest == 0 {
            return None;
        }
        // The largest one to exactly 30 bits: 15 squares of 60 bits fit 64.
        let zeros = largest.leading_zeros();
        let scaled = vector.map(|component| {
            let size = component.unsigned_abs().wrapping_shl(zeros) >> 34;
            // Below 2^30.
            (size as i64).wrapping_mul(component.signum())
        });
        let sum = scaled.iter().fold(0_u64, |sum, component| {
            // 60 bits
            sum.saturating_add(component.wrapping_mul(*component) as u64)
        });
        // At least 2^29, so the factor is at most 2^32 and products have 62 bits.
        let norm = sum.isqrt();
        let norm = norm.wrapping_add((sum.wrapping_sub(norm.wrapping_mul(norm)) > norm).into());
        let factor = quotient(1 << 61, norm as u32) as i64;
        Some(Self(scaled.map(|component| {
            (component.wrapping_mul(factor).wrapping_add(1 << 30) >> 31) as i32
        })))
    }

    /// From components in units of 2^-30, whose squares the caller knows to add up to 2^60.
    ///
    /// For tangents that were computed otherwise. Components beyond +-2^30 are cut to that.
    pub fn from_units(components: [i32; N]) -> Self {
        Self(components.map(|component| component.clamp(-(1 << 30), 1 << 30)))
    }

    /// The components in units of 2^-30.
    pub const fn components(&self) -> [i32; N] {
        self.0
    }

    /// The other way.
    pub fn reversed(&self) -> Self {
        Self(self.0.map(i32::wrapping_neg))
    }

    /// Highest path speed at which no axis exceeds its own, all in nm/s (or in any other unit).
    pub fn speed_limit(&self, axes: &[u32; N]) -> u32 {
        let sizes = self.0.map(i32::unsigned_abs);
        let limits = axes.iter().map(|limit| u64::from(*limit));
        let limit = along(limits.zip(sizes), ONE);
        u32::try_from(limit).unwrap_or(u32::MAX)
    }

    /// Highest acceleration along the path at which no axis exceeds its own, nm/s^2. The limits of
    /// the axes are cut to 2^40.
    pub fn acceleration_limit(&self, axes: &[u64; N]) -> u64 {
        let sizes = self.0.map(i32::unsigned_abs);
        along(axes.iter().copied().zip(sizes), ONE)
    }
}

/// The least of limit / size, times `one`; `u64::MAX` when all sizes are 0. One division.
///
/// Limits are cut to 2^40; sizes are at most 2^31, `one` at most 2^31.
pub(crate) fn along(axes: impl Iterator<Item = (u64, u32)>, one: u32) -> u64 {
    let mut least = None;
    for (limit, size) in axes {
        if size == 0 {
            continue;
        }
        let limit = limit.min(1 << 40);
        least = match least {
            // limit / size against other / other_size, with products of 71 bits.
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
            // The upper and the lower half of the product, one after the other; saturates.
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
