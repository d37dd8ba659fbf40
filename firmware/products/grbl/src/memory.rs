//! Settings, coordinate data and stored lines in the flash of the board.

use board::Flash;
use husillo_controllers::GrblMemory;
use husillo_store::Store;

/// The store. `None`: the flash does not answer, so nothing is kept.
pub struct Memory(Option<Store<Flash>>);

impl Memory {
    /// Opens the store.
    pub fn open() -> Self {
        Memory(Store::open(Flash, Flash::AREA).ok())
    }

    /// What was kept. `None`: nothing, or it is damaged.
    pub fn read(&mut self) -> Option<GrblMemory> {
        let mut bytes = [0; GrblMemory::BYTES];
        self.0.as_mut()?.read(0, &mut bytes).ok()?;
        GrblMemory::from_bytes(&bytes)
    }

    /// Keeps a memory. Power may fail at any moment; then the old one is kept.
    pub fn write(&mut self, memory: &GrblMemory) {
        let Some(store) = &mut self.0 else { return };
        let Ok(mut save) = store.save() else { return };
        if save.write(&memory.to_bytes()).is_ok() {
            // Without it the old content stays. There is no one to tell.
            let _ = save.commit();
        }
    }
}
