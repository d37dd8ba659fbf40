//! A measuring routine: its features, as text and as a page.

mod listing;
mod page;
mod picture;

pub use listing::{csv, json, summary, text};
pub use page::html;

/// What a report of a routine begins with: the routine, the part, the machine and the time.
#[derive(Debug)]
pub struct Heading<'a> {
    /// Name of the routine.
    pub routine: &'a str,
    /// Name or number of the part, as the operator gave it.
    pub part: Option<&'a str>,
    /// The machine in words.
    pub machine: &'a str,
    /// Time of the measurement, UTC.
    pub measured: String,
}
