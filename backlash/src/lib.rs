//! Turns load positions into motor positions: the steps of a screw before its nut follows in the
//! opposite direction.
//!
//! ```text
//!  delta, load ──► Compensator ──► take-up per axis, made before the event, X before Y before Z
//!                      │           steps due because the local backlash has changed
//!                      ▼
//!                BacklashModel     take_up when an axis reverses, follow after every event:
//!                                  one value per axis (Backlash), a BacklashMap (MappedBacklash),
//!                                  or your own
//!
//!   screw tooth m ├───── backlash ─────┤ m + backlash
//!                 ▲ Flank::Positive    ▲ Flank::Negative      where the nut touches
//! ```
//!
//! Backlash is in motor steps. The errors of an axis are in nanometres. They are removed from
//! measured positions and added to goals:
//!
//! ```text
//!  readings ──► ErrorTable, one per axis ──► Squareness ──► true position
//!               scale, pitch, direction      three angles
//!
//!  Calibration: all of these, in both directions
//! ```
//!
//! ```
//! use husillo_backlash::{Backlash, Flank};
//!
//! let mut x = Backlash::new(1457, Flank::Positive);
//! assert_eq!(x.motor_target(100), 100);
//! assert_eq!(x.motor_target(90), 90 - 1457); // reversed: the backlash first
//! assert_eq!(x.load_position(90 - 1457), 90);
//! ```

#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod model;

mod compensator;
mod map;
mod mapped;
mod play;
mod uniform;

mod calibration;
mod error_table;
#[cfg(feature = "fixed")]
mod millimetres;
mod squareness;

pub use calibration::Calibration;
pub use compensator::Compensator;
pub use error_table::{ErrorTable, Knot, TableError};
/// The crate of the fixed-point types.
#[cfg(feature = "fixed")]
pub use fixed;
pub use map::{BacklashMap, MapError};
pub use mapped::MappedBacklash;
#[cfg(feature = "fixed")]
pub use millimetres::steps;
pub use model::{BacklashModel, Flank};
pub use play::Play;
pub use squareness::Squareness;
pub use uniform::Backlash;

/// The README's example, as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
