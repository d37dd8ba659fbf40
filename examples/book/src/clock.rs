//! A clock that stands still unless a program waits.

use embedded_hal::delay::DelayNs;
use std::cell::Cell;
use std::rc::Rc;

/// Time in nanoseconds. All clones show the same time.
#[derive(Clone, Debug, Default)]
pub struct Clock(Rc<Cell<u64>>);

impl Clock {
    /// Nanoseconds since the start.
    pub fn ns(&self) -> u64 {
        self.0.get()
    }

    /// Microseconds since the start; wraps.
    pub fn us(&self) -> u32 {
        (self.ns() / 1000) as u32
    }
}

impl DelayNs for Clock {
    fn delay_ns(&mut self, ns: u32) {
        self.0.set(self.ns() + u64::from(ns));
    }
}
