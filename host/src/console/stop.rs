//! Requests to end: Ctrl-C, SIGTERM, and a closed terminal.

use husillo_clients::StopRequests;
use std::sync::OnceLock;

/// The requests of this process.
static REQUESTS: OnceLock<StopRequests> = OnceLock::new();

/// Requests to stop, counted from now on.
///
/// # Errors
///
/// The system does not deliver the signals.
pub fn stop_requests() -> Result<StopRequests, String> {
    let requests = REQUESTS.get_or_init(StopRequests::default).clone();
    let signalled = requests.clone();
    ctrlc::set_handler(move || signalled.request()).map_err(|error| error.to_string())?;
    Ok(requests)
}

/// How often Ctrl-C was pressed, or the end was asked for.
pub fn stops_asked() -> u32 {
    REQUESTS.get().map_or(0, StopRequests::count)
}
