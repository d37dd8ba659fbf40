//! The facts of a machine that turn nanometres into steps and ticks.

use husillo_gcode::{Dialect, Nm};

use crate::Scale;

/// One axis.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Travel of one step.
    pub scale: Scale,
    /// Lowest and highest machine position the tool may be sent to; `None` where the travel is unknown.
    pub travel: Option<[Nm; 2]>,
    /// Highest step rate in steps per second; at least 1. Rapid moves and take-up run at it.
    pub max_rate_hz: u32,
    /// Backlash in whole motor steps; 0 for none.
    pub lash_steps: u32,
    /// How it gets to a rate; `None`: at once, at any rate.
    pub ramp: Option<AxisRamp>,
}

/// How an axis changes its rate.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct AxisRamp {
    /// Change of the step rate in steps per second, per second; at least 1.
    pub acceleration_hz_per_s: u32,
    /// Step rate a move may start and stop at, steps per second; 0 where the axis has to ramp up from standstill.
    pub start_rate_hz: u32,
    /// Change of the acceleration of a take-up in steps per second, per second, per second; `None`: at once. Along the path
    /// the acceleration changes at once.
    pub jerk_hz_per_s2: Option<u32>,
    /// By how much the step rate may jump at a corner, steps per second; `None`: only [`Config::corner_deviation`] says.
    pub junction_hz: Option<u32>,
}

impl Axis {
    /// A step rate (or a change of it) in nanometres per second, rounded down; saturates.
    pub(crate) const fn nm_per_s(&self, rate_hz: u32) -> u64 {
        // Both below 2^32.
        let product = (self.scale.nm() as u64).wrapping_mul(rate_hz as u64);
        match product.checked_div(self.scale.steps() as u64) {
            Some(speed) => speed,
            None => 0,
        }
    }

    /// The fastest feed this axis takes, in nanometres per minute, rounded down.
    pub const fn max_feed_nm_per_min(&self) -> u64 {
        // `nm * rate < 2^64`; the factor 60 saturates, at 300 m/min of a 1 m step.
        let product = (self.scale.nm() as u64)
            .wrapping_mul(self.max_rate_hz as u64)
            .saturating_mul(60);
        match product.checked_div(self.scale.steps() as u64) {
            Some(feed) => feed,
            None => 0,
        }
    }
}

/// A machine of `N` axes, in the order X, Y, Z, A, B, C.
#[derive(Copy, Clone, Debug)]
pub struct Config<const N: usize> {
    /// The axes.
    pub axes: [Axis; N],
    /// Ticks per second of every `wait_ticks`.
    pub timer_hz: u32,
    /// What the lines are written in.
    pub dialect: Dialect,
    /// The largest difference of an arc's start and end radius that is accepted; `None`: as far as
    /// [`Modal`](husillo_gcode::Modal) accepts it.
    pub arc_tolerance: Option<Nm>,
    /// Highest path speed of rapid moves in nanometres per minute; `None`: as fast as the axes go.
    pub rapid: Option<Nm>,
    /// Highest path speed of feed moves in nanometres per minute; `None`: as fast as the axes go.
    pub top_feed: Option<Nm>,
    /// Counts a turn of the spindle's encoder, if it has one: moves can follow it then (G33, G76, G95).
    pub spindle_counts: Option<u32>,
    /// How far beside a corner a circle at the path's own acceleration may pass: the faster the corner is taken. `P` of
    /// G64 takes its place. `None`: corners are limited by the axes' junction rates alone, and are stops where none has one.
    pub corner_deviation: Option<Nm>,
}
