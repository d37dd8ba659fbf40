//! Two sectors of the flash, for what a firmware keeps without power.

use core::ops::Range;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

use crate::chosen::{self, SECTOR_BYTES};

/// The two sectors. Erasing and writing stops the processor on some chips, so nothing may move.
pub struct Flash;

impl Flash {
    /// The whole area.
    pub const AREA: Range<u32> = 0..2 * SECTOR_BYTES;
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        for (byte, at) in bytes.iter_mut().zip(offset..) {
            *byte = chosen::flash_read(at);
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        Self::AREA.end as usize
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = chosen::UNIT_BYTES;
    const ERASE_SIZE: usize = SECTOR_BYTES as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        for at in (from..to).step_by(Self::ERASE_SIZE) {
            chosen::flash_erase(at);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        let mut at = offset;
        for unit in bytes.chunks_exact(Self::WRITE_SIZE) {
            chosen::flash_write(at, unit);
            // The write ends within the area.
            at = at.wrapping_add(chosen::UNIT_BYTES as u32);
        }
        Ok(())
    }
}
