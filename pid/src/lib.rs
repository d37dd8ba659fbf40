//! Fixed-point PID controller and the servo law of a motion module: target and measurement in,
//! drive out.
//!
//! ```text
//!  target ─►(-)─► DeadBand ─► P ────────────────────────────┐
//!            ▲                I  exact sum ◄─ AntiWindup ◄─┐├(+)─► limits ─► rounding ─► drive
//!  measured ─┴──────────────► D ─► Filter ─────────────────┼┤         │
//!  velocity, acceleration ───────► FeedForward ────────────┼┘         │
//!                                                          └──────────┘
//!  drive ─► PwmDirection           measured, target or drive ─► Biquad: notch, lead-lag, low-pass
//!
//!  command, actual, current ─► ServoLaw ─► Drive { pwm, is_reverse }      the law of the module
//! ```
//!
//! Settings and state are separate. One [`Pid`] or [`ServoLaw`] serves any number of axes; each
//! axis has its own [`State`] or [`ServoState`]. The crate has no clock: the caller samples at a
//! fixed rate, and gains are per sample.
//!
//! # Examples
//! ```
//! use fixed::types::{I16F16, I32F0};
//! use husillo_pid::{Conditional, Gains, Integration, Limits, Pid, State};
//!
//! let gains = Gains {
//!     proportional: I16F16::lit("1.5"),
//!     integral: I16F16::lit("0.25"),
//!     ..Gains::default()
//! };
//! let limits = Limits { low: I32F0::from_num(-255), high: I32F0::from_num(255) };
//! let pid = Pid::new(gains, Integration::Backward, limits)?.with_anti_windup(Conditional);
//! let mut axes = [State::default(); 3];
//! let drives = axes.each_mut().map(
//!     |axis| pid.update(axis, I32F0::from_num(100), I32F0::from_num(60))
//! );
//! assert_eq!(drives, [70; 3]);
//! # Ok::<(), husillo_pid::SettingsError>(())
//! ```

#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod settings;

mod pid;

mod derivative;
mod windup;

mod biquad;

mod stages;

mod servo;

mod regulator;

mod sign_magnitude;

#[cfg(feature = "embedded-hal")]
mod pins;

mod number;

pub mod tuning;

/// The crate of the fixed-point types.
pub use fixed;

pub use biquad::{Biquad, BiquadState, Coefficients, FilterError, SecondOrder};
pub use derivative::{Derivative, OfError, OfMeasurement};
pub use number::{Number, Span, Word};
pub use pid::{Pid, State, Term};
#[cfg(feature = "embedded-hal")]
pub use pins::{DriveError, PwmDirection};
pub use regulator::{Counts, Regulator};
pub use servo::{Drive, RateRule, ServoGains, ServoLaw, ServoState, TotalLimit};
pub use settings::{Gains, Integration, Limits, SettingsError};
pub use sign_magnitude::sign_magnitude;
pub use stages::{DeadBand, FeedForward, Filter, FilterState, error};
pub use windup::{AntiWindup, BackCalculation, Clamp, Conditional};

/// Runs the README's example as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
