//! The last two sectors of the flash of a Raspberry Pi Pico.

use crate::registers::read;

/// The flash in the address space, and its last two sectors, which are kept.
const FLASH: usize = 0x1000_0000;
const KEPT: u32 = (2 << 20) - 2 * SECTOR_BYTES;
/// The smallest part of the flash that can be erased.
pub const SECTOR_BYTES: u32 = 4096;
/// The smallest part of the flash that is written. A page has 256 bytes; the others are written
/// with ones, which changes nothing.
pub const UNIT_BYTES: usize = 32;
const PAGE_BYTES: u32 = 256;

/// Reads a byte that was kept.
pub fn flash_read(at: u32) -> u8 {
    let at = KEPT.wrapping_add(at) as usize;
    let word = read(FLASH + (at & !3));
    word.to_le_bytes().get(at & 3).copied().unwrap_or(0xff)
}

/// Erases a sector. The program stands for some 45 ms, because it runs from the same flash.
pub fn flash_erase(at: u32) {
    critical_section::with(|_| {
        // Safety: interrupts are off, the second core sleeps, and the sector is beyond the program.
        unsafe { rp2040_flash::flash::flash_range_erase(KEPT.wrapping_add(at), SECTOR_BYTES, true) }
    });
}

/// Writes a unit. The program stands for some 0.4 ms.
pub fn flash_write(at: u32, unit: &[u8]) {
    let mut page = [0xff; PAGE_BYTES as usize];
    let begin = (at % PAGE_BYTES) as usize;
    for (byte, written) in page.iter_mut().skip(begin).zip(unit) {
        *byte = *written;
    }
    let at = KEPT.wrapping_add(at - at % PAGE_BYTES);
    critical_section::with(|_| {
        // Safety: as above.
        unsafe { rp2040_flash::flash::flash_range_program(at, &page, true) }
    });
}
