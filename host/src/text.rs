//! Formats of values.

pub mod json;
pub mod name;

/// A count for people: a comma before each three digits, as in the lines that show progress.
pub fn grouped(count: u64) -> String {
    indicatif::HumanCount(count).to_string()
}
