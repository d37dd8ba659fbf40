//! What a mill wants of its board.

use husillo_gcode::SpindleDirection;

use super::ways::Ways;

/// What the board reads.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Default)]
pub struct MicromillInputs {
    /// The home switches that are closed: bit 0 is that of X, then Y and Z.
    pub home: u8,
}

/// Wait, then step. An interrupt writes the masks to step and direction pins; bit 0 is X.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct MicromillStep {
    /// Timer ticks from the event before this one.
    pub wait_ticks: u32,
    /// The axes that make a motor step; none: only wait.
    pub axes: u8,
    /// Those of them that step backwards; no other bits.
    pub negative: u8,
}

impl MicromillStep {
    /// -1, 0 or +1 motor step of X, Y and Z.
    pub fn deltas(&self) -> [i8; 3] {
        Ways {
            axes: self.axes,
            negative: self.negative,
        }
        .deltas()
    }
}

/// One entry of the stream, in the order in which it must happen.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum MicromillEvent {
    /// Wait, then step. Call [`Micromill::made`](crate::Micromill::made) when this has happened.
    Step(MicromillStep),
    /// The spindle, at once.
    Spindle {
        /// Off, clockwise or counter-clockwise.
        direction: SpindleDirection,
        /// Turns per minute.
        rpm: u16,
    },
    /// A tool that the operator shall put in.
    Tool {
        /// Its number.
        number: u8,
    },
}
