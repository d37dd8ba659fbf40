//! Runs a program on the simulated machine and observes it.
//!
//! [`run::Run`] gives every event to [`mechanics::Mechanics`], which makes the step. Then each
//! [`observer::Observer`] gets the step together with the state of the machine after it.

pub mod deviation;
pub mod drawing;
pub mod encoders;
pub mod losses;
pub mod mechanics;
pub mod moves;
pub mod observer;
pub mod pace;
pub mod phases;
pub mod picture;
pub mod run;
pub mod speed;
pub mod statistics;
pub mod symmetry;
pub mod trace;
