#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod backlash;
pub mod board;
pub mod chart;
pub mod frame;
pub mod methods;
pub mod motion;
pub mod operation;
pub mod originals;
pub mod routine;
pub mod run;
pub mod text;
pub mod tuning;
