//! The letters and codes of the list, and which dialect has which.

pub(crate) mod code;
pub(crate) mod dialect;
pub(crate) mod kind;
pub(crate) mod letters;
mod number;
