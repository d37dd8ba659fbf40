//! What a mill wants of its board.

use husillo_gcode::SpindleDirection;

use crate::StepEvent;

/// What the board reads.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Default)]
pub struct MillInputs {
    /// Whether the home switches of X, Y and Z are closed.
    pub home: [bool; 3],
}

/// One entry of the stream, in the order in which it must happen.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum MillEvent {
    /// Wait, then step: [`Mill::made`](crate::Mill::made) is to be told when that has happened. All deltas 0: only wait.
    Step(StepEvent<3>),
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
