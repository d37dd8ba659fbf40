//! Access to the registers of the chip.

use core::ptr::{read_volatile, write_volatile};

/// Reads a register.
pub fn read(address: usize) -> u32 {
    // Safety: a board's file names only registers that its chip has.
    unsafe { read_volatile(address as *const u32) }
}

/// Writes a register.
pub fn set(address: usize, value: u32) {
    // Safety: as above.
    unsafe { write_volatile(address as *mut u32, value) }
}

/// A clock that has not started after this many readings does not start.
const READINGS: u32 = 100_000;

/// Waits until a bit of a register is high, as that of a clock that starts. Returns whether it is.
pub fn is_ready(register: usize, bit: u32) -> bool {
    (0..READINGS).any(|_| read(register) >> bit & 1 != 0)
}
