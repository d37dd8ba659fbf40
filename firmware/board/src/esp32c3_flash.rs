//! The last two sectors of a flash of 4 MB, by functions of the boot ROM of an ESP32-C3.
//!
//! Interrupts are off for the time of a function, which is longest for an erasure: some 45 ms.

/// What the boot ROM must know of the flash.
const FLASH_BYTES: u32 = 4 << 20;
const BLOCK_BYTES: u32 = 64 << 10;
const PAGE_BYTES: u32 = 256;
const STATUS_MASK: u32 = 0xffff;
/// The place of the two sectors, which are kept.
const KEPT: u32 = FLASH_BYTES - 2 * SECTOR_BYTES;
/// The smallest part of the flash that can be erased.
pub const SECTOR_BYTES: u32 = 4096;
/// The smallest part of the flash that is written.
pub const UNIT_BYTES: usize = 32;
/// Here the boot ROM has the address of its data on the flash. The first word of these is the
/// identity of the flash.
const ROM_DATA: usize = 0x3fcd_fff0;

// The file of the board has the addresses of these functions of the boot ROM. They return 0 if they
// have succeeded.
unsafe extern "C" {
    fn esp_rom_spiflash_config_param(
        identity: u32,
        bytes: u32,
        block_bytes: u32,
        sector_bytes: u32,
        page_bytes: u32,
        status_mask: u32,
    ) -> i32;
    fn esp_rom_spiflash_unlock() -> i32;
    fn esp_rom_spiflash_read(address: u32, words: *mut u32, bytes: i32) -> i32;
    fn esp_rom_spiflash_erase_sector(sector: u32) -> i32;
    fn esp_rom_spiflash_write(address: u32, words: *const u32, bytes: i32) -> i32;
}

/// Calls a function of the boot ROM. If it fails, the flash is unchanged or not read, which the
/// reader detects.
fn with_rom(call: impl FnOnce()) {
    critical_section::with(|_| {
        // Safety: the program is in RAM, so that nothing else uses the flash; interrupts are off.
        unsafe {
            let data = (ROM_DATA as *const *const u32).read_volatile();
            esp_rom_spiflash_config_param(
                data.read_volatile(),
                FLASH_BYTES,
                BLOCK_BYTES,
                SECTOR_BYTES,
                PAGE_BYTES,
                STATUS_MASK,
            );
        }
        call();
    });
}

/// Reads a byte that was kept.
pub fn flash_read(at: u32) -> u8 {
    let mut word = [u32::MAX];
    let address = KEPT.wrapping_add(at & !3);
    // Safety: there is room for the four bytes.
    with_rom(|| unsafe {
        esp_rom_spiflash_read(address, word.as_mut_ptr(), 4);
    });
    let [word] = word;
    word.to_le_bytes().get(at as usize & 3).copied().unwrap_or(0xff)
}

/// Erases a sector.
pub fn flash_erase(at: u32) {
    let sector = KEPT.wrapping_add(at) / SECTOR_BYTES;
    // Safety: the program is at the beginning of the flash, and this sector at its end.
    with_rom(|| unsafe {
        esp_rom_spiflash_unlock();
        esp_rom_spiflash_erase_sector(sector);
    });
}

/// Writes a unit.
pub fn flash_write(at: u32, unit: &[u8]) {
    let mut words = [u32::MAX; UNIT_BYTES / 4];
    for (word, bytes) in words.iter_mut().zip(unit.as_chunks().0) {
        *word = u32::from_le_bytes(*bytes);
    }
    // Safety: as above; a unit is within one page, and there are as many words.
    with_rom(|| unsafe {
        esp_rom_spiflash_unlock();
        esp_rom_spiflash_write(KEPT.wrapping_add(at), words.as_ptr(), UNIT_BYTES as i32);
    });
}
