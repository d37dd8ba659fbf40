//! What needs more of a program than the line at hand.

#[cfg(feature = "extended")]
pub mod contour;
pub(crate) mod format;
pub(crate) mod line;
#[cfg(feature = "parameters")]
pub mod parameters;
