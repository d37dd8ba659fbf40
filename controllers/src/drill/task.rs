//! Tasks of a drill.

/// One task. Axes are 0 for X, 1 for Y.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Task {
    Idle,
    /// X or Y moves off its closed switch. The search follows.
    Leave {
        axis: u8,
        left: u16,
    },
    Search {
        axis: u8,
        left: u32,
    },
    /// X or Y has found its switch and moves off until the switch opens. A switch that sticks does
    /// not mark home. Another search follows.
    Open {
        axis: u8,
        left: u16,
    },
    /// X or Y moves to this position.
    Go {
        axis: u8,
        to: u16,
    },
    /// At zero with the switch open: the axis has moved `gone` steps beyond zero to find where the
    /// switch closes.
    Beyond {
        axis: u8,
        gone: u16,
    },
    /// The axis returns from beyond zero.
    Return {
        axis: u8,
        left: u16,
    },
    /// Z moves down by at most `left` steps. If `is_whole`, it moves to the sensor.
    Down {
        left: u16,
        is_whole: bool,
    },
    /// Z moves up to its sensor.
    Up {
        left: u16,
        next: Next,
    },
    /// Z moves down until its closed upper sensor opens. A sensor that sticks does not mark home. Z
    /// then moves up to the sensor again.
    OpenUp {
        left: u16,
        next: Next,
    },
    /// A jog of Z, positive downwards.
    JogZ {
        left: i16,
    },
    /// The order is done, and the axes rest.
    Settle,
    /// A fault, until a reset.
    Fault,
}

/// The task that follows when Z is up.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// Home Y and X.
    Home,
    /// The move that waited for Z.
    Go { axis: u8, to: u16 },
    /// The end of a hole.
    Drilled,
    /// Nothing: the lease has expired.
    Rest,
}

impl Next {
    /// Returns what follows if the lease expires. A hole that is already drilled counts. All other
    /// work ends.
    pub(super) const fn without_host(self) -> Self {
        match self {
            Self::Drilled => self,
            Self::Home | Self::Go { .. } | Self::Rest => Self::Rest,
        }
    }
}
