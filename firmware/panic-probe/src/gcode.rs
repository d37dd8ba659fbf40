//! The public functions of `husillo-gcode`.

use core::hint::black_box;

/// Keeps every function in the program.
pub fn keep() {
    let _: [*const (); 0] = black_box([]);
}
