//! What a cell sees and says.

use super::CELL_MOTORS;
use crate::StepEvent;

/// The switches.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct CellInputs {
    /// Home switches of X, Y and Z: closed.
    pub home: [bool; 3],
    /// The tool touches the work piece.
    pub contact: bool,
}

impl CellInputs {
    /// Whether the home switch of an axis is closed; the spindle has none.
    pub(super) fn is_home(&self, axis: u8) -> bool {
        self.home.get(usize::from(axis)) == Some(&true)
    }
}

/// What happens next.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum CellEvent {
    /// Wait, then step.
    Step(StepEvent<CELL_MOTORS>),
    /// Wait.
    Dwell {
        /// Timer ticks.
        wait_ticks: u32,
    },
    /// Current of all motors on, or off.
    Enable(bool),
    /// RESET of all sequencers low for so long, then high.
    Reset {
        /// Timer ticks.
        ticks: u32,
    },
    /// Something to tell.
    Report(CellReport),
    /// Nothing to do until a command comes.
    Idle,
}

/// What a cell tells.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum CellReport {
    /// All axes stand off their switches, at zero.
    Homed,
    /// Counted steps, a figure or going back off a switch ended.
    Done,
    /// Stopped by command.
    Stopped,
    /// A jog was not said again in time.
    DeadMan,
    /// The tool touches the work piece: the figure begins.
    Contact,
    /// The approach ended without contact; the figure was not cut.
    NoContact,
    /// A home switch closed where none was looked for: the axis goes back off it.
    Switch {
        /// 0 to 2.
        axis: u8,
    },
    /// No home switch closed on the longest way.
    NoSwitch {
        /// 0 to 2.
        axis: u8,
    },
    /// A home switch is closed still after the way back off it.
    StillClosed {
        /// 0 to 2.
        axis: u8,
    },
    /// Emergency stop: until a reset nothing moves.
    Emergency,
}
