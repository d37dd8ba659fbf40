//! Simulated controllers behind a port.

pub mod device;
pub mod step_rows;
#[cfg(unix)]
pub mod terminal;
