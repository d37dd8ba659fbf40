//! What carries bytes to a controller, real or simulated.

pub mod serial_line;
pub mod wire;
