//! Backlash by position: measured by the two-line test, and what remains of it on the work.

mod bench;
mod calibrating;
mod circles;
mod page;
mod readings;

pub use bench::SimulatedBench;
pub use calibrating::calibrate_backlash;
pub use circles::print_circles;
