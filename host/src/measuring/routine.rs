//! Measuring routines: `husillo measure run` and `husillo measure record`.
//!
//! `husillo-metrology` reads routines and carries them out. This module reads their files, shows
//! their mistakes and writes the reports.

mod findings;
mod job;
mod measured;

pub use job::{Ending, Routine, recorded, run};
pub use measured::now;
