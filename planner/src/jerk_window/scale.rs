//! Units of the jerk window.

use core::fmt;

use crate::{
    durations::mul_div,
    jerk_window::filter::{PARTS, SLICES},
    timer::{bits, scaled_quotient},
};

/// Limits of the path for a [`JerkWindow`](crate::JerkWindow).
///
/// The window lasts `acceleration / jerk`: the time from no acceleration to the full one.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct JerkLimits {
    /// Acceleration along the path, the same for all moves. It is safe to use the least one that
    /// the axes allow in any direction.
    pub acceleration_nm_per_s2: u64,
    /// Change of the acceleration per second.
    pub jerk_nm_per_s3: u64,
    /// Highest speed of any move; higher ones are limited to it.
    pub highest_nm_per_s: u32,
}

/// Reason why the limits of a jerk window cannot be used.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum JerkLimitsError {
    /// The acceleration, the jerk or the highest speed is 0.
    Zero,
    /// The window is so short that the speed changes by less than 64 units in a slice. At 1 m/s^2
    /// it has to last at least 63 us.
    WindowTooShort,
    /// The window is so long that its values do not fit. At 1 m/s^2 and 1 m/s it may last 2.9 s.
    WindowTooLong,
}

impl fmt::Display for JerkLimitsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            JerkLimitsError::Zero => "acceleration, jerk and highest speed must not be 0",
            JerkLimitsError::WindowTooShort => "the jerk is too high for the acceleration",
            JerkLimitsError::WindowTooLong => "the jerk is too low for the acceleration",
        })
    }
}

impl core::error::Error for JerkLimitsError {}

/// Longer moves are taken as this (1.1 km).
const MAX_LENGTH_NM: u64 = 1 << 40;
/// Most fraction bits of a unit.
const MOST_BITS: u32 = 12;
/// Bits of the highest speed and of the highest step, in units per slice. With these the braking
/// distance and all products that lead to it fit in 63 bits.
const SPEED_BITS: u32 = 30;
const STEP_BITS: u32 = 25;

/// Conversion to units of 2^-`fraction_bits` nm, and to slices.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Scale {
    /// Duration of a slice in s, times 2^(32 + `fraction_bits`). Rounded up, so that the jerk is
    /// not exceeded.
    slice: u32,
    pub(crate) fraction_bits: u8,
    /// Largest change of speed in a slice, in units per slice.
    pub(crate) step: u32,
    /// The longest path whose product with the step has 62 bits.
    pub(crate) reach: u64,
    highest_nm_per_s: u32,
    pub(crate) acceleration: u64,
}

impl Scale {
    pub(crate) fn new(limits: &JerkLimits) -> Result<Scale, JerkLimitsError> {
        let JerkLimits {
            acceleration_nm_per_s2: acceleration,
            jerk_nm_per_s3: jerk,
            highest_nm_per_s,
        } = *limits;
        if acceleration == 0 || jerk == 0 || highest_nm_per_s == 0 {
            return Err(JerkLimitsError::Zero);
        }
        // 32 fraction bits, and those of a unit, for the 16th part of the window.
        let digits = 32_u32.wrapping_add(MOST_BITS).wrapping_sub(SLICES.ilog2());
        let (finest, _) = scaled_quotient(acceleration, jerk, digits as u8);
        for fraction_bits in (0..=MOST_BITS).rev() {
            let shift = MOST_BITS.wrapping_sub(fraction_bits);
            let slice = finest.wrapping_shr(shift).saturating_add(1);
            let Ok(slice) = u32::try_from(slice) else {
                continue;
            };
            // At most 2^128 / 2^64.
            let squared = u64::from(slice).wrapping_mul(slice.into());
            let step = u128::from(squared).wrapping_mul(acceleration.into());
            let step = step.wrapping_shr(64_u32.wrapping_add(fraction_bits));
            let speed = u64::from(slice).wrapping_mul(highest_nm_per_s.into()) >> 32;
            if step >> STEP_BITS != 0 || bits(speed) > SPEED_BITS {
                continue;
            }
            if step < 64 {
                return Err(JerkLimitsError::WindowTooShort);
            }
            return Ok(Scale {
                slice,
                fraction_bits: fraction_bits as u8,
                step: step as u32,
                // Below 2^(62 - k) with a step below 2^k.
                reach: u64::MAX.wrapping_shr(bits(step as u64).wrapping_add(2)),
                highest_nm_per_s,
                acceleration,
            });
        }
        Err(JerkLimitsError::WindowTooLong)
    }

