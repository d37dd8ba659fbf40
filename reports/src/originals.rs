//! The measured tables of the original machines, rebuilt.

mod page;
mod picture;
mod text;

use husillo_metrology::originals::Table;
use serde::Serialize;

pub use page::html;
pub use picture::Picture;
pub use text::{text, verdict};

/// The rebuilt tables of a machine.
#[derive(Debug, Serialize)]
pub struct Rebuilt {
    /// Its name.
    pub machine: &'static str,
    /// Its tables.
    pub tables: Vec<Table>,
    /// Pictures, each with the number of its table.
    #[serde(skip)]
    pub pictures: Vec<(&'static str, Picture)>,
}

impl Rebuilt {
    /// Starts without tables. `machine` is the name of the machine.
    pub const fn new(machine: &'static str) -> Self {
        Self {
            machine,
            tables: Vec::new(),
            pictures: Vec::new(),
        }
    }
}
