//! Highest speed at corners.

use crate::{
    Tangent,
    quotient::quotient,
    ramp::whole_root,
    stretch::square,
    tangent::{ONE, along},
};

/// Components of two directions that differ by at most this (4e-9) are equal except for rounding.
const ROUNDING: u32 = 4;

/// Rules for the speed at corners. The smallest speed that one of the rules allows holds; without
/// any rule, corners do not slow down.
///
/// A straight continuation has no limit, so a line tangent to an arc has none either. A full
/// reversal has the limit of the jump rule, which is 0 under junction deviation.
///
/// # Examples
/// ```
/// use husillo_planner::{Tangent, Junction};
///
/// let corner = Junction {
///     jump_nm_per_s: Some([1_000_000, 1_000_000]),
///     deviation_nm: None,
///     acceleration_nm_per_s2: [100_000_000; 2],
/// };
/// let [east, north] = [[1, 0], [0, 1]].map(|way| Tangent::new(way).unwrap());
/// assert_eq!(corner.speed(&east, &north), 1_000_000);
/// assert_eq!(corner.speed(&east, &east), u32::MAX);
/// assert_eq!(corner.speed(&east, &east.reversed()), 500_000);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Junction<const N: usize> {
    /// Speed by which each axis may jump; `None` switches the rule off.
    pub jump_nm_per_s: Option<[u32; N]>,
    /// Largest distance from the corner to a circle that rounds it with the acceleration of the
    /// path; `None` switches the rule off.
    pub deviation_nm: Option<u32>,
    /// Acceleration of each axis, limited to 2^40. Used by the deviation rule only.
    pub acceleration_nm_per_s2: [u64; N],
}

impl<const N: usize> Junction<N> {
    /// Highest speed from the direction at the end of one move to the direction at the start of the
    /// next; `u32::MAX` when there is no limit.
    ///
    /// # Cost
    /// Up to three square roots of 64 bits and three divisions of 64 by 32 bits.
    pub fn speed(&self, before: &Tangent<N>, after: &Tangent<N>) -> u32 {
        let [before, after] = [before.components(), after.components()];
        let mut change = [0_u32; N];
        let mut sum = [0_u32; N];
        for ((change, sum), (before, after)) in change
            .iter_mut()
            .zip(&mut sum)
            .zip(before.iter().zip(after))
        {
            // Both are at most 2^31.
            *change = after.abs_diff(*before);
            *sum = after.wrapping_add(*before).unsigned_abs();
        }
        if change.iter().all(|change| *change <= ROUNDING) {
            return u32::MAX;
        }
        let jump = match &self.jump_nm_per_s {
            Some(jumps) => {
                let limits = jumps.iter().map(|jump| u64::from(*jump));
                // Rounding does not count as a jump, however small the allowed jump is.
                let change = change.map(|change| if change <= ROUNDING { 0 } else { change });
                along(limits.zip(change), ONE)
            }
            None => u64::MAX,
        };
        let jump = u32::try_from(jump).unwrap_or(u32::MAX);
        match self.deviation_nm {
            Some(deviation) => {
                let squared = self.deviation_squared(deviation, &change, &sum);
                if squared < square(jump) {
                    whole_root(squared)
                } else {
                    jump
                }
            }
            None => jump,
        }
    }

    /// Square of the speed by junction deviation (S. K. Jeon; Grbl, planner.c, "junction
    /// deviation", 2011).
    ///
    /// v^2 = a d s / (1 - s), where s is the sine of half the angle between the moves (1 when
    /// straight on) and a is the acceleration the axes allow in the direction of the change. With h
    /// half the size of the change and s half the size of the sum of the directions, h^2 + s^2 = 1.
    /// So v^2 = a d s (1 + s) / h^2, which is as accurate for small angles as for large ones.
    fn deviation_squared(&self, deviation_nm: u32, change: &[u32; N], sum: &[u32; N]) -> u64 {
        if sum.iter().all(|sum| *sum <= ROUNDING) {
            return 0;
        }
        // 4 h^2 and 4 s^2, at most 2^62 each except for rounding.
        let change_squared = squares(change);
        let change_size = whole_root(change_squared).min(1 << 31);
        // The sine in 2^-31, so s (1 + s) in 2^-62 is at most 2^63. For small angles s = sqrt(1 -
        // h^2) is taken as 1 - h^2 / 2: the neglected h^4 / 8 is below 2^-27 for h^2 < 2^-12.
        let sine = if change_squared < 1 << 50 {
            (1_u64 << 31).wrapping_sub(change_squared >> 32)
        } else {
            u64::from(whole_root(squares(sum)).min(1 << 31))
        };
        let numerator = sine.wrapping_mul(sine.wrapping_add(2 * u64::from(ONE)));
        // Acceleration of the axes along the unit vector of the change: 40 bits, and 1 bit for the
        // projection.
        let limits = self.acceleration_nm_per_s2.iter().copied();
        let acceleration = along(limits.zip(change.iter().copied()), change_size);
        let reach = acceleration.saturating_mul(deviation_nm.into());
        scaled(reach, numerator, change_squared)
    }
}

fn squares<const N: usize>(vector: &[u32; N]) -> u64 {
    vector.iter().fold(0_u64, |sum, component| {
        // At most 2^62.
        let size = u64::from(*component);
        sum.saturating_add(size.wrapping_mul(size))
    })
}

/// `reach` `numerator` / `denominator`, accurate to 2^-30 of it; saturates.
fn scaled(reach: u64, numerator: u64, denominator: u64) -> u64 {
    if denominator == 0 {
        return u64::MAX;
    }
    if numerator == 0 || reach == 0 {
        return 0;
    }
    // 32 significant bits below, 64 above: the quotient has 32 or 33 bits.
    let [up, down] = [numerator.leading_zeros(), denominator.leading_zeros()];
    let divisor = (denominator.wrapping_shl(down) >> 32) as u32;
    let ratio = quotient(numerator.wrapping_shl(up), divisor);
    // numerator / denominator = ratio 2^(down - up - 32); the product has at most 97 bits.
    let product = u128::from(reach).wrapping_mul(ratio.into());
    let shift = 32_u32.wrapping_add(up).wrapping_sub(down) as i32;
    let product = if shift >= 0 {
        // up and down are below 64, so the shift is at most 95.
        product.wrapping_shr(shift.unsigned_abs())
    } else {
        // At most 31 bits to the left.
        product.wrapping_shl(shift.unsigned_abs())
    };
    u64::try_from(product).unwrap_or(u64::MAX)
}
