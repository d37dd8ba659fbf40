#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod motors;
mod pulses;
mod step_event;

mod servo_axis;

#[cfg(feature = "gcode")]
mod lines;
#[cfg(feature = "nb")]
mod poll;

pub use husillo_interp::Scale;
#[cfg(feature = "gcode")]
pub use lines::*;
pub use motors::{Idle, Motors};
#[cfg(feature = "nb")]
pub use poll::NotFound;
pub use servo_axis::{ServoAxis, ServoEvents, ServoInputs, ServoStatus, ServoStop};
pub use step_event::{MAX_WAIT_TICKS, StepEvent};
