//! What needs more of a program than the line at hand: the one entry for parameters, expressions
//! and O-words, for contours, and for programs written back.

#[cfg(feature = "extended")]
pub mod contour;
pub(crate) mod format;
pub(crate) mod line;
pub mod parameters;
