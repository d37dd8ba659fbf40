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
mod end;
mod hand;
mod held;
mod load;
mod part;
mod place;
mod sender;
#[cfg(test)]
mod tests;

pub use action::{Action, Axis};
pub use client::{Client, ClientError, Going};
pub use duration::{seconds, spoken, travel_s, travel_steps};
pub use end::{End, Failed, left, sentence};
pub use hand::{Hand, Keep};
pub use part::{Part, Stop, lean, millimetres};
pub use place::Place;
pub use sender::{Operator, Sender};

/// Rate of the original's link, bits/s.
pub const BAUD: u32 = 2400;
/// The default lease: the longest silence of a client while the drill moves, ms.
pub const LEASE_MS: u16 = 250;
