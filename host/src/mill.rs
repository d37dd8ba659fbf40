//! The micro mill: programs as its strings, and a controller on a port.
//!
//! ```text
//! program ─► commands ─► translate ─► lines ─┬─► file.mm
//!                                            └─► sender ─► port ─► controller
//!                        the machine's steps ◄─ compared ─┘ steps told
//! ```

mod sender;
mod translate;

pub use sender::{Sending, send};
pub use translate::{Translated, translate};

use husillo_transports::micromill::{Line, Order};
use std::fmt::Write;

/// The lines as a file has them: one string a line.
pub fn text(lines: &[(usize, Line)]) -> String {
    let mut out = String::new();
    for (_, line) in lines {
        let text = Order::Line(*line).text();
        // Strings of the link are plain letters and digits; a string takes all that is written.
        let _ = writeln!(out, "{}", String::from_utf8_lossy(text.bytes()));
    }
    out
}
