//! A flash in RAM whose power fails when a test wants it.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

const SECTOR: usize = 4096;

/// Two sectors of 4 kB. It is written in words of 4 bytes.
#[derive(Debug)]
pub struct Flash {
    bytes: [u8; 2 * SECTOR],
    words_until_failure: Option<u32>,
}

/// The power has failed, or the address is beyond the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PowerFailure;

impl Flash {
    /// An erased flash.
    pub const fn new() -> Self {
        Flash {
            bytes: [0xff; 2 * SECTOR],
            words_until_failure: None,
        }
    }

    /// Lets the power fail after some more words are written; `None` never.
    pub fn fail_after(&mut self, words: Option<u32>) {
        self.words_until_failure = words;
    }
}

impl Default for Flash {
    fn default() -> Self {
        Self::new()
    }
}

impl NorFlashError for PowerFailure {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Flash {
    type Error = PowerFailure;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), PowerFailure> {
        let from = offset as usize;
        let stored = self
            .bytes
            .get(from..from + bytes.len())
            .ok_or(PowerFailure)?;
        bytes.copy_from_slice(stored);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), PowerFailure> {
        let sectors = self
            .bytes
            .get_mut(from as usize..to as usize)
            .ok_or(PowerFailure)?;
        sectors.fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), PowerFailure> {
        for (word, at) in bytes
            .chunks(Self::WRITE_SIZE)
            .zip((offset as usize..).step_by(4))
        {
            match &mut self.words_until_failure {
                Some(0) => return Err(PowerFailure),
                Some(words) => *words -= 1,
                None => {}
            }
            let stored = self
                .bytes
                .get_mut(at..at + word.len())
                .ok_or(PowerFailure)?;
            // A flash can only clear bits.
            stored
                .iter_mut()
                .zip(word)
                .for_each(|(stored, byte)| *stored &= byte);
        }
        Ok(())
    }
}
