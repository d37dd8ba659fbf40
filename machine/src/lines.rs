//! G-code lines in, events out: the part of the crate that needs `gcode`.

mod axis;
mod event;
mod guard;
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

mod closed_loop;
mod step_encoder;

#[cfg(feature = "nb")]
mod poll;

pub use axis::{Axis, AxisRamp, Config};
pub use closed_loop::{ClosedLoop, Followed};
pub use event::{Event, FollowEvent, Output, Pause};
pub use guard::StepGuard;
pub use machine::{Machine, Origin};
pub use refused::{Means, MoveError, Refused};
pub use segment::{Segment, extent};
pub use step_encoder::{AxisEncoder, OnLoss};
