//! Load position in, motor position out: the steps a screw owes before its nut follows it the other
//! way.
//!
//! ```text
//!  delta, load ──► Compensator ──► take-up owed per axis, made before the event, X before Y before Z
//!                      │           steps owed because the lash under the nut is another one now
//!                      ▼
//!                    Lash          take_up when an axis turns round, follow after every event:
//!                                  one value per axis (Backlash), a LashMap (
//!                                      MappedBacklash
//!                                  ), or your own
//!
//!   screw tooth m ├────── lash ──────┤ m + lash
//!                 ▲ Flank::Positive  ▲ Flank::Negative      where the nut touches
//! ```
//!
//! That is in motor steps. The errors of an axis' length are in nanometres, for positions that are
//! measured or gone to:
//!
//! ```text
//!  readings ──► ErrorTable, one an axis ──► Squareness ──► true position      Calibration: all of it, and back
//!               scale, pitch, direction     three angles
//! ```
//!
//! ```
//! use husillo_backlash::{Backlash, Flank};
//!
//! let mut x = Backlash::new(1457, Flank::Positive);
//! assert_eq!(x.motor_target(100), 100);
//! assert_eq!(x.motor_target(90), 90 - 1457); // turned round: the play first
//! assert_eq!(x.load_position(90 - 1457), 90);
//! ```

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod lash;

mod compensator;
mod lash_map;
mod mapped;
mod play;
mod uniform;

mod calibration;
mod error_table;
mod squareness;

pub use calibration::Calibration;
pub use compensator::Compensator;
pub use error_table::{ErrorTable, Knot, TableError};
pub use lash::{Flank, Lash};
pub use lash_map::{LashMap, MapError};
pub use mapped::MappedBacklash;
pub use play::Play;
pub use squareness::Squareness;
pub use uniform::Backlash;

/// The README's example, as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
