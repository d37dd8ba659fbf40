//! What a machine is doing.

use husillo_transports::microfactory::Order;

use super::MicrofactoryConfig;

/// A motor and its direction.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Way {
    pub(super) motor: u8,
    pub(super) forward: bool,
}

/// One task.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Task {
    Idle,
    Jog {
        way: Way,
        /// Until it must be said again.
        left_ticks: Option<u32>,
    },
    Steps {
        way: Way,
        left: u8,
    },
    /// Homing of an axis begins, one way or the other.
    Look {
        axis: u8,
    },
    /// Off the switch of an axis that was closed before it was searched: motor steps.
    Leave {
        axis: u8,
        left: u32,
    },
    /// Towards the switch of an axis.
    Home {
        axis: u8,
        left: u32,
    },
    /// Off the switch of an axis.
    BackOff {
        axis: u8,
        left: u16,
        homes: bool,
    },
    /// In Y to the work piece, before a figure.
    Approach {
        left: u32,
    },
    /// The move of the figure with this index.
    Figure {
        index: usize,
    },
    /// For good.
    Emergency,
}

impl Task {
    /// The task that a command begins; `None` for commands that begin none.
    pub(super) fn of(command: Order, config: &MicrofactoryConfig) -> Option<Task> {
        Some(match command {
            Order::Home => Task::Look { axis: 0 },
            Order::Jog { motor, forward } => Task::Jog {
                way: Way { motor, forward },
                left_ticks: config.dead_man_ticks,
            },
            Order::Steps {
                motor,
                forward,
                count,
            } => Task::Steps {
                way: Way { motor, forward },
                left: count,
            },
            Order::Figure => Task::Approach {
                left: config.approach_steps,
            },
            // The others begin nothing.
            _ => return None,
        })
    }
}
