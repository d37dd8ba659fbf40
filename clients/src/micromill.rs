//! The micro mill: strings of a program, and moves by hand.
//!
//! ```text
//! lines ─► sender ─┐
//! actions ─► hand ─┴► session ─► wire ─► controller
//! ```

mod action;
mod hand;
mod position;
mod resume;
mod sender;
mod session;
mod translate;

pub use action::{Action, Leg, Pace};
pub use hand::Hand;
pub use position::{Frame, LengthUnit, position, uncounted, work_zero};
pub use sender::{Sender, Sending, Sent};
pub use session::{Session, why};
pub use translate::{Translated, Translator, translate};

use crate::Wire;
use husillo_sim::device::micromill::Device;

/// Rate of the original's link, bits/s.
pub const BAUD: u32 = 9600;
/// The default lease, ms: a motion ends this long after the last byte of the host.
pub const LEASE_MS: u16 = 250;

/// Opens a controller at a port, or a simulated one at `sim`.
///
/// # Errors
///
/// Returns a sentence about the port.
pub fn open(port: &str, bits_per_s: u32) -> Result<Wire<Device>, String> {
    if port == "sim" {
        return Ok(Wire::simulated(Device::new(bits_per_s)));
    }
    Wire::open(port, bits_per_s).map_err(|error| format!("{port}: {error}"))
}
