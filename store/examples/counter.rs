//! Counts its starts in a flash that is a file. Run it several times.
//!
//! ```sh
//! cargo run -p husillo-store --example counter
//! ```

mod flash;

use flash::Flash;
use husillo_store::Store;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::temp_dir().join("husillo-store-example.flash");
    let mut flash = Flash::<4>::new(2, 256);
    if let Ok(bytes) = std::fs::read(&file) {
        flash.bytes = bytes;
    }
    let mut store = Store::open(flash, 0..512)?;
    let mut count = [0; 4];
    if store.len() == Some(4) {
        store.read(0, &mut count)?;
    }
    let starts = u32::from_le_bytes(count) + 1;
    println!("start {starts}");
    let mut save = store.save()?;
    save.write(&starts.to_le_bytes())?;
    save.commit()?;
    std::fs::write(file, store.release().bytes)?;
    Ok(())
}
