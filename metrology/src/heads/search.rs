//! Events that end a move before its goal.

use husillo_transports::nmc::{Homing, Reply, Status};

/// What ends a way before its goal.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// Any of these, on each of the axes that search.
    pub events: Homing,
    /// How a module then stops its axis.
    pub stop: Homing,
    /// The axis, by its place in the machine file, that searches alone.
    pub only: Option<usize>,
}

impl Search {
    pub fn is_for(self, index: usize) -> bool {
        self.only.is_none_or(|only| only == index)
    }

    /// Whether it is the contact that is searched.
    pub fn is_touch(self) -> bool {
        self.events == Homing::LIMIT_1
    }

    /// Whether a module that searched has found it.
    pub fn is_found(self, reply: &Reply) -> bool {
        !searches(reply)
    }

    /// The axes that search, and whether each has found it.
    pub fn found_by(self, replies: &[Reply]) -> Vec<(usize, bool)> {
        let all = replies.iter().enumerate();
        all.filter(|(index, _)| self.is_for(*index))
            .map(|(index, reply)| (index, self.is_found(reply)))
            .collect()
    }
}

/// Whether it waits for an event.
pub fn searches(reply: &Reply) -> bool {
    reply.status.contains(Status::HOME_IN_PROGRESS)
}
