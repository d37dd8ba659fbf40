//! Programs: read, checked, listed, written back, simulated.

pub mod blocks;
pub mod check;
pub mod commands;
pub mod deviation;
pub mod explain;
pub mod explain_flow;
pub mod feeder;
pub mod format;
pub mod mirror;
pub mod program;
pub mod reversals;
pub mod run;
pub mod setup;
pub mod source;
pub mod speed;
pub mod spindle_time;
pub mod steps;
pub mod symmetry;
pub mod zero;
