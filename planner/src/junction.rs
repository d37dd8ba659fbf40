//! How fast a corner may be passed.

use crate::{
    Direction,
    direction::{ONE, along},
    quotient::quotient,
    stretch::square,
};

/// Components of two directions that differ by no more than this (4e-9) are the same but for
/// rounding.
const ROUNDING: u32 = 4;

/// The rules for corners: the smallest speed that one of them allows. With neither rule corners do
/// not slow down.
///
/// What goes straight on has no limit, so the tangent of an arc and of a line that leaves it have
/// none either; a full reversal has the jump's, which is 0 with junction deviation.
///
/// ```
/// use husillo_planner::{Direction, Junction};
///
/// let corner = Junction {
///     jump_nm_per_s: Some([1_000_000, 1_000_000]),
///     deviation_nm: None,
///     acceleration_nm_per_s2: [100_000_000; 2],
/// };
/// let [east, north] = [[1, 0], [0, 1]].map(|way| Direction::new(way).unwrap());
/// assert_eq!(corner.speed(&east, &north), 1_000_000);
/// assert_eq!(corner.speed(&east, &east), u32::MAX);
/// assert_eq!(corner.speed(&east, &east.reversed()), 500_000);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Junction<const N: usize> {
    /// Speed by which each axis may jump; `None`: not looked at.
    pub jump_nm_per_s: Option<[u32; N]>,
    /// How far beside the corner a circle of the path's own acceleration may pass; `None`: not
    /// looked at.
    pub deviation_nm: Option<u32>,
    /// Acceleration of each axis, cut to 2^40. For the deviation rule only.
    pub acceleration_nm_per_s2: [u64; N],
}

impl<const N: usize> Junction<N> {
    /// Highest speed from the direction at the end of one move to that at the start of the next;
    /// `u32::MAX` when there is no limit.
    ///
    /// Up to three square roots of 64 bits, three divisions of 64 by 32.
    pub fn speed(&self, before: &Direction<N>, after: &Direction<N>) -> u32 {
        let [before, after] = [before.components(), after.components()];
        let mut change = [0_u32; N];
        let mut sum = [0_u32; N];
        for ((change, sum), (before, after)) in change
            .iter_mut()
            .zip(&mut sum)
            .zip(before.iter().zip(after))
        {
            // At most 2^31 both.
            *change = after.abs_diff(*before);
            *sum = after.wrapping_add(*before).unsigned_abs();
        }
        if change.iter().all(|change| *change <= ROUNDING) {
            return u32::MAX;
        }
        let jump = match &self.jump_nm_per_s {
            Some(jumps) => {
                let limits = jumps.iter().map(|jump| u64::from(*jump));
                // Rounding is no jump, whatever little is allowed.
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
                    // Below 2^64: the root is below 2^32.
                    squared.isqrt() as u32
                } else {
                    jump
                }
            }
            None => jump,
        }
    }

    /// Junction deviation, S. K. Jeon (Grbl, planner.c, "junction deviation", 2011):
    ///
    /// v^2 = a d s / (1 - s), s the sine of half the angle between the moves (1 when straight on),
    /// a what the axes can do in the direction of the change. With half the change h and half the
    /// sum of the two directions s = |half the sum|, h^2 + s^2 = 1, so it is a d s (1 + s) / h^2,
    /// which is as exact for small angles as for large ones.
    fn deviation_squared(&self, deviation_nm: u32, change: &[u32; N], sum: &[u32; N]) -> u64 {
        if sum.iter().all(|sum| *sum <= ROUNDING) {
            return 0;
        }
        // 4 h^2 and 4 s^2, 2^62 each at most but for rounding.
        let change_squared = squares(change);
        let change_size = change_squared.isqrt().min(1 << 31);
        // The sine in 2^-31; s (1 + s) in 2^-62, 2^63 at most. For small angles s = sqrt(1 - h^2)
        // is 1 - h^2 / 2; what that leaves out, h^4 / 8, is below 2^-27 for h^2 < 2^-12.
        let sine = if change_squared < 1 << 50 {
            (1_u64 << 31).wrapping_sub(change_squared >> 32)
        } else {
            squares(sum).isqrt().min(1 << 31)
        };
        let numerator = sine.wrapping_mul(sine.wrapping_add(2 * u64::from(ONE)));
        // The axes' acceleration along the unit vector of the change, 40 bits and 1 for the
        // projection.
        let limits = self.acceleration_nm_per_s2.iter().copied();
        let acceleration = along(limits.zip(change.iter().copied()), change_size as u32);
        let reach = acceleration.saturating_mul(deviation_nm.into());
        scaled(reach, numerator, change_squared)
    }
}

/// Highest speed on an arc, nm/s: its acceleration towards the centre, v^2 / r, is half of what the
/// axes can do.
///
/// The other part, [`arc_acceleration`], is left for speeding up and slowing down: together they
/// are as long as the whole. `acceleration_nm_per_s2` is the smaller one of the axes of the plane.
pub fn arc_speed(acceleration_nm_per_s2: u64, radius_nm: u64) -> u32 {
    let squared = (acceleration_nm_per_s2 / 2).saturating_mul(radius_nm);
    // The root of 64 bits has 32.
    squared.isqrt() as u32
}

/// Acceleration along an arc beside half of it towards the centre: sqrt(3)/2 of the whole, nm/s^2.
pub fn arc_acceleration(acceleration_nm_per_s2: u64) -> u64 {
    // 0.866 is below sqrt(3)/2; the product of what is below 1000 fits.
    let whole = (acceleration_nm_per_s2 / 1000).wrapping_mul(866);
    whole.wrapping_add((acceleration_nm_per_s2 % 1000).wrapping_mul(866) / 1000)
}

fn squares<const N: usize>(vector: &[u32; N]) -> u64 {
    vector.iter().fold(0_u64, |sum, component| {
        // At most 2^62.
        let size = u64::from(*component);
        sum.saturating_add(size.wrapping_mul(size))
    })
}

/// `reach` `numerator` / `denominator`, right to 2^-30 of it; saturates.
fn scaled(reach: u64, numerator: u64, denominator: u64) -> u64 {
    if denominator == 0 {
        return u64::MAX;
    }
    if numerator == 0 || reach == 0 {
        return 0;
    }
    // 32 significant bits below, 64 above: a quotient of 32 or 33 bits.
    let [up, down] = [numerator.leading_zeros(), denominator.leading_zeros()];
    let divisor = (denominator.wrapping_shl(down) >> 32) as u32;
    let ratio = quotient(numerator.wrapping_shl(up), divisor);
    // numerator / denominator = ratio 2^(down - up - 32); the product has 97 bits at most.
    let product = u128::from(reach).wrapping_mul(ratio.into());
    let shift = 32_u32.wrapping_add(up).wrapping_sub(down) as i32;
    let product = if shift >= 0 {
        // up and down are below 64: at most 95.
        product.wrapping_shr(shift.unsigned_abs())
    } else {
        // At most 31 to the left.
        product.wrapping_shl(shift.unsigned_abs())
    };
    u64::try_from(product).unwrap_or(u64::MAX)
}
