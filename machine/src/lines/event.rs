//! What comes out of the machine: the event stream.

use husillo_gcode::SpindleDirection;

use crate::StepEvent;

/// One entry of the stream, in the order in which it must happen.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Event<const N: usize> {
    /// Wait, then move.
    Step(StepEvent<N>),
    /// Wait, then nothing: at most [`MAX_WAIT_TICKS`](crate::MAX_WAIT_TICKS).
    Dwell {
        /// Timer ticks to wait.
        wait_ticks: u32,
    },
    /// Wait for the index pulse of the spindle's encoder; the counts of what follows begin at it.
    Index,
    /// Wait for the spindle to turn, then move: G33, G76, G95.
    Follow(FollowEvent<N>),
    /// Switch something, exactly between the moves it stands between.
    Output(Output),
    /// Stand still until the operator goes on (or for good, at the end of the program).
    Pause(Pause),
}

/// Let the spindle turn by `wait_counts_q16`, then step every axis by its delta.
///
/// What falls behind (a spindle too fast, a take-up on the way) is made up: counts add up from the first event of the move, or
/// from the index before it. [`husillo_planner::Follower`] times these events between two counts.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct FollowEvent<const N: usize> {
    /// Encoder counts since the event before this one, times 2^16; at most 2^31.
    pub wait_counts_q16: u32,
    /// -1, 0 or +1 motor step of every axis; all 0 where the spindle has to turn further than one event can say.
    pub delta: [i8; N],
}

/// A switch of the machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Output {
    /// Spindle direction and speed.
    Spindle {
        /// Off, clockwise or counter-clockwise.
        direction: SpindleDirection,
        /// Speed in thousandths of a turn per minute.
        milli_rpm: u64,
    },
    /// Coolant valves.
    Coolant {
        /// M7.
        mist: bool,
        /// M8.
        flood: bool,
    },
    /// One drilling: down to the lower end switch and up to the upper one, before anything else moves.
    Drill,
    /// The tool that is in the spindle from here on.
    Tool {
        /// Number of the T word.
        number: u32,
    },
}

/// Why the machine stands still.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Pause {
    /// M0: until the operator goes on.
    Program,
    /// M1: the same, if the operator's switch for it is on.
    Optional,
    /// M6: until the operator has changed the tool.
    ToolChange,
    /// M2 or M30: the program is over.
    End {
        /// M30: the next start is at the first block.
        rewind: bool,
    },
}
