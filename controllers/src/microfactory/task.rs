//! Tasks of a microfactory.

use husillo_transports::microfactory::Order;

use super::MicrofactoryConfig;

/// A motor and its direction.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    pub(super) motor: u8,
    pub(super) forward: bool,
}

/// One task.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Task {
    Idle,
    Jog {
        turn: Turn,
        /// Ticks left until the jog must be repeated.
        left_ticks: Option<u32>,
    },
    Steps {
        turn: Turn,
        left: u8,
    },
    /// Homing of an axis begins. The axis moves off its switch or searches for it.
    Look {
        axis: u8,
    },
    /// The axis moves off its switch, which was closed before the search. The number is in motor
    /// steps.
    Leave {
        axis: u8,
        left: u32,
    },
    /// The axis moves towards its switch.
    Home {
        axis: u8,
        left: u32,
    },
    /// The axis backs off its switch.
    BackOff {
        axis: u8,
        left: u16,
        homes: bool,
    },
    /// The tool approaches the work piece in Y, before a figure.
    Approach {
        left: u32,
    },
    /// The move of the figure with this index.
    Figure {
        index: usize,
    },
    /// An emergency stop, until a reset.
    Emergency,
}

impl Task {
    /// Returns the task that a command begins. Returns `None` for commands that begin none.
    pub(super) fn of(command: Order, config: &MicrofactoryConfig) -> Option<Task> {
        Some(match command {
            Order::Home => Task::Look { axis: 0 },
            Order::Jog { motor, forward } => Task::Jog {
                turn: Turn { motor, forward },
                left_ticks: config.dead_man_ticks,
            },
            Order::Steps {
                motor,
                forward,
                count,
            } => Task::Steps {
                turn: Turn { motor, forward },
                left: count,
            },
            Order::Figure => Task::Approach {
                left: config.approach_steps,
            },
            // The other commands begin no task.
            _ => return None,
        })
    }
}
