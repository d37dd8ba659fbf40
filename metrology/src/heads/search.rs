//! Events that end a move before its goal.

use husillo_transports::nmc::{Homing, Reply, Status};

/// A search: the events that end a move before its goal.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// Any of these events ends the move of a searching axis.
    pub events: Homing,
    /// How a module stops its axis after the event.
    pub stop: Homing,
    /// Index in the machine file of the only axis that searches. `None`: all axes search.
    pub only: Option<usize>,
}

impl Search {
    pub fn is_for(self, index: usize) -> bool {
        self.only.is_none_or(|only| only == index)
    }

    /// Whether the search is for the contact of the probe. A single axis searches its index or its
    /// end switch.
    pub fn is_touch(self) -> bool {
        self.only.is_none()
    }

    /// Whether a searching module has found the event.
    pub fn is_found(self, reply: &Reply) -> bool {
        !searches(reply)
    }

    /// The searching axes, and whether each has found the event.
    pub fn found_by(self, replies: &[Reply]) -> Vec<(usize, bool)> {
        let all = replies.iter().enumerate();
        all.filter(|(index, _)| self.is_for(*index))
            .map(|(index, reply)| (index, self.is_found(reply)))
            .collect()
    }
}

/// Whether the module waits for an event.
pub fn searches(reply: &Reply) -> bool {
    reply.status.contains(Status::HOME_IN_PROGRESS)
}
