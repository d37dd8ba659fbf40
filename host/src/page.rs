//! What the reports are made of.

pub mod chart;
pub mod frame;
pub mod report;
