//! Measuring routines: `husillo measure run` and `husillo measure record`.
//!
//! `husillo-metrology` reads them and carries them out; here are their files, what is said of their
//! mistakes, and the reports.

mod findings;
mod job;
mod listing;
mod page;
mod picture;

pub use job::{Ending, Routine, recorded, run};
