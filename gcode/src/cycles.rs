//! Canned cycles and threads as the moves that they stand for.

pub(crate) mod cycle;
pub(crate) mod thread;
