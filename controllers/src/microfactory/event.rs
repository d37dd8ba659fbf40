//! What a machine sees and says.

use husillo_transports::microfactory::Report;

use super::MICROFACTORY_MOTORS;
use husillo_machine::StepEvent;

/// The switches.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct MicrofactoryInputs {
    /// Home switches of X, Y and Z: closed.
    pub home: [bool; 3],
    /// The tool touches the work piece.
    pub contact: bool,
}

impl MicrofactoryInputs {
    /// Whether the home switch of an axis is closed; the spindle has none.
    pub(super) fn is_home(&self, axis: u8) -> bool {
        self.home.get(usize::from(axis)) == Some(&true)
    }
}

/// What happens next.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum MicrofactoryEvent {
    /// Wait, then step.
    Step(StepEvent<MICROFACTORY_MOTORS>),
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
    Report(Report),
    /// Nothing to do until a command comes.
    Idle,
}
