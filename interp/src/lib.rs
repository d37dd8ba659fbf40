#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod interpolator;
mod step;

mod line;

mod arc;
mod walk;

mod helix;

mod path;

pub use arc::{Arc, ArcError, ArcMove, Direction, Rim, fraction_bits_for};
pub use helix::Helix;
pub use interpolator::{Interpolator, Moves};
pub use line::Line;
pub use path::Path;
pub use step::Step;
