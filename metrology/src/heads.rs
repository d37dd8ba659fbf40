//! The head that carries a probe: one to three servo axes whose modules are on one line. The axes
//! move together along straight paths.
//!
//! ```text
//! Prober ◄── Head ──► servo, straight_move, touching, homing, jog, collision ──► Line ──► Port
//!                                                                        └────► Operator
//! ```

mod approach;
mod axis_position;
mod collision;
mod ends;
mod head;
mod homing;
mod jog;
mod line;
mod machine;
mod memory;
#[cfg(test)]
mod noise_test;
pub(crate) mod operator;
mod port;
mod prober;
mod search;
mod servo;
mod settling;
mod steering;
mod straight_move;
mod switches;
mod touching;
mod view;
mod wiring;

pub(crate) use straight_move::per_period;

pub use approach::Approach;
pub use axis_position::AxisPosition;
pub use head::Head;
pub use line::Line;
pub use machine::{
    AxisSettings, Machine, PRE_TRAVEL_ENTRIES, ProbeSettings, Stylus, pre_travel_by_sign,
};
pub use memory::{AxisMemory, Memory, Rejoined};
pub use operator::Operator;
pub use port::Port;
pub use prober::{Probed, Prober, Touched};
pub use steering::Deflection;
pub use switches::Switches;
pub use view::{Errors, View};
pub use wiring::{End, Wiring};
