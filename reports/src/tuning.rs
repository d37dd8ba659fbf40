//! The gains of a servo axis.

mod listing;
mod page;

pub use listing::{percent, text};
pub use page::html;
