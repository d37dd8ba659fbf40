//! Reads and writes in the units of the flash.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};

/// Largest size of a read or write unit, in bytes.
pub(crate) const UNIT: usize = 32;

/// Reads any bytes of a flash that reads in units, through a window of 32 bytes.
pub(crate) fn read<F: ReadNorFlash>(
    flash: &mut F,
    from: u32,
    bytes: &mut [u8],
) -> Result<(), F::Error> {
    const {
        assert!(F::READ_SIZE <= UNIT && F::READ_SIZE.is_power_of_two());
    }
    let mut window = [0; UNIT];
    let mut at = from;
    let mut rest = bytes;
    while !rest.is_empty() {
        // Both are below 32.
        let within = at as usize % UNIT;
        let count = UNIT.wrapping_sub(within).min(rest.len());
        let (part, others) = core::mem::take(&mut rest)
            .split_at_mut_checked(count)
            .unwrap_or_default();
        // Reads only the requested part of the window, in whole read units. It therefore stays
        // within an area of whole sectors. Read sizes are powers of two.
        let low = F::READ_SIZE.wrapping_sub(1);
        let first = within & !low;
        let end = within.wrapping_add(count).wrapping_add(low) & !low;
        if let Some(window) = window.get_mut(first..end) {
            flash.read(at & !(low as u32), window)?;
        }
        for (byte, read) in part.iter_mut().zip(window.iter().skip(within)) {
            *byte = *read;
        }
        // An area lies within 32 bits.
        at = at.wrapping_add(count as u32);
        rest = others;
    }
    Ok(())
}

/// Returns the size of a header in this flash, in bytes.
pub(crate) const fn header_size<F: NorFlash>() -> u32 {
    const {
        assert!(F::WRITE_SIZE <= UNIT && F::WRITE_SIZE.is_power_of_two());
    }
    if F::WRITE_SIZE > 16 { 32 } else { 16 }
}
