//! A stand-in for flash on boards of QEMU that have none. It is lost without power.

use crate::Shared;

/// The smallest part that can be erased.
pub const SECTOR_BYTES: u32 = 1024;
/// The smallest part that can be written.
pub const UNIT_BYTES: usize = 1;

/// Inverted, so that the erased state is zero and takes no flash.
static INVERTED: Shared<[u8; 2 * SECTOR_BYTES as usize]> =
    Shared::new([0; 2 * SECTOR_BYTES as usize]);

/// Reads a byte.
pub fn flash_read(at: u32) -> u8 {
    INVERTED.with(|area| area.get(at as usize).map_or(0xff, |byte| !byte))
}

/// Erases a sector.
pub fn flash_erase(at: u32) {
    INVERTED.with(|area| {
        let sector = area.iter_mut().skip(at as usize);
        sector.take(SECTOR_BYTES as usize).for_each(|byte| *byte = 0);
    });
}

/// Writes a unit: bits of 1 become 0.
pub fn flash_write(at: u32, unit: &[u8]) {
    INVERTED.with(|area| {
        for (kept, byte) in area.iter_mut().skip(at as usize).zip(unit) {
            *kept |= !byte;
        }
    });
}
