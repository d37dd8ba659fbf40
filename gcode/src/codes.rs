//! The letters and codes of the list, and the dialects that have them.

pub(crate) mod axes;
pub(crate) mod code;
pub(crate) mod dialect;
pub(crate) mod kind;
pub(crate) mod letters;
mod number;
#[cfg(feature = "extended")]
pub(crate) mod printer;
