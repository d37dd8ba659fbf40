//! What a drill sees and says.

use husillo_machine::StepEvent;

/// The switches.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct DrillInputs {
    /// Home switches of X and Y: closed.
    pub home: [bool; 2],
    /// The upper sensor sees the spindle: Z is home.
    pub is_up: bool,
    /// The lower sensor sees it.
    pub is_down: bool,
}

/// What happens next.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum DrillEvent {
    /// Wait, then step X, Y or Z; Z is positive downwards.
    Step(StepEvent<3>),
    /// Wait.
    Dwell {
        /// Timer ticks.
        wait_ticks: u32,
    },
    /// The spindle's motor on, or off.
    Spindle(bool),
    /// Something to tell.
    Report(DrillReport),
    /// Nothing to do until a byte comes.
    Idle,
}

/// What a drill tells on its panel, beside its link.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum DrillReport {
    /// All axes are home.
    Homed,
    /// A drilling is done at this place, in steps.
    Drilled {
        /// Steps of X and Y from zero.
        at: [u16; 2],
    },
    /// The present place was kept as a hole of the program.
    Taught {
        /// Steps of X and Y from zero.
        at: [u16; 2],
    },
    /// A fault: spindle off, and nothing moves or answers until a reset.
    Fault(DrillFault),
}

/// Why a drill stands until a reset.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum DrillFault {
    /// No home switch on the longest way.
    NoSwitch {
        /// 0 for X, 1 for Y.
        axis: u8,
    },
    /// A home switch is closed still after the way off it.
    StillClosed {
        /// 0 for X, 1 for Y.
        axis: u8,
    },
    /// The upper sensor did not see the spindle on the longest way.
    NotUp,
    /// The lower one.
    NotDown,
    /// A home switch closed too far from zero, or did not at zero: steps were lost.
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
