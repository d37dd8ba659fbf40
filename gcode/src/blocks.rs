//! From words to a checked block: modal groups, repeats, which words are given.

pub(crate) mod block;
pub(crate) mod fault;
