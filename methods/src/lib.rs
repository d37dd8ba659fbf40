#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod comparison;
mod curve;
mod decision;
pub mod method;
pub mod motion;
pub mod programmed;
pub mod trial;
mod walk;

pub use comparison::{Comparer, Comparison, Instructions, Move, Row};
pub use curve::Curve;
pub use decision::{CRITERIA, Points, Weights};
pub use method::{Method, Shape};
pub use walk::{Steps, Walk, nominal};
