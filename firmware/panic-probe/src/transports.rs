//! The public functions of `husillo-transports`.

/// Keeps every function in the program.
pub fn keep() {}
