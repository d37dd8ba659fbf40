//! Requests to end: Ctrl-C, SIGTERM, and a closed terminal.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// A flag that Ctrl-C and a request to end set.
///
/// # Errors
///
/// The system does not hand them over.
pub fn stop_flag() -> Result<Arc<AtomicBool>, String> {
    let flag = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        STOPS_ASKED.fetch_add(1, Ordering::Relaxed);
        set.store(true, Ordering::Relaxed);
    })
    .map_err(|error| error.to_string())?;
    Ok(flag)
}

/// How often that was asked for.
static STOPS_ASKED: AtomicU32 = AtomicU32::new(0);

/// How often Ctrl-C was pressed, or the end was asked for.
pub fn stops_asked() -> u32 {
    STOPS_ASKED.load(Ordering::Relaxed)
}
