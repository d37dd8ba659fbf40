//! Coil levels in, tool position out: a simulated machine that does not know the commanded path.
//!
//! ```text
//!  Levels ──► coil currents ──► electrical angle ──► rotor ──► screw ──► nut = tool
//!             Driver::currents   a table per axis    nearest    backlash
//!                                                    equilibrium
//! ```
//!
//! The rotor loses steps that follow each other too fast, and jumps of half an electrical cycle.
//! [`Rig::lost_steps`] counts them.
//!
//! ```
//! use husillo_sim::{AxisModel, Rig};
//! use husillo_stepper::{CoilDriver, Driver, Mode, Sequencer};
//!
//! let mut motor = Sequencer::new(Driver::Pbl3717a, Mode::Full)?;
//! let axis = AxisModel::coils(Driver::Pbl3717a, Mode::Full)
//!     .with_backlash(3)
//!     .with_pull_out_ticks(2564);
//! let mut rig = Rig::new([axis], [motor.levels()]);
//! for _ in 0..5 {
//!     rig.apply(&[motor.step(1)], 5882);
//! }
//! assert_eq!(rig.tool(), [5]);
//! for _ in 0..5 {
//!     rig.apply(&[motor.step(-1)], 5882);
//! }
//! assert_eq!((rig.motor(), rig.tool()), ([0], [3])); // the backlash of the screw
//! assert_eq!(rig.lost_steps(), [0]);
//! # Ok::<(), husillo_stepper::Unsupported>(())
//! ```

#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod axis;
mod backlash_field;
mod dc_motor;
pub mod device;
mod drill_rig;
mod emulated;
pub mod geometry;
mod grbl_rig;
mod loss;
mod microfactory_rig;
mod micromill_rig;
mod model;
mod noisy_line;
pub mod observers;
mod place;
mod random;
mod rig;
mod servo_network;
mod spindle;
pub mod text;
mod touch_probe;
mod winding;

mod work_piece;

pub use backlash_field::BacklashField;
pub use dc_motor::{DcMotor, DcMotorModel};
pub use drill_rig::{DrillRig, DrilledHole};
pub use emulated::{Emulated, Plant};
pub use grbl_rig::{GrblOutputs, GrblPin, GrblRig, SlideSwitch};
pub use loss::{Cause, Loss};
pub use microfactory_rig::MicrofactoryRig;
pub use micromill_rig::MicromillRig;
pub use model::AxisModel;
pub use noisy_line::{Noise, NoisyLine};
pub use place::Place;
pub use random::Random;
pub use rig::Rig;
pub use servo_network::{
    Damage, FULL_CURRENT_A, IoInputs, NetworkModule, SERVO_PERIOD_S, ServoNetwork, Surroundings,
};
pub use spindle::Spindle;
pub use touch_probe::{TouchProbe, TouchProbeModel};
pub use winding::{Chopper, Current, Rotor, Winding};

pub use work_piece::{Bore, PointMm, Shape, Solid, WorkPiece};

/// The example of the README as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
