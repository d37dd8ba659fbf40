//! The public functions of `husillo-encoder`.

/// Keeps every function in the program.
pub fn keep() {}
