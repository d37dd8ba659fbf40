//! The CPU time of this thread.

use rustix::time::{ClockId, clock_gettime};

/// Seconds of CPU time since the thread began.
pub fn seconds() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}
