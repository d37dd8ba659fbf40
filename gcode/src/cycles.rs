//! Canned cycles and threads, expanded into moves.

pub(crate) mod cycle;
pub(crate) mod thread;
