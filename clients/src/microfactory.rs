//! The desktop microfactory: actions and figures, on one machine or on several at once.
//!
//! ```text
//! actions, figures ─► crew ─┬► client ─► wire ─┬─► device           simulated time
//!                           ├► client ...      └─► serial, socket   real time
//!                           └► client ...
//! ```

mod action;
mod client;
pub mod crew;
mod figure;
mod links;
mod settings;
#[cfg(test)]
mod tests;

pub use action::{Action, shares};
pub use client::{Client, LEASE, Motion};
pub use figure::{Figure, listed};
pub use links::Links;
pub use settings::{Settings, length};

/// Rate of the link, bits/s.
pub const BAUD: u32 = 9600;
