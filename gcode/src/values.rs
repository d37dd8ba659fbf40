//! Lengths, exact decimals, and arithmetic wider than 64 bits.

pub(crate) mod decimal;
pub(crate) mod nm;
pub(crate) mod wide;
