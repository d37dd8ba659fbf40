//! Steps in, motor signals out: the levels of the inputs of a driver, one byte per motor.
//!
//! ```text
//!  delta ──► Sequencer ────► Levels  PH I0 I1 | A B C D INH1 INH2 | nibble ──► Driver::currents
//!  -1 0 +1 ► StepDirection ► Levels + ticks   STEP DIR: a pulse with set-up, hold, high, low times
//!       │                        │
//!       ├──► StepToggle ─► Levels│ STEP DIR for drivers that count both edges
//!       │                        └──► L297 ─► Levels  the chip behind CLOCK and CW/CCW, as a model
//!       └──► Microstep ────► [i16; 2]         coil currents of a sine drive
//! ```
//!
//! The crate owns no pin and no clock: levels are data. The feature `embedded-hal` adds the pins:
//! `StepPulses` makes pulses at pins of any types.
//!
//! ```
//! use husillo_stepper::{CoilDriver, Driver, Mode, Sequencer};
//!
//! let mut motor = Sequencer::new(Driver::Unipolar, Mode::Full)?;
//! let there: Vec<u8> = (0..4).map(|_| motor.step(1).0).collect();
//! assert_eq!(there, [9, 12, 6, 3]);
//! assert_eq!(motor.step(-1).0, 6);
//! # Ok::<(), husillo_stepper::Unsupported>(())
//! ```

#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod coil_driver;
mod drive;
mod driver;
mod l297;
mod levels;
mod microstep;
mod motors;
#[cfg(feature = "embedded-hal")]
mod pins;
mod pulse_timing;
mod pulses;
mod sequencer;
mod sine;
mod step_direction;
mod step_toggle;
mod tables;

pub use coil_driver::CoilDriver;
pub use drive::Drive;
pub use driver::{Driver, FULL_CURRENT};
pub use l297::{L297, L297Inputs};
pub use levels::Levels;
pub use microstep::Microstep;
pub use motors::{Idle, Motors};
#[cfg(feature = "embedded-hal")]
pub use pins::{
    DriverPins, LevelPins, OutputPins, PinCount, PinError, Port, PortBits, PortPins,
    StepDirectionPins, StepPulses, Switch, Unwired,
};
pub use pulse_timing::{PulseNanoseconds, PulseTiming};
pub use sequencer::{Mode, Sequencer, Unsupported};
pub use sine::{AMPLITUDE, sine};
pub use step_direction::{Busy, Present, StepDirection};
pub use step_toggle::StepToggle;

/// The examples of the README, as doctests. Some need the feature.
#[cfg(all(doctest, feature = "embedded-hal"))]
#[doc = include_str!("../README.md")]
struct Readme;
