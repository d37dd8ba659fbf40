//! Formats of values.

pub mod json;
pub mod name;
pub mod shown;
