//! The circuit-board drill: single keys, and boards tool by tool.
//!
//! ```text
//! action ─► hand ──┐
//! parts ─► sender ─┴► client ─► wire ─┬─► device                    simulated time
//!                                     └─► serial, socket ─► device  real time
//! ```

mod action;
mod client;
mod duration;
mod hand;
mod part;
mod place;
mod sender;
#[cfg(test)]
mod tests;
pub mod visiting_order;

pub use action::{Action, Axis};
pub use client::{Client, Trouble};
pub use duration::{seconds, spoken, travel_s, travel_steps};
pub use hand::{Hand, Keep};
pub use part::{Part, Stop, lean, millimetres};
pub use place::Place;
pub use sender::{End, Failed, Operator, Sender, left, sentence};

/// Rate of the original's link, bits/s.
pub const BAUD: u32 = 2400;
/// The usual lease: the longest silence of a client while the drill moves, ms.
pub const LEASE_MS: u16 = 250;