    /// Units per slice, rounded down.
    pub(crate) fn speed(&self, nm_per_s: u32) -> u32 {
        let nm_per_s = nm_per_s.min(self.highest_nm_per_s);
        (u64::from(self.slice).wrapping_mul(nm_per_s.into()) >> 32) as u32
    }

    /// Whether a run from stop to stop uses the whole window: it is at least 2 a T^2 long.
    pub(crate) fn fills_window(&self, half_units: u64) -> bool {
        // With T in slices, a T^2 is 256 steps.
        half_units >= u64::from(self.step) << 10
    }

    /// The window of a run that does not fill this one. Its jerk is the same, and its acceleration
    /// is that of the jerk after a quarter of the time of the run: L = 2 j T^3.
    pub(crate) fn shortened(&self, half_units: u64) -> Scale {
        // The next speeds are whole steps, so that a run ends a slice later if its step is too
        // small. Below 2^25.
        let step = (half_units >> 10).saturating_add(half_units >> 16);
        let step = step.min(self.step.into()).max(64);
        let cube = |slice: u32| {
            u128::from(u64::from(slice).wrapping_mul(slice.into())).wrapping_mul(slice.into())
        };
        // 96 and 25 bits.
        let least = cube(self.slice).wrapping_mul(step.into());
        let is_enough = |slice: u32| cube(slice).wrapping_mul(self.step.into()) >= least;
        // The least slice that keeps the jerk.
        let mut slice = self.slice;
        for bit in (0..32).rev() {
            let less = slice.saturating_sub(1_u32.wrapping_shl(bit));
            if is_enough(less) {
                slice = less;
            }
        }
        Scale {
            slice,
            step: step as u32,
            reach: u64::MAX.wrapping_shr(bits(step).wrapping_add(2)),
            ..*self
        }
    }

    /// Converts a path of slices per slice to nm/s, rounded down.
    pub(crate) fn nm_per_s(&self, speed: u64) -> u32 {
        // There are 2 PARTS units in 2^-fraction_bits nm, and the slice has as many fraction bits.
        let parts = u64::from(PARTS).wrapping_mul(2);
        let speed = mul_div(speed, 1 << 32, parts.wrapping_mul(self.slice.into()));
        speed.min(u32::MAX.into()) as u32
    }

    /// Highest speed of a move that allows this acceleration: what it reaches in a window, if it is
    /// below that of the window.
    pub(crate) fn most_at(&self, acceleration: u64) -> u32 {
        if acceleration >= self.acceleration {
            return u32::MAX;
        }
        // 64 and 32 bits. The window has 16 slices.
        let product = u128::from(acceleration).wrapping_mul(self.slice.into());
        let speed = product.wrapping_shr(28_u32.wrapping_add(self.fraction_bits.into()));
        speed.min(u32::MAX.into()) as u32
    }

    /// Length of a move in half units, at most 2^53.
    pub(crate) fn half_units(&self, length_nm: u64) -> u64 {
        let bits = u32::from(self.fraction_bits).wrapping_add(1);
        length_nm.min(MAX_LENGTH_NM).wrapping_shl(bits)
    }

    /// Ticks of a slice times 2^32, rounded up.
    pub(crate) fn ticks_q32(&self, timer_hz: u32) -> u64 {
        let product = u64::from(self.slice).wrapping_mul(timer_hz.into());
        product
            .wrapping_shr(self.fraction_bits.into())
            .saturating_add(1)
    }
}
