//! How values are written, for people and for programs: what several commands share.

pub mod json;
