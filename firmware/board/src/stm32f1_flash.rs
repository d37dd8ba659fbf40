//! The last two pages of the flash of an STM32F103 with 64 kB.

use crate::registers::{read, set};

const KEYR: usize = 0x4002_2004;
const SR: usize = 0x4002_200c;
const CR: usize = 0x4002_2010;
const AR: usize = 0x4002_2014;
const KEPT: usize = 0x0800_0000 + 62 * 1024;
const IS_BUSY: u32 = 1;
/// Bits of `CR`.
const PROGRAM: u32 = 1;
const ERASE: u32 = 1 << 1;
const START: u32 = 1 << 6;
const LOCK: u32 = 1 << 7;
/// The smallest part of the flash that can be erased.
pub const SECTOR_BYTES: u32 = 1024;
/// The smallest part of the flash that is written.
pub const UNIT_BYTES: usize = 2;

/// Reads a byte that was kept.
pub fn flash_read(at: u32) -> u8 {
    let at = at as usize;
    let word = read(KEPT + (at & !3));
    word.to_le_bytes().get(at & 3).copied().unwrap_or(0xff)
}

/// Erases a sector. The processor stands for 20 to 40 ms.
pub fn flash_erase(at: u32) {
    unlock();
    set(CR, ERASE);
    set(AR, (KEPT + at as usize) as u32);
    set(CR, ERASE | START);
    lock();
}

/// Writes a unit. The processor stands for 50 us.
pub fn flash_write(at: u32, unit: &[u8]) {
    if let Some(half) = unit.first_chunk() {
        unlock();
        set(CR, PROGRAM);
        let address = (KEPT + at as usize) as *mut u16;
        // Safety: the address is in the sectors that are kept, and even.
        unsafe { core::ptr::write_volatile(address, u16::from_le_bytes(*half)) };
        lock();
    }
}

/// Permits writing, with the keys of the reference manual.
fn unlock() {
    set(KEYR, 0x4567_0123);
    set(KEYR, 0xcdef_89ab);
}

/// Waits for the end of a change, and forbids writing.
fn lock() {
    while read(SR) & IS_BUSY != 0 {}
    set(CR, LOCK);
}
