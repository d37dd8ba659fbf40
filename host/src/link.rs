//! What carries bytes to a controller, real or simulated.

pub mod emulation;
pub mod port;
pub mod serial_line;
pub mod stop;
pub mod wire;
