//! What a drill is doing.

/// One task. Axes are 0 for X, 1 for Y.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Task {
    Idle,
    /// X or Y off its closed switch, then to it.
    Leave {
        axis: u8,
        left: u16,
    },
    Search {
        axis: u8,
        left: u32,
    },
    /// X or Y to this place.
    Go {
        axis: u8,
        to: u16,
    },
    /// At zero, with the switch open: so many steps beyond, to where it closes.
    Beyond {
        axis: u8,
        gone: u16,
    },
    /// Back from there.
    Return {
        axis: u8,
        left: u16,
    },
    /// Z down, so many steps at most; to the sensor where `is_whole`.
    Down {
        left: u16,
        is_whole: bool,
    },
    /// Z up to its sensor.
    Up {
        left: u16,
        next: Next,
    },
    /// Z by hand, positive downwards.
    JogZ {
        left: i16,
    },
    /// The order is done; a rest.
    Settle,
    /// Until a reset.
    Fault,
}

/// What follows when Z is up.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// Home Y and X.
    Home,
    /// The move that waited for it.
    Go { axis: u8, to: u16 },
    /// A drilling has ended.
    Drilled,
}
