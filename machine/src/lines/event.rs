//! The event stream of the machine.

use husillo_gcode::SpindleDirection;

use crate::StepEvent;

/// One entry of the stream, in order of execution.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Event<const N: usize> {
    /// Wait, then step.
    Step(StepEvent<N>),
    /// Wait without a step, for at most [`MAX_WAIT_TICKS`](crate::MAX_WAIT_TICKS).
    Dwell {
        /// Timer ticks to wait.
        wait_ticks: u32,
    },
    /// Wait for the index pulse of the spindle encoder. The counts of the following events begin
    /// there.
    Index,
    /// Wait for the spindle to turn, then step: G33, G76, G95.
    Follow(FollowEvent<N>),
    /// Switch an output, exactly between the preceding and the following move.
    Output(Output),
    /// Stand still until the operator continues (for ever at the end of the program).
    Pause(Pause),
}

/// Let the spindle turn by `wait_counts_q16`, then step every axis by its delta.
///
/// Counts add up from the first event of the move, or from the index before it. Events that fall
/// behind (the spindle is too fast, or a take-up intervenes) catch up.
/// [`husillo_planner::Follower`] times these events between two counts.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct FollowEvent<const N: usize> {
    /// Encoder counts since the previous event, times 2^16; at most 2^31.
    pub wait_counts_q16: u32,
    /// Motor step of every axis: -1, 0 or +1. All are 0 where the wait does not fit in one event.
    pub delta: [i8; N],
}

/// An output of the machine.
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
        /// Mist coolant (M7).
        mist: bool,
        /// Flood coolant (M8).
        flood: bool,
    },
    /// One drilling cycle: down to the lower end switch and up to the upper one, before any other
    /// motion.
    Drill,
    /// Tool in the spindle from here on.
    Tool {
        /// Number of the T word.
        number: u32,
    },
}

/// Reason for standing still.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Pause {
    /// M0: until the operator continues.
    Program,
    /// M1: as M0, if the operator has enabled optional stops.
    Optional,
    /// M6: until the operator has changed the tool.
    ToolChange,
    /// M2 or M30: end of the program.
    End {
        /// M30: the next start is at the first block.
        rewind: bool,
    },
}
