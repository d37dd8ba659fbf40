//! Formats of values.

pub mod json;
