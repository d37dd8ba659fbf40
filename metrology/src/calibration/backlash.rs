//! Backlash by position. It is measured with pairs of lines, or with circles. The error that
//! remains with a map is measured, too.
//!
//! ```text
//! Bench ◄── two_lines ─► line_pair ─► table ─► Map
//!    ▲────── survey, circles ─► remaining error ─► field
//! ```

mod bench;
mod circles;
mod field;
mod line_pair;
mod survey;
mod table;
#[cfg(test)]
mod trials;
mod two_lines;

pub use bench::{Bench, Moment};
pub use circles::{CIRCLE_ENDS, left_at_ends};
pub use field::Field;
pub use line_pair::{LinePair, backlash_table};
pub use survey::{CELLS, Leftover, survey};
pub use table::{BacklashTable, Map};
pub use two_lines::{RUN_UP_MM, WHOLE_RUN_UP_MM, cut_all};
