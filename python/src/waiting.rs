//! Waits for a thread without the interpreter.

use crate::failure::fault;
use pyo3::prelude::*;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Time between two looks at signals, such as that of Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(100);

/// What `next` receives within the time that it is given.
///
/// # Errors
///
/// A signal, such as that of Ctrl-C, ends the wait with its exception. The sender has ended without
/// a message.
pub fn received<T: Send>(
    py: Python<'_>,
    mut next: impl FnMut(Duration) -> Result<T, RecvTimeoutError> + Send,
) -> PyResult<T> {
    loop {
        match py.detach(|| next(PATIENCE)) {
            Ok(message) => return Ok(message),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => return Err(fault()),
        }
    }
}

/// Computes something in a thread of its own. After a signal the thread goes on, and nobody reads
/// its result.
///
/// # Errors
///
/// As [`received`].
pub fn computed<T: Send + 'static>(
    py: Python<'_>,
    compute: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        // Without a reader the result is not needed.
        let _ = sender.send(compute());
    });
    received(py, move |patience| receiver.recv_timeout(patience))
}
