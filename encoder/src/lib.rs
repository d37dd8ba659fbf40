#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod quadrature;

mod index;

mod extended;
#[cfg(feature = "embedded-hal")]
mod pins;
mod running;
mod step_watch;

mod velocity_by_count;
mod velocity_by_period;

pub use extended::Extended;
pub use index::{Index, Passage};
#[cfg(feature = "embedded-hal")]
pub use pins::{QuadraturePins, SampleError};
pub use quadrature::{CountDirection, Quadrature, Scale, Skipped, levels};
pub use running::{Byte, read_running, running_value};
pub use step_watch::{AxisEncoder, OnLoss, StepWatch};
pub use velocity_by_count::VelocityByCount;
pub use velocity_by_period::VelocityByPeriod;
