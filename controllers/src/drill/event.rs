//! Inputs and events of a drill.

use husillo_machine::StepEvent;

/// The switches and sensors.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct DrillInputs {
    /// Whether the home switches of X and Y are closed.
    pub home: [bool; 2],
    /// The upper sensor sees the spindle: Z is home.
    pub is_up: bool,
    /// The lower sensor sees the spindle.
    pub is_down: bool,
}

/// The next event of a drill.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum DrillEvent {
    /// Wait, then step X, Y or Z; Z is positive downwards.
    Step(StepEvent<3>),
    /// Wait.
    Dwell {
        /// Timer ticks.
        wait_ticks: u32,
    },
    /// Switch the spindle motor on or off.
    Spindle(bool),
    /// A report.
    Report(DrillReport),
    /// Nothing to do until a byte arrives.
    Idle,
}

/// A report for the panel of a drill, in addition to its link.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum DrillReport {
    /// All axes are home.
    Homed,
    /// A hole is drilled at this position, in steps.
    Drilled {
        /// Steps of X and Y from zero.
        at: [u16; 2],
    },
    /// The present position was stored as a hole of the program.
    Taught {
        /// Steps of X and Y from zero.
        at: [u16; 2],
    },
    /// The host was silent for longer than its lease, so the work ends.
    Expired,
    /// A fault has occurred. The spindle is off, and nothing moves or answers until a reset.
    Fault(DrillFault),
}

/// The reason why a drill is stopped until a reset.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum DrillFault {
    /// No home switch closed within the longest search.
    NoSwitch {
        /// 0 for X, 1 for Y.
        axis: u8,
    },
    /// A home switch is still closed after the move off it.
    StillClosed {
        /// 0 for X, 1 for Y.
        axis: u8,
    },
    /// The upper sensor did not see the spindle within the longest stroke.
    NotUp,
    /// The lower sensor did not see the spindle within the longest stroke.
    NotDown,
    /// The upper sensor is closed although Z is far below it, or does not open when Z moves off it.
    /// The sensor sticks, or Z does not move.
    UpClosed,
    /// The lower sensor is closed although Z is above it.
    DownClosed,
    /// Both sensors of Z are closed, and the position of Z is not known.
    BothClosed,
    /// A home switch closed too far from zero, or did not close at zero, because steps were lost.
    LostSteps {
        /// 0 for X, 1 for Y.
        axis: u8,
    },
    /// A record is beyond the travel.
    OffTable {
        /// 0 for X, 1 for Y.
        axis: u8,
    },
}
