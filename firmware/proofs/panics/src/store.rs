//! The public functions of `husillo-store`.

use core::hint::black_box;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use husillo_store::{Save, Store};

/// A flash whose behaviour the compiler does not know.
struct Flash<const UNIT: usize>;

#[derive(Debug)]
struct Failure;

impl NorFlashError for Failure {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl<const UNIT: usize> ErrorType for Flash<UNIT> {
    type Error = Failure;
}

impl<const UNIT: usize> ReadNorFlash for Flash<UNIT> {
    const READ_SIZE: usize = if UNIT < 4 { UNIT } else { 4 };

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Failure> {
        black_box((offset, bytes));
        black_box(Ok(()))
    }

    fn capacity(&self) -> usize {
        black_box(1 << 16)
    }
}

impl<const UNIT: usize> NorFlash for Flash<UNIT> {
    const WRITE_SIZE: usize = UNIT;
    const ERASE_SIZE: usize = 1024;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Failure> {
        black_box((from, to));
        black_box(Ok(()))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Failure> {
        black_box((offset, bytes));
        black_box(Ok(()))
    }
}

/// Keeps every function in the program.
#[unsafe(export_name = "store")]
pub fn keep() {
    black_box([
        Store::<Flash<8>>::open as *const (),
        Store::<Flash<8>>::capacity as *const (),
        Store::<Flash<8>>::len as *const (),
        Store::<Flash<8>>::is_empty as *const (),
        Store::<Flash<8>>::read as *const (),
        Store::<Flash<8>>::save as *const (),
        Store::<Flash<8>>::release as *const (),
        Save::<Flash<8>>::write as *const (),
        Save::<Flash<8>>::commit as *const (),
    ]);
    black_box([
        Store::<Flash<1>>::open as *const (),
        Store::<Flash<1>>::read as *const (),
        Save::<Flash<1>>::write as *const (),
        Save::<Flash<1>>::commit as *const (),
        Store::<Flash<32>>::open as *const (),
        Store::<Flash<32>>::read as *const (),
        Save::<Flash<32>>::write as *const (),
        Save::<Flash<32>>::commit as *const (),
    ]);
}
