#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod calls;
pub mod diagnostics;
pub mod holes;
pub mod input;
pub mod job;
pub mod machines;
pub mod programs;
pub mod scene;
pub mod simulation;
pub mod text;
