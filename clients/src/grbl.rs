//! Controllers with the protocol of Grbl: programs that are sent by counting characters, and moves
//! by hand.
//!
//! ```text
//! lines ──► sender ─┐
//! actions ► hand ───┴► session ─► wire ─► controller
//! ```

mod action;
mod hand;
mod sender;
mod session;
mod stream;

pub use action::Action;
pub use hand::Hand;
pub use sender::{Operator, Pacing, SYNCHRONISE, Sender, Sent, has_coordinate};
pub use session::{Heard, Session, alarm, described};
pub use stream::Stream;

use crate::Wire;
use husillo_sim::device::grbl::Device;
use husillo_transports::grbl::Settings;

/// Rate of the link of Grbl, bits/s.
pub const BAUD: u32 = 115_200;

/// Opens a controller at a port, or a simulated one with Grbl's factory settings at `sim`.
///
/// # Errors
///
/// Returns a sentence about the port.
pub fn open(port: &str, bits_per_s: u32) -> Result<Wire<Device>, String> {
    if port == "sim" {
        return Ok(Wire::simulated(Device::new(bits_per_s, Settings::DEFAULT)));
    }
    Wire::open(port, bits_per_s).map_err(|error| format!("{port}: {error}"))
}
