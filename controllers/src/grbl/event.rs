//! Inputs and events of a Grbl controller.

use crate::{StopBytes, Timed};

/// Levels of the input pins. All are high if nothing is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrblInputs {
    /// Limit switches of X, Y and Z.
    pub limits: [bool; 3],
    /// The probe.
    pub probe: bool,
    /// The safety door.
    pub door: bool,
    /// The hold button.
    pub hold: bool,
    /// The start button.
    pub start: bool,
    /// The reset button.
    pub reset: bool,
}

impl Default for GrblInputs {
    fn default() -> Self {
        GrblInputs {
            limits: [true; 3],
            probe: true,
            door: true,
            hold: true,
            start: true,
            reset: true,
        }
    }
}

/// An event of a Grbl controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrblEvent {
    /// Wait, then step motors.
    Step {
        /// Microseconds since the previous event.
        wait_ticks: u32,
        /// Step of each motor: -1, 0 or 1. A motor turns against its axis where `$3` inverts it.
        delta: [i8; 3],
    },
    /// Wait.
    Wait {
        /// Microseconds since the previous event.
        wait_ticks: u32,
    },
    /// Level of the pin that disables the motors, `$4` included.
    Disable {
        /// High level: off.
        is_high: bool,
    },
    /// Level of the pin for the direction of the spindle.
    SpindleDirection {
        /// Counter-clockwise.
        is_high: bool,
    },
    /// Duty cycle of the spindle.
    SpindleDuty {
        /// 0 for off, 255 for full speed.
        duty: u8,
    },
    /// Flood coolant.
    Flood {
        /// Whether it flows.
        is_on: bool,
    },
    /// Mist coolant.
    Mist {
        /// Whether it flows.
        is_on: bool,
    },
    /// Store [`Grbl::memory`](crate::Grbl::memory) now. No byte is sent before.
    Store,
}

impl Timed for GrblEvent {
    fn wait_ticks(&self) -> Option<u32> {
        match self {
            GrblEvent::Step { wait_ticks, .. } | GrblEvent::Wait { wait_ticks } => {
                Some(*wait_ticks)
            }
            _ => None,
        }
    }
}

/// The bytes that stop the motors. While an event is being made, the reset byte 0x18 stops them. At
/// other times no byte does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrblStops(pub(super) bool);

impl StopBytes for GrblStops {
    const NONE: Self = GrblStops(false);

    fn takes(self, byte: u8) -> bool {
        self.0 && byte == 0x18
    }
}
