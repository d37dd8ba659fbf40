//! Inputs and events of a mill.

use husillo_gcode::SpindleDirection;

use super::directions::Directions;

/// Inputs that the board reads.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Default)]
pub struct MicromillInputs {
    /// The closed home switches: bit 0 is X, then Y and Z.
    pub home: u8,
}

/// Wait, then step. An interrupt writes the masks to step and direction pins; bit 0 is X.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct MicromillStep {
    /// Timer ticks from the previous event.
    pub wait_ticks: u32,
    /// Axes that make a motor step. No axes: only wait.
    pub axes: u8,
    /// Those of `axes` that step backwards; no other bits.
    pub negative: u8,
}

impl MicromillStep {
    /// Returns -1, 0 or +1 motor step for X, Y and Z.
    pub fn deltas(&self) -> [i8; 3] {
        Directions {
            axes: self.axes,
            negative: self.negative,
        }
        .deltas()
    }
}

/// An event of the stream. The caller makes events in their order.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum MicromillEvent {
    /// Wait, then step. Call [`Micromill::made`](crate::Micromill::made) when this is done.
    Step(MicromillStep),
    /// Switch the spindle immediately.
    Spindle {
        /// Off, clockwise or counter-clockwise.
        direction: SpindleDirection,
        /// Revolutions per minute.
        rpm: u16,
    },
    /// The operator must insert a tool.
    Tool {
        /// The number of the tool.
        number: u8,
    },
}
