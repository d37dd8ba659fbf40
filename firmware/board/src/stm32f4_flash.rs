//! The sectors 1 and 2 of the flash of an STM32F4. The program is in sector 0, which has the
//! vectors, and from sector 3 on.

use crate::registers::{read, set};

const KEYR: usize = 0x4002_3c04;
const SR: usize = 0x4002_3c0c;
const CR: usize = 0x4002_3c10;
const KEPT: usize = 0x0800_4000;
const FIRST_SECTOR: u32 = 1;
const IS_BUSY: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;
/// Bits of `CR`: program, erase a sector, start; the size of an access is a word.
const PROGRAM: u32 = 1;
const ERASE: u32 = 1 << 1;
const START: u32 = 1 << 16;
const WORDS: u32 = 0b10 << 8;
/// The smallest part of the flash that can be erased.
pub const SECTOR_BYTES: u32 = 16 * 1024;
/// The smallest part of the flash that is written.
pub const UNIT_BYTES: usize = 4;

/// Reads a byte that was kept.
pub fn flash_read(at: u32) -> u8 {
    let at = at as usize;
    let word = read(KEPT + (at & !3));
    word.to_le_bytes().get(at & 3).copied().unwrap_or(0xff)
}

/// Erases a sector. The processor stands for 250 to 500 ms.
pub fn flash_erase(at: u32) {
    let sector = FIRST_SECTOR + at / SECTOR_BYTES;
    unlock();
    set(CR, WORDS | ERASE | sector << 3);
    set(CR, WORDS | ERASE | sector << 3 | START);
    lock();
}

/// Writes a unit. The processor stands for 16 us.
pub fn flash_write(at: u32, unit: &[u8]) {
    if let Some(word) = unit.first_chunk() {
        unlock();
        set(CR, WORDS | PROGRAM);
        set(KEPT + at as usize, u32::from_le_bytes(*word));
        lock();
    }
}

/// Permits writing, with the keys of the reference manuals.
fn unlock() {
    set(KEYR, 0x4567_0123);
    set(KEYR, 0xcdef_89ab);
}

/// Waits for the end of a change, and forbids writing.
fn lock() {
    while read(SR) & IS_BUSY != 0 {}
    set(CR, LOCK);
    flush();
}

/// Empties the data cache, which may have the old content.
fn flush() {
    const ACR: usize = 0x4002_3c00;
    const DATA_CACHE: u32 = 1 << 10;
    const RESET: u32 = 1 << 12;
    let acr = read(ACR);
    set(ACR, acr & !DATA_CACHE);
    set(ACR, acr & !DATA_CACHE | RESET);
    set(ACR, acr & !RESET);
}
