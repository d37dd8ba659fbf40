//! A simulated flash of sectors in RAM. A write clears bits, an erase sets all bits of a sector,
//! and power may fail in any operation.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Failures of the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// An access that is not aligned, is outside, or writes a unit twice.
    Misused,
    /// Power has failed: every operation fails.
    Power,
}

impl NorFlashError for Failure {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// Flash with write units of `UNIT` bytes and read units of four. Each unit is written once after
/// its sector is erased.
#[derive(Clone, Debug)]
pub struct Flash<const UNIT: usize> {
    pub bytes: Vec<u8>,
    /// The units that are written.
    written: Vec<bool>,
    /// Number of operations (erase of a sector, write of a unit) before power fails, and the seed
    /// of the bits that the failed operation leaves.
    pub power: Option<(usize, u64)>,
}

impl<const UNIT: usize> Flash<UNIT> {
    pub fn new(sectors: usize, sector: usize) -> Self {
        assert_eq!(sector, Self::ERASE_SIZE);
        Flash {
            bytes: vec![0xff; sectors * sector],
            written: vec![false; sectors * sector / UNIT],
            power: None,
        }
    }

    /// Counts an operation. Returns the seed of random bits if power fails in it.
    fn operate(&mut self) -> Result<Option<u64>, Failure> {
        match &mut self.power {
            None => Ok(None),
            Some((0, seed)) if *seed == 0 => Err(Failure::Power),
            Some((0, seed)) => Ok(Some(core::mem::take(seed))),
            Some((left, _)) => {
                *left -= 1;
                Ok(None)
            }
        }
    }
}

/// Returns the next random number of a sequence (Marsaglia 2003).
fn random(seed: &mut u64) -> u8 {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    (*seed >> 24) as u8
}

impl<const UNIT: usize> ErrorType for Flash<UNIT> {
    type Error = Failure;
}

impl<const UNIT: usize> ReadNorFlash for Flash<UNIT> {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failure> {
        let offset = offset as usize;
        if !offset.is_multiple_of(4) || !bytes.len().is_multiple_of(4) {
            return Err(Failure::Misused);
        }
        bytes.copy_from_slice(
            self.bytes
                .get(offset..offset + bytes.len())
                .ok_or(Failure::Misused)?,
        );
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl<const UNIT: usize> NorFlash for Flash<UNIT> {
    const WRITE_SIZE: usize = UNIT;
    const ERASE_SIZE: usize = 256;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failure> {
        if !from.is_multiple_of(256) || !to.is_multiple_of(256) || to as usize > self.bytes.len() {
            return Err(Failure::Misused);
        }
        for sector in from / 256..to / 256 {
            let range = sector as usize * 256..(sector as usize + 1) * 256;
            let failed = self.operate()?;
            for byte in &mut self.bytes[range.clone()] {
                // Some bits are set already.
                *byte = failed.map_or(0xff, |mut seed| *byte | random(&mut seed));
            }
            if let Some(mut seed) = failed {
                for byte in &mut self.bytes[range] {
                    *byte |= random(&mut seed);
                }
                return Err(Failure::Power);
            }
            self.written[range.start / UNIT..range.end / UNIT].fill(false);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failure> {
        let offset = offset as usize;
        if !offset.is_multiple_of(UNIT)
            || !bytes.len().is_multiple_of(UNIT)
            || offset + bytes.len() > self.bytes.len()
        {
            return Err(Failure::Misused);
        }
        for (index, unit) in bytes.chunks_exact(UNIT).enumerate() {
            let at = offset + index * UNIT;
            if core::mem::replace(&mut self.written[at / UNIT], true) {
                return Err(Failure::Misused);
            }
            let failed = self.operate()?;
            let mut seed = failed.unwrap_or(1);
            for (place, byte) in self.bytes[at..].iter_mut().zip(unit) {
                // Some bits are cleared already.
                *place &= if failed.is_some() {
                    byte | random(&mut seed)
                } else {
                    *byte
                };
            }
            if failed.is_some() {
                return Err(Failure::Power);
            }
        }
        Ok(())
    }
}
