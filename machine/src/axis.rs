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
}

impl Axis {
    /// The fastest feed this axis takes, in nanometres per minute, rounded down.
    pub const fn max_feed_nm_per_min(&self) -> u64 {
        // `nm * rate < 2^64`; the factor 60 saturates, at 300 m/min of a 1 m step.
        let product = (self.scale.nm() as u64 * self.max_rate_hz as u64).saturating_mul(60);
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
}
