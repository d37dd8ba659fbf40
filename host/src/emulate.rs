//! `husillo emulate`: simulated controllers behind a port.

pub mod drill;
pub mod grbl;
pub mod microfactory;
pub mod micromill;
pub mod terminal;
