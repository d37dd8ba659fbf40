//! The last two sectors of the flash of a Raspberry Pi Pico 2.

use crate::registers::read;

/// The flash in the address space, and its last two sectors, which are kept.
const FLASH: usize = 0x1000_0000;
const KEPT: u32 = (4 << 20) - 2 * SECTOR_BYTES;
/// The smallest part of the flash that can be erased.
pub const SECTOR_BYTES: u32 = 4096;
/// The smallest part of the flash that is written. A page has 256 bytes; the others are written
/// with ones, which changes nothing.
pub const UNIT_BYTES: usize = 32;
const PAGE_BYTES: u32 = 256;
/// Operations of the boot ROM on addresses of the flash itself, from secure code (RP2350
/// datasheet, 5.5.8.2).
const ERASE: u32 = 1 << 8;
const PROGRAM: u32 = 1 << 16 | 1 << 8;

/// The boot ROM has here the address of the function that finds the others by two letters (RP2350
/// datasheet, 5.4.1).
const LOOKUP: usize = 0x16;
const FLASH_OP: u32 = u16::from_le_bytes(*b"FO") as u32;
/// Functions for the Arm processors in secure state.
const ARM_SECURE: u32 = 0x04;

type Lookup = unsafe extern "C" fn(code: u32, mask: u32) -> *const ();
type FlashOp = unsafe extern "C" fn(flags: u32, address: u32, bytes: u32, buffer: *mut u8) -> i32;

/// Has the boot ROM change the flash. If it fails, the flash is unchanged, which the reader
/// detects.
fn change(operation: u32, address: u32, bytes: u32, buffer: *mut u8) {
    critical_section::with(|_| {
        // Safety: the addresses are those of the boot ROM, which works while the flash is not
        // readable. Interrupts are off, the second core sleeps, and the sectors are beyond the
        // program.
        unsafe {
            let lookup = (LOOKUP as *const u16).read_volatile();
            let lookup: Lookup = core::mem::transmute(usize::from(lookup));
            let flash_op = lookup(FLASH_OP, ARM_SECURE);
            if !flash_op.is_null() {
                let flash_op: FlashOp = core::mem::transmute(flash_op);
                flash_op(operation, address, bytes, buffer);
            }
        }
    });
}

/// Reads a byte that was kept.
pub fn flash_read(at: u32) -> u8 {
    let at = KEPT.wrapping_add(at) as usize;
    let word = read(FLASH + (at & !3));
    word.to_le_bytes().get(at & 3).copied().unwrap_or(0xff)
}

/// Erases a sector. The program stands for some 45 ms, because it runs from the same flash.
pub fn flash_erase(at: u32) {
    change(
        ERASE,
        KEPT.wrapping_add(at),
        SECTOR_BYTES,
        core::ptr::null_mut(),
    );
}

/// Writes a unit. The program stands for some 0.4 ms.
pub fn flash_write(at: u32, unit: &[u8]) {
    let mut page = [0xff; PAGE_BYTES as usize];
    let begin = (at % PAGE_BYTES) as usize;
    for (byte, written) in page.iter_mut().skip(begin).zip(unit) {
        *byte = *written;
    }
    let at = KEPT.wrapping_add(at - at % PAGE_BYTES);
    change(PROGRAM, at, PAGE_BYTES, page.as_mut_ptr());
}
