//! Settings in a flash whose power fails at every word of a save.

use embedded_storage::nor_flash::NorFlash;
use husillo_book::flash::{Flash, PowerFailure};
use husillo_store::{Store, StoreError};

// ANCHOR: save
fn save<F: NorFlash>(store: &mut Store<F>, text: &[u8]) -> Result<(), StoreError<F::Error>> {
    let mut save = store.save()?;
    save.write(text)?;
    save.commit()
}

fn load<F: NorFlash>(store: &mut Store<F>) -> Result<String, StoreError<F::Error>> {
    let mut bytes = vec![0; store.len().unwrap_or(0) as usize];
    store.read(0, &mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
// ANCHOR_END: save

fn main() -> Result<(), StoreError<PowerFailure>> {
    // ANCHOR: open
    let mut store = Store::open(Flash::new(), 0..8192)?;
    assert!(store.is_empty());
    println!("room for {} bytes", store.capacity());
    save(&mut store, b"backlash 20 30")?;
    println!("stored: {}", load(&mut store)?);
    // ANCHOR_END: open

    // ANCHOR: failures
    let (mut old, mut new) = (0, 0);
    for words in 0.. {
        let mut flash = store.release();
        flash.fail_after(Some(words));
        store = Store::open(flash, 0..8192)?;
        let saved = save(&mut store, b"backlash 21 29");

        // The power returns.
        let mut flash = store.release();
        flash.fail_after(None);
        store = Store::open(flash, 0..8192)?;
        match load(&mut store)?.as_str() {
            "backlash 20 30" => old += 1,
            "backlash 21 29" => new += 1,
            other => panic!("neither the old nor the new content: {other}"),
        }
        if saved.is_ok() {
            break;
        }
    }
    println!("power failed at {old} words: the old content; then the new one, {new} time");
    println!("stored: {}", load(&mut store)?);
    // ANCHOR_END: failures
    assert_eq!(load(&mut store)?, "backlash 21 29");
    assert!(old >= 4 && new == 1);
    Ok(())
}
