//! The public functions of `husillo-planner`.

use core::hint::black_box;

use husillo_planner::Timer;

/// Keeps every function in the program.
pub fn keep() {
    black_box([
        Timer::new as *const (),
        Timer::with_fraction_bits as *const (),
        Timer::wait as *const (),
        Timer::fraction_bits as *const (),
        Timer::rate as *const (),
    ]);
}
