//! Keeps the backlash of three axes, and how often the board has started, in the flash of a board.
//! A save that does not end, because power fails, leaves what was stored before.
//!
//! With `BOARD=src/nucleo_f401.rs` and the like, this is the flash of that board, and each start
//! counts one more. In QEMU every start is the first one.
#![no_std]
#![no_main]

use board::{CriticalSection, Flash};
use embedded_storage::nor_flash::NorFlash;
use husillo_store::{Store, StoreError};
use semihosting::println;

/// Nothing waits for time or bytes here.
#[unsafe(no_mangle)]
fn on_time(_: CriticalSection<'_>) {}

#[unsafe(no_mangle)]
fn on_byte(_: u8, _: CriticalSection<'_>) {}

/// What is kept.
#[derive(Copy, Clone, PartialEq, Debug, Default)]
struct Settings {
    starts: u32,
    backlash_steps: [u32; 3],
}

impl Settings {
    const BYTES: usize = 16;

    /// Reads the stored ones; without any, all are 0.
    fn load<F: NorFlash>(store: &mut Store<F>) -> Result<Settings, StoreError<F::Error>> {
        let mut bytes = [0; Self::BYTES];
        if store.len() == Some(Self::BYTES as u32) {
            store.read(0, &mut bytes)?;
        }
        let mut words = bytes.chunks_exact(4);
        let mut next = || match words.next() {
            Some(&[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
            _ => 0,
        };
        Ok(Settings {
            starts: next(),
            backlash_steps: [next(), next(), next()],
        })
    }

    /// Writes them to the other half of the flash. Only with `is_committed` do they become valid.
    fn save<F: NorFlash>(
        self,
        store: &mut Store<F>,
        is_committed: bool,
    ) -> Result<(), StoreError<F::Error>> {
        let mut save = store.save()?;
        save.write(&self.starts.to_le_bytes())?;
        for steps in self.backlash_steps {
            save.write(&steps.to_le_bytes())?;
        }
        if is_committed { save.commit() } else { Ok(()) }
    }
}

#[board::entry]
fn main() -> ! {
    board::start();
    match run() {
        Ok(()) => semihosting::process::exit(0),
        Err(error) => println!("{error:?}"),
    }
    semihosting::process::exit(1)
}

fn run() -> Result<(), StoreError<<Flash as embedded_storage::nor_flash::ErrorType>::Error>> {
    let mut store = Store::open(Flash, Flash::AREA)?;
    println!("room for {} bytes", store.capacity());
    let before = Settings::load(&mut store)?;
    let now = Settings {
        starts: before.starts + 1,
        backlash_steps: [20, 30, 8],
    };
    now.save(&mut store, true)?;

    // After a reset the store is opened again.
    let mut store = Store::open(store.release(), Flash::AREA)?;
    println!("{:?}", Settings::load(&mut store)?);
    assert_eq!(Settings::load(&mut store)?, now);

    // Power fails between the content and its header.
    let other = Settings {
        backlash_steps: [21, 29, 9],
        ..now
    };
    other.save(&mut store, false)?;
    let mut store = Store::open(store.release(), Flash::AREA)?;
    println!("after a failure: {:?}", Settings::load(&mut store)?);
    assert_eq!(Settings::load(&mut store)?, now);
    Ok(())
}
