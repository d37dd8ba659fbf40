//! The last two pages of the flash of an nRF51822.

use crate::registers::{read, set};

const READY: usize = 0x4001_e400;
const CONFIG: usize = 0x4001_e504;
const ERASEPAGE: usize = 0x4001_e508;
/// The last two pages of 256 kB.
const KEPT: usize = 0x3_f800;
/// The smallest part of the flash that can be erased.
pub const SECTOR_BYTES: u32 = 1024;
/// The smallest part of the flash that can be written.
pub const UNIT_BYTES: usize = 4;

/// Reads a byte that was kept.
pub fn flash_read(at: u32) -> u8 {
    let at = at as usize;
    let word = read(KEPT + (at & !3));
    word.to_le_bytes().get(at & 3).copied().unwrap_or(0xff)
}

/// Erases a sector. The processor stands for 21 ms.
pub fn flash_erase(at: u32) {
    set(CONFIG, 2);
    set(ERASEPAGE, (KEPT + at as usize) as u32);
    while read(READY) == 0 {}
    set(CONFIG, 0);
}

/// Writes a unit.
pub fn flash_write(at: u32, unit: &[u8]) {
    if let Some(word) = unit.first_chunk() {
        set(CONFIG, 1);
        set(KEPT + at as usize, u32::from_le_bytes(*word));
        while read(READY) == 0 {}
        set(CONFIG, 0);
    }
}
