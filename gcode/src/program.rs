//! Functions that need more of a program than the current line: parameters, expressions and
//! O-words, contours, and rewritten programs.

#[cfg(feature = "extended")]
pub mod contour;
pub(crate) mod format;
pub(crate) mod line;
pub mod parameters;
#[cfg(feature = "extended")]
pub(crate) mod translate;
