//! The event stream of the machine.

use husillo_gcode::{HeatWait, Heater, Input, SpindleDirection, WaitFor};

use crate::StepEvent;

/// One entry of the stream, in order of execution.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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
    /// Wait for the spindle to turn, then step: G33, G33.1, G76, G95.
    Follow(FollowEvent<N>),
    /// Switch an output, exactly between the preceding and the following move.
    Output(Output),
    /// Stand still until the operator continues; at the end of the program nothing follows.
    Pause(Pause),
    /// M66: read an input, or wait for it for a limited time. No event follows until
    /// [`Machine::answer`](crate::Machine::answer).
    Await {
        /// The input.
        input: Input,
        /// The condition.
        until: WaitFor,
        /// Longest time in microseconds; 0 does not wait.
        timeout_micros: u64,
    },
    /// A probing move has ended; [`Machine::probed`](crate::Machine::probed) has the position.
    Probed {
        /// Whether the contact changed.
        is_touched: bool,
    },
    /// The program cannot continue: all lines and events after this one are dropped, and spindle
    /// and coolant are off.
    Alarm(Alarm),
}

/// Reason why a program cannot continue.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Alarm {
    /// The probe was in contact before the move toward the work piece, or without contact before a
    /// move away from it.
    ContactAtStart,
    /// G38.2, G38.4: the contact did not change.
    NoContact,
    /// G33.1: the spindle turned further before its reversal than it may
    /// ([`Equipment::tapping_overrun_turns`](crate::Equipment::tapping_overrun_turns)).
    SpindleNotReversed,
}

impl core::fmt::Display for Alarm {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Alarm::ContactAtStart => "the contact of the probe had changed before the move",
            Alarm::NoContact => "the contact of the probe did not change in the whole move",
            Alarm::SpindleNotReversed => "the spindle did not reverse within the turns it has",
        })
    }
}

/// Let the spindle turn by `wait_counts_q16`, then step every axis by its delta.
///
/// Counts add up from the first event of the move, or from the index before it. Events that fall
/// behind (the spindle is too fast, or a take-up intervenes) catch up.
/// [`husillo_planner::Follower`] times these events between two counts.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FollowEvent<const N: usize> {
    /// Encoder counts since the previous event, times 2^16; at most 2^31.
    pub wait_counts_q16: u32,
    /// Motor step of every axis: -1, 0 or +1. All are 0 where the wait does not fit in one event.
    pub delta: [i8; N],
    /// The sign of the wait: the spindle turns against the direction in which the thread began, as
    /// a tap comes out of its hole (G33.1). The sum of all waits with their signs is the count at
    /// which the step is due.
    pub turns_back: bool,
}

/// An output of the machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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
    /// A digital output (M62 to M65).
    Digital {
        /// Its number.
        number: u8,
        /// Its level.
        is_on: bool,
    },
    /// An analogue output (M67, M68).
    Analog {
        /// Its number.
        number: u8,
        /// Millionths of its unit.
        micro: i64,
    },
    /// The spindle stops at an angle (M19).
    Orient {
        /// Millionths of a degree, below 360 degrees.
        micro_degrees: u64,
        /// Direction of rotation: 0 the shorter one, 1 clockwise, 2 counter-clockwise.
        way: u8,
    },
    /// A heater of a printer gets a target (M104, M109, M140, M190). Where `wait` says so, the next
    /// event follows when the target is reached.
    Heater {
        /// The heater.
        heater: Heater,
        /// The target in thousandths of a degree Celsius; 0 is off.
        milli_celsius: u32,
        /// Whether the stream waits for it.
        wait: HeatWait,
    },
    /// A fan of a printer (M106, M107).
    Fan {
        /// Its number.
        number: u8,
        /// Its speed in thousandths of the highest.
        per_mille: u16,
    },
    /// The motors lose their current (M84), until the next step.
    MotorsOff,
    /// Tool in the spindle from here on.
    Tool {
        /// Number of the T word.
        number: u32,
    },
}

/// Reason for standing still.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Pause {
    /// M0: until the operator continues.
    Program,
    /// M1: as M0, if the operator has enabled optional stops.
    Optional,
    /// M60: until the operator has changed the pallet.
    Pallet,
    /// M6: until the operator has changed the tool.
    ToolChange,
    /// M2 or M30: end of the program.
    End {
        /// M30: the next start is at the first block.
        rewind: bool,
    },
}
