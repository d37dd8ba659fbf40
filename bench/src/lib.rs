#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod least_time;
mod programs;
mod router;

pub use least_time::{Limits, least_seconds};
pub use programs::{arcs, mixed, segments};
pub use router::{ROUTER_HZ, Router, router};
