//! Lengths, exact decimals, and arithmetic wider than 64 bits.

#[cfg(any(feature = "extended", feature = "program"))]
pub(crate) mod circle;
pub(crate) mod decimal;
pub(crate) mod nm;
pub(crate) mod wide;
