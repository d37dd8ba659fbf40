//! Lash by place: in machine files, measured by the two-line test, and what it leaves on the work.

mod bench;
mod calibrating;
mod circles;
mod page;
mod readings;

pub use calibrating::calibrate_backlash;
pub use circles::print_circles;
