//! The public functions of `husillo-pid`.

/// Keeps every function in the program.
pub fn keep() {}
