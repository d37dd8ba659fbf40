//! The public functions of `husillo-probe`.

/// Keeps every function in the program.
pub fn keep() {}
