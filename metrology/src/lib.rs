#![doc = include_str!("../README.md")]
//!
//! ## How it fits together
//!
//! ```text
//! routine ──► Prober ◄── Calibrated ──► Head ──► Line ──► Port ◄── SimulatedPort, or your own
//! calibration ──┘                         tuning ──┘ └──► Operator
//! ```
//!
//! `routine`, `calibration`, `tuning` and `simulated` use `heads`. `heads` uses none of them.

#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod calibration;
mod error;
pub mod heads;
mod least_squares;
pub mod originals;
pub mod quantity;
pub mod routine;
mod scale;
pub mod simulated;
pub mod tuning;

pub use error::Error;
pub use scale::Scale;
