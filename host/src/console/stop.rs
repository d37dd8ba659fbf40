//! Requests to end: Ctrl-C, SIGTERM, and a closed terminal.

use husillo_clients::StopRequests;
use std::sync::{Mutex, OnceLock, PoisonError};

/// Exit status of a program that Ctrl-C has ended: 128 and the number of the signal.
pub const INTERRUPTED: u8 = 130;

/// The requests of this process.
static REQUESTS: OnceLock<StopRequests> = OnceLock::new();

/// Requests to stop, counted from the first call on.
///
/// # Errors
///
/// The system does not deliver the signals.
pub fn stop_requests() -> Result<StopRequests, String> {
    if let Some(requests) = REQUESTS.get() {
        return Ok(requests.clone());
    }
    let requests = REQUESTS.get_or_init(StopRequests::default).clone();
    let signalled = requests.clone();
    on_request(move || signalled.request())?;
    Ok(requests)
}

/// Number of requests so far: Ctrl-C, or another request to end.
pub fn stops_asked() -> u32 {
    REQUESTS.get().map_or(0, StopRequests::count)
}

/// The function that is called at a request to end.
static HANDLER: Mutex<Option<Box<dyn FnMut() + Send>>> = Mutex::new(None);

/// Calls `handle` at every request to end, in a thread of its own. A process has one such handler:
/// the first.
///
/// # Errors
///
/// There is a handler already, or the system does not deliver the signals.
pub fn on_request(handle: impl FnMut() + Send + 'static) -> Result<(), String> {
    let mut handler = HANDLER.lock().unwrap_or_else(PoisonError::into_inner);
    if handler.is_some() {
        return Err("requests to end are handled already".into());
    }
    *handler = Some(Box::new(handle));
    drop(handler);
    deliver().map_err(|error| format!("signals: {error}"))
}

/// Makes a request to end, as Ctrl-C does. Without a handler it ends the program.
pub fn request() {
    match HANDLER
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .as_mut()
    {
        Some(handle) => handle(),
        None => std::process::exit(INTERRUPTED.into()),
    }
}

#[cfg(unix)]
fn deliver() -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    if !ignores(SIGHUP) {
        signals.add_signal(SIGHUP)?;
    }
    std::thread::spawn(move || signals.forever().for_each(|_| request()));
    Ok(())
}

#[cfg(not(unix))]
fn deliver() -> Result<(), ctrlc::Error> {
    ctrlc::set_handler(request)
}

/// Whether this process was started with a signal ignored, as `nohup` does with SIGHUP. Only Linux
/// reports it.
#[cfg(unix)]
fn ignores(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    mask.is_some_and(|mask| mask & (1 << (signal - 1)) != 0)
}
