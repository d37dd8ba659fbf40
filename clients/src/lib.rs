#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod by_hand;
pub mod drill;
#[cfg(test)]
mod faults;
pub mod grbl;
#[cfg(unix)]
pub mod holder;
pub mod microfactory;
pub mod micromill;
mod port;
mod stop_requests;
mod wire;

pub use by_hand::ByHand;
pub use port::{Port, read};
pub use stop_requests::StopRequests;
pub use wire::Wire;
