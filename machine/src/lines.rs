//! G-code lines in, events out: the part of the crate that needs `gcode`.

mod axis;
mod equipment;
mod event;
mod guard;
mod refused;

mod arc;
mod segment;
mod tangent;
mod tempo;

mod curve;
#[cfg(feature = "extended")]
mod extended;
mod extension;
mod state;

mod kept;
mod limits;
mod path_ramp;
mod plan;
mod schedule;
mod smooth_ramp;
mod take_up;

mod machine;

mod closed_loop;

#[cfg(feature = "nb")]
mod poll;

pub use axis::{Axis, AxisRamp, Config};
pub use closed_loop::{ClosedLoop, Followed};
pub use curve::Checker;
pub use equipment::Equipment;
pub use event::{Alarm, Event, FollowEvent, Output, Pause};
#[cfg(feature = "extended")]
pub use extended::Extended;
pub use extension::Extension;
pub use guard::StepGuard;
pub use husillo_encoder::{AxisEncoder, OnLoss};
pub use machine::{Filled, Machine, Origin};
pub use path_ramp::PathRamp;
pub use plan::{Plan, PlannedMove};
pub use refused::{Means, MoveError, Refused};
pub use segment::{Segment, extent};
pub use smooth_ramp::SmoothRamp;
pub use state::Probed;
