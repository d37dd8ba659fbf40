//! The time that a change of speed takes.

use crate::timer::{bits, scaled_quotient};

/// Ticks per unit of speed at constant acceleration: timer frequency / acceleration.
///
/// A ramp takes the difference of its end speeds times this constant, for any division into pieces.
/// So the times of the pieces add up without drift.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Slowness {
    /// In units of 2^-`fraction_bits` tick, times 2^32.
    ticks: u64,
    /// 32, or less if the slowest ramp would not fit 64 bits.
    pub(crate) fraction_bits: u8,
}

impl Slowness {
    /// Speeds are in units of 2^-`fine_bits` nm/s. `fine_bits` is below 32, and `acceleration` is
    /// not 0.
    pub(crate) fn new(timer_hz: u32, acceleration: u64, fine_bits: u8) -> Slowness {
        let fine_bits = u32::from(fine_bits);
        // f 2^(64 - fine) / a has at most this many bits more than 64.
        let excess = bits(timer_hz.into())
            .wrapping_add(1)
            .saturating_sub(bits(acceleration).wrapping_add(fine_bits))
            .min(32);
        let count = 64_u32.wrapping_sub(fine_bits).wrapping_sub(excess);
        Slowness {
            ticks: scaled_quotient(timer_hz.into(), acceleration, count as u8).0,
            fraction_bits: 32_u32.wrapping_sub(excess) as u8,
        }
    }

    /// Returns the time of a change of speed.
    #[inline]
    pub(crate) fn time(&self, speeds: u32) -> u64 {
        part(self.ticks, speeds)
    }

    /// Returns the time of `whole` 2^-`bits` units of speed; saturates. `bits` is above -32.
    pub(crate) fn time_of(&self, whole: u64, bits: i32) -> u64 {
        let product = u128::from(self.ticks).wrapping_mul(whole.into());
        let time = match bits.saturating_add(32) {
            shift @ 0..128 => product.wrapping_shr(shift.unsigned_abs()),
            128.. => 0,
            _ => u128::MAX,
        };
        u64::try_from(time).unwrap_or(u64::MAX)
    }
}

/// Returns `whole` times `share` / 2^32, rounded down.
#[inline]
pub(crate) fn part(whole: u64, share: u32) -> u64 {
    let share = u64::from(share);
    // (2^32 - 1)^2 + 2^32 - 1 fits.
    (whole >> 32)
        .wrapping_mul(share)
        .wrapping_add((whole & 0xffff_ffff).wrapping_mul(share) >> 32)
}
