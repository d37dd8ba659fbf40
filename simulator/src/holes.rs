//! Drill files: recognised by their names, read, and explained.

mod explain;
pub mod listing;

use crate::diagnostics::Findings;
use husillo_holes::Board;

pub use explain::because;
pub use husillo_holes::Setup;

/// Ends of the names of drill files.
const ENDS: [&str; 6] = [".drl", ".xln", ".exc", ".drd", ".ncd", ".drill"];

/// Whether a file is a drill file, by the options or by its name.
pub fn is_drill_file(dialect: Option<&str>, file: &str) -> bool {
    let lower = file.to_ascii_lowercase();
    match dialect {
        Some(dialect) => dialect == "excellon",
        None => ENDS.iter().any(|end| lower.ends_with(end)),
    }
}

/// Reads a drill file; `findings` gets all errors, warnings and reasons. `file` is its name.
pub fn read(text: &[u8], file: &str, setup: &Setup, findings: &mut Findings) -> Board {
    husillo_holes::read(text, setup, |remark| {
        findings.add(explain::finding(&remark, file));
    })
}
