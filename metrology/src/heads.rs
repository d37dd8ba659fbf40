//! The head that carries a probe: one to three servo axes on a line. They move together in straight
//! lines.
//!
//! ```text
//! Prober ◄── Head ──► servo, way, touching, homing, jog, collision ──► Line ──► Port
//!                                                                        └────► Operator
//! ```

mod collision;
mod head;
mod homing;
mod jog;
mod line;
mod machine;
#[cfg(test)]
mod noise_test;
pub(crate) mod operator;
mod port;
mod prober;
mod search;
mod servo;
mod standing;
mod switches;
mod touching;
mod view;
mod way;

pub use head::Head;
pub use line::Line;
pub use machine::{AxisSettings, Machine, PLACES, ProbeSettings, Stylus, both_ways};
pub use operator::Operator;
pub use port::Port;
pub use prober::{Probed, Prober, Touched};
pub use switches::Switches;
pub use view::{Errors, View};
