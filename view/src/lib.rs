#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod modules;
mod page;
mod panel;

pub use modules::{COLOURS, Module, VIEWER, VIEWER_STYLE};
pub use page::{Page, import_map};
pub use panel::{Asset, PANEL};
