//! From words to a checked block: modal groups, repeated letters, and the words that are given.

pub(crate) mod block;
pub(crate) mod fault;
