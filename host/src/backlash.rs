//! Backlash by position: its measurement by the two-line test, and the error that remains.

mod bench;
mod calibrating;
mod circles;
mod readings;

pub use bench::SimulatedBench;
pub use calibrating::calibrate_backlash;
pub use circles::print_circles;
