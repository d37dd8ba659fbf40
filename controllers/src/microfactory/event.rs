//! Inputs and events of a microfactory.

use husillo_transports::microfactory::Report;

use super::MICROFACTORY_MOTORS;
use husillo_machine::StepEvent;

/// The switches and the contact.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct MicrofactoryInputs {
    /// Whether the home switches of X, Y and Z are closed.
    pub home: [bool; 3],
    /// Whether the tool touches the work piece.
    pub contact: bool,
}

impl MicrofactoryInputs {
    /// Whether the home switch of an axis is closed. The spindle has none.
    pub(super) fn is_home(&self, axis: u8) -> bool {
        self.home.get(usize::from(axis)) == Some(&true)
    }
}

/// The next event of a machine.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum MicrofactoryEvent {
    /// Wait, then step.
    Step(StepEvent<MICROFACTORY_MOTORS>),
    /// Wait.
    Dwell {
        /// Timer ticks.
        wait_ticks: u32,
    },
    /// Switch the current of all motors on or off.
    Enable(bool),
    /// Set RESET of all sequencers low for `ticks`, then high.
    Reset {
        /// Timer ticks.
        ticks: u32,
    },
    /// A report.
    Report(Report),
    /// Nothing to do until a command arrives.
    Idle,
}
