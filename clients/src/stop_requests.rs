//! Requests to stop: from Ctrl-C, a signal, or a button.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Requests to stop a machine. A clone shares the same requests, so a signal handler can keep one
/// clone and a client another.
#[derive(Clone, Debug, Default)]
pub struct StopRequests(Arc<Inner>);

#[derive(Debug, Default)]
struct Inner {
    is_asked: AtomicBool,
    count: AtomicU32,
}

impl StopRequests {
    /// Asks the machine to stop.
    pub fn request(&self) {
        self.0.count.fetch_add(1, Ordering::Relaxed);
        self.0.is_asked.store(true, Ordering::Relaxed);
    }

    /// Whether a stop was requested since the last [`clear`](Self::clear).
    pub fn is_asked(&self) -> bool {
        self.0.is_asked.load(Ordering::Relaxed)
    }

    /// Number of requests so far. [`clear`](Self::clear) does not change it.
    pub fn count(&self) -> u32 {
        self.0.count.load(Ordering::Relaxed)
    }

    /// Marks the requests as served, because the machine has stopped.
    pub fn clear(&self) {
        self.0.is_asked.store(false, Ordering::Relaxed);
    }
}
