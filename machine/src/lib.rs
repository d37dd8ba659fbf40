#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod motors;
mod pulses;
mod step_event;

mod servo_axis;
mod servo_module;

mod cell;
mod drill;

#[cfg(feature = "gcode")]
mod lines;
#[cfg(feature = "nb")]
mod poll;

pub use cell::{CELL_MOTORS, Cell, CellConfig, CellEvent, CellInputs, CellPair, PAIR};
pub use drill::{Drill, DrillConfig, DrillEvent, DrillFault, DrillInputs, DrillReport};
pub use husillo_interp::Scale;
pub use husillo_transports::byte_commands::Report as CellReport;
pub use husillo_transports::micromill::Stops as MillStops;
#[cfg(feature = "gcode")]
pub use lines::*;
pub use motors::{Idle, Motors};
#[cfg(feature = "nb")]
pub use poll::NotFound;
pub use servo_axis::{ServoAxis, ServoEvents, ServoInputs, ServoStatus, ServoStop};
pub use servo_module::{ServoModule, ServoModuleOutput, servo_law};
pub use step_event::{MAX_WAIT_TICKS, StepEvent};
