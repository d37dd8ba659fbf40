#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod programs;

pub use programs::{arcs, mixed, segments};
