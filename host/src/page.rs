//! The parts of the reports.

pub mod chart;
pub mod frame;
pub mod report;
