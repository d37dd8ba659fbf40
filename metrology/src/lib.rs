//! A measuring machine as a library.

#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod calibration;
pub mod heads;
mod least_squares;
pub mod quantity;
pub mod routine;
mod scale;
pub mod simulated;
mod trouble;
pub mod tuning;

pub use scale::Scale;
pub use trouble::Trouble;
