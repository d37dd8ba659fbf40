#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod axis;
mod event;
mod refused;

mod arc;
mod duration;
mod segment;
mod tangent;
mod tempo;

mod limits;
mod schedule;
mod take_up;

mod machine;
mod motors;
mod pulses;

mod closed_loop;
mod step_encoder;

mod servo_axis;
mod servo_module;

#[cfg(feature = "nb")]
mod poll;

mod cell;
mod drill;
mod mill;

pub use axis::{Axis, AxisRamp, Config};
pub use cell::{CELL_MOTORS, Cell, CellConfig, CellEvent, CellInputs, CellPair, PAIR};
pub use closed_loop::{ClosedLoop, Followed};
pub use drill::{Drill, DrillConfig, DrillEvent, DrillFault, DrillInputs, DrillReport};
pub use event::{Event, FollowEvent, MAX_WAIT_TICKS, Output, Pause, StepEvent};
pub use husillo_interp::Scale;
pub use husillo_transports::byte_commands::Report as CellReport;
pub use husillo_transports::micromill::Stops as MillStops;
pub use machine::{Machine, Origin};
pub use mill::{Mill, MillConfig, MillEvent, MillInputs, MillStep};
pub use motors::{Idle, Motors};
#[cfg(feature = "nb")]
pub use poll::NotFound;
pub use refused::{Means, MoveError, Refused};
pub use segment::{Segment, extent};
pub use servo_axis::{ServoAxis, ServoEvents, ServoInputs, ServoStatus, ServoStop};
pub use servo_module::{ServoModule, ServoModuleOutput, servo_law};
pub use step_encoder::{AxisEncoder, OnLoss};
