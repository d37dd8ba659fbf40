//! An axis that waits by a delay of `embedded-hal`, blocking or async.

use husillo_stepper::{CoilDriver, Levels};

use super::{AxisLimits, StepperAxis};

impl<D: CoilDriver, L: AxisLimits> StepperAxis<D, L> {
    /// Waits for the next change of levels, and returns them; `None` at rest.
    ///
    /// The time between two calls comes on top of the delays, so a timer interrupt with
    /// [`next_change`](StepperAxis::next_change) is more exact.
    #[cfg(feature = "embedded-hal")]
    pub fn wait<W>(&mut self, delay: &mut W) -> Option<Levels>
    where
        W: embedded_hal::delay::DelayNs,
    {
        let change = self.due()?;
        let mut left = self.nanoseconds(change.ticks);
        while left > 0 {
            let part = left.min(u32::MAX.into()) as u32;
            delay.delay_ns(part);
            left = left.wrapping_sub(part.into());
        }
        self.due = None;
        Some(change.levels)
    }

    /// Waits for the next change of levels, and returns them; `None` at rest.
    ///
    /// The future may be dropped: no change is lost, and the next call waits for it anew. So a task
    /// can select between it and a command.
    #[cfg(feature = "embedded-hal-async")]
    pub async fn wait_async<W>(&mut self, delay: &mut W) -> Option<Levels>
    where
        W: embedded_hal_async::delay::DelayNs,
    {
        let change = self.due()?;
        let mut left = self.nanoseconds(change.ticks);
        while left > 0 {
            let part = left.min(u32::MAX.into()) as u32;
            delay.delay_ns(part).await;
            left = left.wrapping_sub(part.into());
        }
        self.due = None;
        Some(change.levels)
    }

    /// The change to wait for: that of a dropped future, or the next one.
    fn due(&mut self) -> Option<super::Change> {
        if self.due.is_none() {
            self.due = self.next_change();
        }
        self.due
    }

    /// Ticks in nanoseconds, rounded to nearest.
    fn nanoseconds(&self, ticks: u32) -> u64 {
        husillo_planner::mul_div(ticks.into(), 1_000_000_000, self.limits.timer_hz().into())
    }
}
