//! Runs a program on the simulated machine.
//!
//! [`run::Run`] gives every event to [`mechanics::Mechanics`], which makes the step. Then each
//! observer of [`husillo_sim::observers`] gets the step together with the state of the machine
//! after it.

pub mod mechanics;
pub mod run;
pub mod work_piece;
