//! The two halves, and which of them counts.

use core::ops::Range;

use embedded_storage::nor_flash::NorFlash;

use crate::header::{HEADER, Header, extended};
use crate::unit::{UNIT, header_size, read};
use crate::{Save, StoreError};

/// A content in flash, in two copies of which the newer whole one counts.
///
/// | | |
/// | --- | --- |
/// | area | two times so many whole sectors of the flash, up to 2^32 bytes |
/// | content | any bytes, at most [`capacity`](Store::capacity) |
/// | power fails | during a [`Save`]: the old content is there, or the new one after [`commit`](Save::commit) has begun |
/// | found wrong | any change of up to 32 bits in a row, others but for one in 2^32 (CRC-32) |
/// | source | the order of writes of a two-phase commit (Gray 1978); CRC-32 of ISO-HDLC |
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
    start: u32,
    /// Size of a half.
    half: u32,
    /// The half that counts, if there is one.
    newest: Option<(Half, Header)>,
}

/// One of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Half {
    First,
    Second,
}

impl<F: NorFlash> Store<F> {
    /// Looks for a content in this area of the flash. Reads both copies once.
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
            // The numbers of two halves differ by one; they may have gone round.
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

    /// How long a content may be, bytes.
    pub fn capacity(&self) -> u32 {
        // A half is longer than a header.
        self.half.wrapping_sub(header_size::<F>())
    }

    /// Length of the content, bytes; `None` where there is none.
    pub fn len(&self) -> Option<u32> {
        self.newest.map(|(_, header)| header.length)
    }

    /// Nothing is stored, or a content of no bytes.
    pub fn is_empty(&self) -> bool {
        self.len().unwrap_or(0) == 0
    }

    /// Bytes of the content, from `offset` on; an error if it does not go so far.
    pub fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), StoreError<F::Error>> {
        let (half, header) = self.newest.ok_or(StoreError::Nothing)?;
        let end = u32::try_from(bytes.len())
            .ok()
            .and_then(|count| offset.checked_add(count));
        if end.is_none_or(|end| end > header.length) {
            return Err(StoreError::Nothing);
        }
        // Within the half.
        let from = self.begin(half).wrapping_add(offset);
        Ok(read(&mut self.flash, from, bytes)?)
    }

    /// Begins a new content: erases the older half. What is stored stays so until [`Save::commit`].
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

    /// The flash, for other uses.
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

    /// Makes the content of a half the one that counts.
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

    /// The header of a half, if it and the content are as they were written.
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
            // 1 to 32.
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
