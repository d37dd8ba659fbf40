//! Statistics of a run: extents, reversals, and the time of take-ups.

use crate::observers::{AXES, Now, Observer};
use husillo_machine::Origin;
use std::io;

/// Extents of the tool, and take-ups.
#[derive(Clone, Copy, Debug, Default)]
pub struct Statistics {
    /// Smallest position of the tool, steps.
    pub low: [i32; AXES],
    /// Largest position of the tool, steps.
    pub high: [i32; AXES],
    /// Timer ticks of take-up.
    pub take_up_ticks: u64,
    /// Take-ups of each axis.
    pub reversals: [u64; AXES],
}

impl Statistics {
    /// Sets the start of the tool.
    pub const fn start_at(&mut self, tool: [i32; AXES]) {
        self.low = tool;
        self.high = tool;
    }
}

impl Observer for Statistics {
    #[inline]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        for ((low, high), tool) in self.low.iter_mut().zip(&mut self.high).zip(now.tool) {
            *low = tool.min(*low);
            *high = tool.max(*high);
        }
        if now.origin == Origin::TakeUp {
            self.take_up_ticks += u64::from(now.step.wait_ticks);
            if now.begins_take_up {
                let axis = now.step.delta.iter().position(|delta| *delta != 0);
                if let Some(count) = axis.and_then(|axis| self.reversals.get_mut(axis)) {
                    *count += 1;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observers::tests::now;

    #[test]
    fn extents_and_take_ups_are_counted() {
        let mut statistics = Statistics::default();
        statistics.start_at([5, 5, 5, 0, 0, 0]);
        statistics.step(&now(1)).unwrap();
        statistics.step(&now(9)).unwrap();
        assert_eq!(
            (statistics.low, statistics.high),
            ([1, 0, 0, 0, 0, 0], [9, 5, 5, 0, 0, 0])
        );
        for begins_take_up in [true, false, false] {
            let seen = Now {
                origin: Origin::TakeUp,
                begins_take_up,
                ..now(9)
            };
            statistics.step(&seen).unwrap();
        }
        assert_eq!(statistics.take_up_ticks, 3000);
        assert_eq!(statistics.reversals, [1, 0, 0, 0, 0, 0]);
    }
}
