//! Lash by place: in machine files, measured by the two-line test, and what it leaves on the work.

mod bench;
mod calibrating;
mod circles;
mod file;
mod grid;
mod page;
mod survey;
mod two_lines;

pub use bench::Bench;
pub use calibrating::calibrate_backlash;
pub use circles::print_circles;
pub use file::{LashFile, Map, PlaceTable};
