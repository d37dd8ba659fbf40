//! Formats values for people and for programs; shared by several commands.

pub mod duration;
pub mod escape;
pub mod json;
pub mod length;
pub mod number;
