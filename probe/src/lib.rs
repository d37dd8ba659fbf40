//! Touch probe of a measuring machine or a mill: contacts in, measured points and features out.
//!
//! ```text
//!  pin, position ──► Latch (Debounce) ──► edge and the position at it
//!                                            │
//!  Plan ──► Cycle ◄── position, contact, still ─┘
//!             │ ──► move to at speed, stop, wait
//!             ▼
//!        Measurement or Failure
//!             │ position, direction
//!             ▼
//!        Tip (PreTravel by direction, radius) ──► surface point ──► features
//! ```
//!
//! Positions are plain `[i64; 3]`. They are in nm where the crate needs a length, and in any unit
//! where it only passes them on. The computation from the pin to the surface point uses integers
//! only.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod debounce;
mod latch;

mod cycle;
mod plan;
#[cfg(feature = "nb")]
mod poll;
mod report;

mod pre_travel;
mod tip;
mod unit_vector;

mod calibration;
mod features;
mod repeatability;

pub use calibration::{Calibration, Reference};
pub use cycle::Cycle;
pub use debounce::{Debounce, Edge};
pub use features::{Circle, FitError, Line, Middle, Plane, Residuals, Sphere, corner_nm};
pub use latch::{Latch, Latched, TooFarBack};
pub use plan::{Plan, PlanError};
pub use pre_travel::PreTravel;
pub use repeatability::Repeatability;
pub use report::{Failure, Input, Measurement, Request, Touch};
pub use tip::Tip;
pub use unit_vector::UnitVector;

/// Runs the README's example as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
