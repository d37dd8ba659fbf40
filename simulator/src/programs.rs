//! Reads, checks, lists and rewrites programs, and feeds them to a machine.

pub mod blocks;
pub mod check;
pub mod commands;
pub mod explain;
pub mod explain_flow;
pub mod explain_foreign;
pub mod feeder;
pub mod format;
pub mod language;
pub mod library;
pub mod mirror;
pub mod origins;
pub mod program;
pub mod reading;
pub mod reversals;
pub mod setup;
pub mod source;
pub mod spindle_time;
pub mod steps;
pub mod translate;
pub mod watch;
pub mod zero;
