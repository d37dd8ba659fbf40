#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod controller;
mod drill;
mod grbl;
mod microfactory;
mod micromill;
mod ring;
mod servo_module;

pub use controller::{Controller, StopBytes, Timed};
pub use drill::{
    Drill, DrillConfig, DrillEvent, DrillFault, DrillInputs, DrillLights, DrillReport,
};
#[cfg(feature = "drivers")]
pub use grbl::GrblDriver;
pub use grbl::{Grbl, GrblEvent, GrblInputs, GrblMemory, GrblOptions, GrblStops, Protocol};
pub use husillo_transports::microfactory::Report as MicrofactoryReport;
pub use husillo_transports::micromill::Stops as MicromillStops;
pub use microfactory::{
    MICROFACTORY_MOTORS, Microfactory, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs,
    MicrofactoryStation,
};
pub use micromill::{Micromill, MicromillConfig, MicromillEvent, MicromillInputs, MicromillStep};
pub use servo_module::{ServoModule, ServoModuleOutput, servo_law};

/// Runs the README's example as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
