//! Configuration of a machine: converts nanometres into steps and ticks.

use husillo_gcode::{Dialect, Nm};

use crate::{Equipment, Scale};

/// Configuration of one axis.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Travel per step.
    pub scale: Scale,
    /// Lowest and highest permitted machine position of the tool; `None` where the travel is
    /// unknown.
    pub travel: Option<[Nm; 2]>,
    /// Highest step rate in steps/s, at least 1. Rapid moves and take-up run at this rate.
    pub max_rate_hz: u32,
    /// Backlash in whole motor steps; 0 for none.
    pub backlash_steps: u32,
    /// Acceleration ramp; `None` if the axis reaches any rate at once.
    pub ramp: Option<AxisRamp>,
}

/// Acceleration limits of an axis.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct AxisRamp {
    /// Acceleration in steps/s^2, at least 1.
    pub acceleration_hz_per_s: u32,
    /// Start/stop rate in steps/s; 0 where the axis has to ramp up from standstill.
    pub start_rate_hz: u32,
    /// Jerk of a take-up in steps/s^3, and of the path in a machine with
    /// [`SmoothRamp`](crate::SmoothRamp); `None` for no limit.
    pub jerk_hz_per_s2: Option<u32>,
    /// Largest jump of the step rate at a corner in steps/s; `None` if only
    /// [`Config::corner_deviation`] limits corners.
    pub junction_hz: Option<u32>,
}

impl Axis {
    /// Converts a step rate (or its change) to nanometres per second, rounded down; saturates.
    pub(crate) const fn nm_per_s(&self, rate_hz: u32) -> u64 {
        // Both are below 2^32.
        let product = (self.scale.nm() as u64).wrapping_mul(rate_hz as u64);
        match product.checked_div(self.scale.steps() as u64) {
            Some(speed) => speed,
            None => 0,
        }
    }

    /// Highest feed of this axis in nanometres per minute, rounded down.
    pub const fn max_feed_nm_per_min(&self) -> u64 {
        // `nm * rate < 2^64`. The factor 60 saturates at 300 m/min with steps of 1 m.
        let product = (self.scale.nm() as u64)
            .wrapping_mul(self.max_rate_hz as u64)
            .saturating_mul(60);
        match product.checked_div(self.scale.steps() as u64) {
            Some(feed) => feed,
            None => 0,
        }
    }
}

/// Configuration of a machine with `N` axes, in the order of the axes of its dialect
/// ([`Dialect::axes`]).
#[derive(Copy, Clone, Debug)]
pub struct Config<const N: usize> {
    /// The axes.
    pub axes: [Axis; N],
    /// Ticks per second of every `wait_ticks`.
    pub timer_hz: u32,
    /// Dialect of the lines.
    pub dialect: Dialect,
    /// Largest permitted difference of the start and end radius of an arc; `None` for the limit of
    /// [`Modal`](husillo_gcode::Modal).
    pub arc_tolerance: Option<Nm>,
    /// Highest path speed of rapid moves in nanometres per minute; `None` for the limit of the
    /// axes.
    pub rapid: Option<Nm>,
    /// Highest path speed of feed moves in nanometres per minute; `None` for the limit of the axes.
    pub top_feed: Option<Nm>,
    /// Counts per turn of the spindle encoder, if there is one. Moves can then follow the spindle
    /// (G33, G76, G95).
    pub spindle_counts: Option<u32>,
    /// Largest distance from the corner to a circle that rounds it with the acceleration of the
    /// path; a larger distance allows a faster corner. `P` of G64 replaces it. `None`: only the
    /// junction rates of the axes limit corners; if no axis has one, the path stops at corners.
    pub corner_deviation: Option<Nm>,
    /// What the machine has besides its axes.
    pub equipment: Equipment,
}
