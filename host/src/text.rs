//! How values are written, for people and for programs: what several commands share.

pub mod duration;
pub mod escape;
pub mod json;
pub mod length;
pub mod number;
