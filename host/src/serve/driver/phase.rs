//! The state of a program, of all families.

/// The state of a loaded program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// It was not started.
    #[default]
    Loaded,
    /// Its lines are sent.
    Running,
    /// It waits before its next line for the operator.
    Waiting,
    /// The machine brakes.
    Stopping,
    /// All lines are made.
    Done,
    /// The operator has stopped it.
    Stopped,
    /// A line was refused, or the controller was lost.
    Failed,
}

impl Phase {
    /// Whether parts are made, or will be.
    pub const fn is_active(self) -> bool {
        matches!(self, Self::Running | Self::Waiting | Self::Stopping)
    }

    /// Its name in the state of the machine.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Loaded => "loaded",
            Self::Running => "running",
            Self::Waiting => "waiting",
            Self::Stopping => "stopping",
            Self::Done => "done",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
        }
    }
}
