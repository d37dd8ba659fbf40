//! Simulated controllers behind a port.

#[cfg(unix)]
pub mod terminal;
