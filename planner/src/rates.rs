//! Limits of a speed profile.

use core::fmt;

use crate::wide::{FRACTION_BITS, divide};

/// Rates and acceleration of one move, and the frequency of the timer that counts its ticks.
///
/// A rate in Hz is the rate of events, in steps per second.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rates {
    /// Ticks per second, at least 1.
    pub timer_hz: u32,
    /// Rate at which the move begins; 0 is standstill.
    pub start_rate_hz: u32,
    /// Highest rate, at least 1. A move that begins faster slows down to it at once.
    pub top_rate_hz: u32,
    /// Highest rate at the last event; 0 is standstill. A move too short to reach this rate ends
    /// slower.
    pub end_rate_hz: u32,
    /// Change of rate per second, both up and down; at least 1.
    pub acceleration_hz_per_s: u32,
}

/// Reason why a profile cannot be made.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RatesError {
    /// The timer frequency, the top rate, the acceleration or the jerk is 0.
    Zero,
    /// A ramp from standstill to one of the rates would take 2^30 ticks or more.
    RampTooLong,
    /// The acceleration or the jerk is too high for the timer frequency, or the timer is above 2^28
    /// Hz for a jerk-limited profile.
    TimerOutOfRange,
    /// There are too few events to slow down from the start rate to the end rate.
    TooShort,
}

impl fmt::Display for RatesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            RatesError::Zero => "timer, top rate, acceleration and jerk must not be 0",
            RatesError::RampTooLong => "the ramp takes 2^30 ticks or more",
            RatesError::TimerOutOfRange => "the timer does not suit acceleration or jerk",
            RatesError::TooShort => "too few events to slow down to the end rate",
        })
    }
}

impl core::error::Error for RatesError {}

impl Rates {
    /// Checks that the values fit the arithmetic.
    ///
    /// # Errors
    /// Every [`RatesError`] except [`RatesError::TooShort`].
    pub(crate) fn check(&self) -> Result<(), RatesError> {
        let acceleration = self.acceleration_hz_per_s;
        if self.timer_hz == 0 || self.top_rate_hz == 0 || acceleration == 0 {
            return Err(RatesError::Zero);
        }
        let fastest = self
            .start_rate_hz
            .max(self.top_rate_hz)
            .max(self.end_rate_hz);
        if ramp_ticks(self.timer_hz, acceleration, fastest) >> 30 != 0 {
            return Err(RatesError::RampTooLong);
        }
        let gain = gain(self.timer_hz, acceleration);
        // At least one tick^2 per event, and a first interval below 2^30 ticks.
        if gain >> FRACTION_BITS == 0 {
            return Err(RatesError::TimerOutOfRange);
        }
        if gain >> (60 + FRACTION_BITS) != 0 {
            return Err(RatesError::RampTooLong);
        }
        Ok(())
    }
}

/// Ticks of a ramp from standstill to `rate_hz`: f v / a, rounded down.
fn ramp_ticks(timer_hz: u32, acceleration_hz_per_s: u32, rate_hz: u32) -> u64 {
    u64::from(timer_hz)
        .wrapping_mul(rate_hz.into())
        .checked_div(acceleration_hz_per_s.into())
        .unwrap_or(u64::MAX)
}

/// The increase of the square of the ramp time per event: 2 f^2 / a in ticks^2, with
/// [`FRACTION_BITS`].
pub(crate) fn gain(timer_hz: u32, acceleration_hz_per_s: u32) -> u128 {
    // f < 2^32: 2 f^2 2^32 < 2^97.
    let square = u128::from(u64::from(timer_hz).wrapping_mul(timer_hz.into()));
    divide(
        square.wrapping_shl(FRACTION_BITS.wrapping_add(1)),
        acceleration_hz_per_s,
    )
}

/// The square of the time of a ramp from standstill to `rate_hz`: (f v / a)^2 in ticks^2 with
/// [`FRACTION_BITS`]. It is less than 1 tick^2 too small for ramps below 2^30 ticks.
pub(crate) fn square_of(timer_hz: u32, acceleration_hz_per_s: u32, rate_hz: u32) -> u128 {
    let product = u128::from(u64::from(timer_hz).wrapping_mul(rate_hz.into()));
    // Below 2^62, as `check` guarantees.
    let time = divide(product.wrapping_shl(32), acceleration_hz_per_s) as u64;
    u128::from(time)
        .wrapping_mul(time.into())
        .wrapping_shr(64_u32.wrapping_sub(FRACTION_BITS))
}
