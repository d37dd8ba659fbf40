//! Levels to pins, switches from pins: `embedded-hal` 1.0.
//!
//! ```text
//!  one pin of any type   OutputPin
//!  one driver            DriverPins<1>: LevelPins, StepDirectionPins
//!  all drivers           DriverPins<N>: a tuple or an array of them, or PortPins on one port
//!  pulses with times     StepPulses, on any of these
//! ```

mod driver_pins;
mod level_pins;
mod output_pins;
mod port_pins;
mod step_direction_pins;
mod step_pulses;
mod switch;

pub use driver_pins::{DriverPins, PinError};
pub use level_pins::{LevelPins, PinCount};
pub use output_pins::OutputPins;
pub use port_pins::{Port, PortBits, PortPins};
pub use step_direction_pins::{StepDirectionPins, Unwired};
pub use step_pulses::StepPulses;
pub use switch::Switch;
