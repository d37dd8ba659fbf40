//! Backlash by position: measured with pairs of lines or with circles, and the error that remains
//! with a map of it.
//!
//! ```text
//! Bench ◄── two_lines ─► line_pair ─► place_table ─► Map
//!    ▲────── survey, circles ─► remaining error ─► field
//! ```

mod bench;
mod circles;
mod field;
mod line_pair;
mod place_table;
mod survey;
#[cfg(test)]
mod trials;
mod two_lines;

pub use bench::{Bench, Moment};
pub use circles::{CIRCLE_ENDS, left_at_ends};
pub use field::Field;
pub use line_pair::{LinePair, place_table};
pub use place_table::{Map, PlaceTable};
pub use survey::{CELLS, Leftover, survey};
pub use two_lines::{RUN_UP_MM, WHOLE_RUN_UP_MM, cut_all};
