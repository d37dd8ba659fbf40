#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod timer;

mod durations;
mod jerk_ramp;
mod jerk_window;
mod junction;
mod look_ahead;
mod quotient;
mod ramp;
mod ring;
mod stretch;
mod tangent;

mod arc_limits;
mod axis_timers;
mod bursts;
mod follower;
mod phases;
mod rates;
mod recurrence;
mod s_curve;
mod servo;
mod surface_speed;
mod trapezoid;
#[cfg(feature = "fixed")]
mod units;
mod waits;
mod wide;

pub use arc_limits::ArcLimits;
pub use axis_timers::AxisTimers;
pub use bursts::{Burst, Bursts, Replay};
pub use durations::{mul_div, mul_div_q16, share, times};
/// The crate of the fixed-point types.
#[cfg(feature = "fixed")]
pub use fixed;
pub use follower::{Due, Follower};
pub use jerk_ramp::JerkRamp;
pub use jerk_window::{JerkLimits, JerkLimitsError, JerkWindow, Slice};
pub use junction::Junction;
pub use look_ahead::{Limits, LookAhead};
pub use ramp::{Piece, Ramp};
pub use rates::{Rates, RatesError};
pub use recurrence::Recurrence;
pub use s_curve::SCurve;
pub use servo::{ServoLine, ServoMotion, ServoProfile, ServoSetPoint};
pub use stretch::{Stretch, Upper};
pub use surface_speed::SurfaceSpeed;
pub use tangent::Tangent;
pub use timer::Timer;
pub use trapezoid::Trapezoid;
#[cfg(feature = "fixed")]
pub use units::{ServoPeriod, UnitRates, nanometres};
pub use waits::Waits;
