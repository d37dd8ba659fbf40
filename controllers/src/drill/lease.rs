//! Ends the work of a drill when its host is silent.

use super::task::{Next, Task};
use super::{Drill, DrillReport};

impl<const N: usize> Drill<N> {
    /// Returns the longest permitted silence of the line during the present work, us. `None`: there
    /// is no work, or the host has not requested a lease.
    pub fn lease_us(&self) -> Option<u32> {
        self.link.lease_us()
    }

    /// Ends the work, because no byte has arrived for [`lease_us`](Drill::lease_us).
    ///
    /// X and Y stop, and so does Z in a jog. Their motors start and stop at their rate, so no step
    /// is lost and the positions stay known. The position of an axis that was homing is not known.
    /// If Z is moving down to drill, it moves up at once. If it is moving up, it continues to its
    /// sensor. Then the spindle stops.
    pub fn expire(&mut self) {
        if self.link.lease_us().is_none() {
            return;
        }
        self.link.expire();
        self.report = Some(DrillReport::Expired);
        self.task = match self.task {
            Task::Leave { .. }
            | Task::Search { .. }
            | Task::Open { .. }
            | Task::Go { .. }
            | Task::JogZ { .. }
            | Task::Settle => Task::Settle,
            // The axis still returns, by up to three steps.
            Task::Beyond { axis, gone } => Task::Return { axis, left: gone },
            Task::Down { .. } => {
                self.link.discard_drilling();
                self.raise(Next::Rest)
            }
            Task::Up { left, next } => Task::Up {
                left,
                next: next.without_host(),
            },
            Task::OpenUp { left, next } => Task::OpenUp {
                left,
                next: next.without_host(),
            },
            Task::Idle | Task::Return { .. } | Task::Fault => self.task,
        };
    }
}
