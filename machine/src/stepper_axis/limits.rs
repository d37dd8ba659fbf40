//! The limits of a stepping axis, and the profile that keeps them.

use husillo_planner::{Rates, RatesError, SCurve, Trapezoid};

use super::AxisProfile;

/// Limits of an axis that know their profile.
///
/// [`AccelerationLimits`] and [`JerkLimits`] implement it.
pub trait AxisLimits {
    /// The speed profile of a motion within these limits.
    type Profile: AxisProfile;

    /// Ticks per second.
    fn timer_hz(&self) -> u32;

    /// The highest rate in steps per second.
    fn top_rate_hz(&self) -> u32;

    /// Makes the profile of a motion of `steps` steps from standstill to standstill, with a top
    /// rate of its own.
    ///
    /// # Errors
    /// The limits do not fit the arithmetic. This must not depend on the number of steps.
    fn profile(&self, top_rate_hz: u32, steps: u32) -> Result<Self::Profile, RatesError>;
}

/// Limited rate and acceleration: the ramps are straight.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AccelerationLimits {
    /// Ticks per second.
    pub timer_hz: u32,
    /// Highest rate in steps per second.
    pub top_rate_hz: u32,
    /// Change of rate per second.
    pub acceleration_hz_per_s: u32,
}

/// Limited rate, acceleration and jerk: the ramps are S-curves.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct JerkLimits {
    /// Ticks per second.
    pub timer_hz: u32,
    /// Highest rate in steps per second.
    pub top_rate_hz: u32,
    /// Highest change of rate per second.
    pub acceleration_hz_per_s: u32,
    /// Change of acceleration per second.
    pub jerk_hz_per_s2: u32,
}

impl AxisLimits for AccelerationLimits {
    type Profile = Trapezoid;

    fn timer_hz(&self) -> u32 {
        self.timer_hz
    }

    fn top_rate_hz(&self) -> u32 {
        self.top_rate_hz
    }

    fn profile(&self, top_rate_hz: u32, steps: u32) -> Result<Trapezoid, RatesError> {
        let rates = rates(self.timer_hz, top_rate_hz, self.acceleration_hz_per_s);
        Trapezoid::new(&rates, steps)
    }
}

impl AxisLimits for JerkLimits {
    type Profile = SCurve;

    fn timer_hz(&self) -> u32 {
        self.timer_hz
    }

    fn top_rate_hz(&self) -> u32 {
        self.top_rate_hz
    }

    fn profile(&self, top_rate_hz: u32, steps: u32) -> Result<SCurve, RatesError> {
        let rates = rates(self.timer_hz, top_rate_hz, self.acceleration_hz_per_s);
        SCurve::new(&rates, self.jerk_hz_per_s2, steps)
    }
}

const fn rates(timer_hz: u32, top_rate_hz: u32, acceleration_hz_per_s: u32) -> Rates {
    Rates {
        timer_hz,
        start_rate_hz: 0,
        top_rate_hz,
        end_rate_hz: 0,
        acceleration_hz_per_s,
    }
}
