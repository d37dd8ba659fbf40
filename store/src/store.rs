//! The store: two halves, and the choice of the valid one.

use core::ops::Range;

use embedded_storage::nor_flash::NorFlash;

use crate::header::{HEADER, Header, extended};
use crate::unit::{UNIT, header_size, read};
use crate::{Save, StoreError};

/// A content in flash, in two copies. The newer intact copy is valid.
///
/// | | |
/// | --- | --- |
/// | area | an even number of whole sectors of the flash, up to 2^32 bytes |
/// | content | any bytes, at most [`capacity`](Store::capacity) |
/// | power failure during a [`Save`] | leaves the old content, or the new one once [`commit`](Save::commit) has begun |
/// | error detection | any change within 32 bits in a row; all other changes except one in 2^32 (CRC-32) |
/// | source | the order of writes of a two-phase commit (Gray 1978); CRC-32 of ISO-HDLC |
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
    start: u32,
    /// Size of a half in bytes.
    half: u32,
    /// The valid half, if there is one.
    newest: Option<(Half, Header)>,
}

/// One of the two halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Half {
    First,
    Second,
}

impl<F: NorFlash> Store<F> {
    /// Opens this area of the flash and looks for a content. Reads both copies once.
    ///
    /// # Errors
    /// - [`StoreError::Area`]: the area does not fit the flash.
    /// - [`StoreError::Flash`]: the driver failed.
    pub fn open(flash: F, area: Range<u32>) -> Result<Self, StoreError<F::Error>> {
        let size = area.end.checked_sub(area.start).ok_or(StoreError::Area)?;
        let half = size / 2;
        let sector = u32::try_from(F::ERASE_SIZE).map_err(|_| StoreError::Area)?;
        let is_whole = |bytes: u32| bytes.checked_rem(sector) == Some(0);
        let is_there = area.end as usize <= flash.capacity();
        if half <= header_size::<F>()
            || size % 2 != 0
            || !is_whole(half)
            || !is_whole(area.start)
            || !is_there
        {
            return Err(StoreError::Area);
        }
        let mut store = Store {
            flash,
            start: area.start,
            half,
            newest: None,
        };
        let first = store.whole(Half::First)?;
        let second = store.whole(Half::Second)?;
        store.newest = match (first, second) {
            // The numbers of the two halves differ by one. They may have wrapped.
            (Some(first), Some(second))
                if (second.number.wrapping_sub(first.number) as i32) > 0 =>
            {
                Some((Half::Second, second))
            }
            (Some(first), _) => Some((Half::First, first)),
            (None, Some(second)) => Some((Half::Second, second)),
            (None, None) => None,
        };
        Ok(store)
    }

    /// Returns the largest length of a content, in bytes.
    pub fn capacity(&self) -> u32 {
        // A half is longer than a header.
        self.half.wrapping_sub(header_size::<F>())
    }

    /// Returns the length of the content in bytes. Returns `None` if nothing is stored.
    pub fn len(&self) -> Option<u32> {
        self.newest.map(|(_, header)| header.length)
    }

    /// Whether nothing is stored, or a content of no bytes.
    pub fn is_empty(&self) -> bool {
        self.len().unwrap_or(0) == 0
    }

    /// Reads bytes of the content from `offset` on.
    ///
    /// # Errors
    /// - [`StoreError::Nothing`]: there is no content, or it ends before the last byte.
    /// - [`StoreError::Flash`]: the driver failed.
    pub fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), StoreError<F::Error>> {
        let (half, header) = self.newest.ok_or(StoreError::Nothing)?;
        let end = u32::try_from(bytes.len())
            .ok()
            .and_then(|count| offset.checked_add(count));
        if end.is_none_or(|end| end > header.length) {
            return Err(StoreError::Nothing);
        }
        // The address is within the half.
        let from = self.begin(half).wrapping_add(offset);
        Ok(read(&mut self.flash, from, bytes)?)
    }

    /// Begins a new content: erases the older half. The stored content stays valid until
    /// [`Save::commit`].
    ///
    /// # Errors
    /// [`StoreError::Flash`] if the driver failed.
    pub fn save(&mut self) -> Result<Save<'_, F>, StoreError<F::Error>> {
        let (half, number) = match self.newest {
            Some((Half::First, header)) => (Half::Second, header.number.wrapping_add(1)),
            Some((Half::Second, header)) => (Half::First, header.number.wrapping_add(1)),
            None => (Half::First, 0),
        };
        let begin = self.begin(half);
        self.flash.erase(begin, begin.wrapping_add(self.half))?;
        Ok(Save::new(self, half, number))
    }

    /// Returns the flash.
    pub fn release(self) -> F {
        self.flash
    }

    pub(crate) fn begin(&self, half: Half) -> u32 {
        // The area ends within 32 bits.
        match half {
            Half::First => self.start,
            Half::Second => self.start.wrapping_add(self.half),
        }
    }

    fn header_at(&self, half: Half) -> u32 {
        self.begin(half).wrapping_add(self.capacity())
    }

    pub(crate) fn flash(&mut self) -> &mut F {
        &mut self.flash
    }

    /// Makes the content of a half the valid one.
    pub(crate) fn finish(
        &mut self,
        half: Half,
        header: Header,
    ) -> Result<(), StoreError<F::Error>> {
        if self.checksum(half, header.length)? != header.content {
            return Err(StoreError::Differs);
        }
        let mut unit = [0xff; UNIT];
        if let Some(place) = unit.first_chunk_mut() {
            *place = header.bytes();
        }
        let size = header_size::<F>() as usize;
        let at = self.header_at(half);
        self.flash.write(at, unit.get(..size).unwrap_or(&unit))?;
        match self.header(half)? {
            Some(read) if read.bytes() == header.bytes() => self.newest = Some((half, header)),
            _ => return Err(StoreError::Differs),
        }
        Ok(())
    }

    /// Returns the header of a half if header and content are intact.
    fn whole(&mut self, half: Half) -> Result<Option<Header>, StoreError<F::Error>> {
        let Some(header) = self.header(half)? else {
            return Ok(None);
        };
        if header.length > self.capacity() {
            return Ok(None);
        }
        let is_whole = self.checksum(half, header.length)? == header.content;
        Ok(is_whole.then_some(header))
    }

    fn header(&mut self, half: Half) -> Result<Option<Header>, F::Error> {
        let mut bytes = [0; HEADER];
        let at = self.header_at(half);
        read(&mut self.flash, at, &mut bytes)?;
        Ok(Header::of(&bytes))
    }

    fn checksum(&mut self, half: Half, length: u32) -> Result<u32, F::Error> {
        let mut checksum = 0;
        let mut window = [0; UNIT];
        let begin = self.begin(half);
        for offset in (0..length).step_by(UNIT) {
            // The count is 1 to 32.
            let count = length.wrapping_sub(offset).min(UNIT as u32) as usize;
            let Some(part) = window.get_mut(..count) else {
                break;
            };
            read(&mut self.flash, begin.wrapping_add(offset), part)?;
            checksum = extended(checksum, part);
        }
        Ok(checksum)
    }
}
