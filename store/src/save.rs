//! A content that is being saved.

use embedded_storage::nor_flash::NorFlash;

use crate::header::{Header, extended};
use crate::store::Half;
use crate::unit::UNIT;
use crate::{Store, StoreError};

/// A content that is being written. [`commit`](Save::commit) makes it the valid one. If the value
/// is dropped without a commit, the old content stays.
#[derive(Debug)]
pub struct Save<'a, F> {
    store: &'a mut Store<F>,
    half: Half,
    number: u32,
    /// Number of bytes accepted. The bytes of an incomplete write unit are in `unit`.
    length: u32,
    unit: [u8; UNIT],
    checksum: u32,
}

impl<'a, F: NorFlash> Save<'a, F> {
    pub(crate) fn new(store: &'a mut Store<F>, half: Half, number: u32) -> Self {
        Save {
            store,
            half,
            number,
            length: 0,
            unit: [0xff; UNIT],
            checksum: 0,
        }
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// - [`StoreError::Full`]: there is no room for `bytes`; none of them is written.
    /// - [`StoreError::Flash`]: the driver failed.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), StoreError<F::Error>> {
        let room = self.store.capacity().saturating_sub(self.length);
        if bytes.len() > room as usize {
            return Err(StoreError::Full);
        }
        for byte in bytes {
            if let Some(place) = self.unit.get_mut(self.length as usize % F::WRITE_SIZE) {
                *place = *byte;
            }
            // The length is at most the capacity.
            self.length = self.length.wrapping_add(1);
            if (self.length as usize).is_multiple_of(F::WRITE_SIZE) {
                self.flush()?;
            }
        }
        self.checksum = extended(self.checksum, bytes);
        Ok(())
    }

    /// Reads the content back and makes it the valid one.
    ///
    /// # Errors
    /// - [`StoreError::Differs`]: the content reads back differently. The old content stays.
    /// - [`StoreError::Flash`]: the driver failed.
    pub fn commit(mut self) -> Result<(), StoreError<F::Error>> {
        if !(self.length as usize).is_multiple_of(F::WRITE_SIZE) {
            self.flush()?;
        }
        let header = Header {
            number: self.number,
            length: self.length,
            content: self.checksum,
        };
        self.store.finish(self.half, header)
    }

    /// Writes the unit that contains the last byte.
    fn flush(&mut self) -> Result<(), StoreError<F::Error>> {
        // There is at least one byte.
        let last = self.length.wrapping_sub(1);
        // Write sizes are powers of two up to 32.
        let low = (F::WRITE_SIZE as u32).wrapping_sub(1);
        let at = self.store.begin(self.half).wrapping_add(last & !low);
        let unit = self.unit.get(..F::WRITE_SIZE).unwrap_or(&self.unit);
        self.store.flash().write(at, unit)?;
        self.unit = [0xff; UNIT];
        Ok(())
    }
}
