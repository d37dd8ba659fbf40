#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod step_event;

mod servo_axis;
mod stepper_axis;

#[cfg(feature = "gcode")]
mod lines;
#[cfg(feature = "nb")]
mod poll;

/// The crates whose types are part of this API.
pub use fixed;
pub use husillo_backlash as backlash;
#[cfg(feature = "gcode")]
pub use husillo_gcode as gcode;
pub use husillo_interp as interp;
pub use husillo_interp::Scale;
pub use husillo_pid as pid;
pub use husillo_planner as planner;
#[cfg(feature = "extended")]
pub use husillo_probe as probe;
pub use husillo_stepper as stepper;
#[cfg(feature = "gcode")]
pub use lines::*;
#[cfg(feature = "nb")]
pub use poll::NotFound;
pub use servo_axis::{ServoAxis, ServoEvents, ServoInputs, ServoStatus, ServoStop};
pub use step_event::{MAX_WAIT_TICKS, StepEvent};
pub use stepper_axis::{
    AccelerationLimits, AxisLimits, AxisProfile, Change, JerkLimits, StepUnits, StepperAxis,
    StepperAxisError, UnitsError,
};
