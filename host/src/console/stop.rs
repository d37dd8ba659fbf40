//! Requests to end: Ctrl-C, SIGTERM, and a closed terminal.

use husillo_clients::StopRequests;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

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
    on_request(move || signalled.request())?;
    Ok(requests)
}

/// How often Ctrl-C was pressed, or the end was requested.
pub fn stops_asked() -> u32 {
    REQUESTS.get().map_or(0, StopRequests::count)
}

/// Calls `handle` at every request to end, in a thread of its own. A process has one such handler:
/// the first.
///
/// # Errors
///
/// There is a handler already, or the system does not deliver the signals.
pub fn on_request(handle: impl FnMut() + Send + 'static) -> Result<(), String> {
    static HAS_HANDLER: AtomicBool = AtomicBool::new(false);
    if HAS_HANDLER.swap(true, Ordering::SeqCst) {
        return Err("requests to end are handled already".into());
    }
    deliver(handle).map_err(|error| format!("signals: {error}"))
}

#[cfg(unix)]
fn deliver(mut handle: impl FnMut() + Send + 'static) -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    if !ignores(SIGHUP) {
        signals.add_signal(SIGHUP)?;
    }
    std::thread::spawn(move || signals.forever().for_each(|_| handle()));
    Ok(())
}

#[cfg(not(unix))]
fn deliver(handle: impl FnMut() + Send + 'static) -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(handle)
}

/// Whether this process was started with a signal ignored, as `nohup` does with SIGHUP. Only Linux
/// shows it.
#[cfg(unix)]
fn ignores(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}
