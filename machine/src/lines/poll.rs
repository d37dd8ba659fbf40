//! For programs that wait with `nb::block!`: room in the queue.

use husillo_backlash::Lash;
use husillo_interp::Moves;

use crate::{Machine, Refused};

impl<const N: usize, P: Moves<N>, L: Lash<N>, const QUEUE: usize> Machine<N, P, L, QUEUE> {
    /// [`line`](Machine::line), for a loop that takes events meanwhile.
    ///
    /// # Errors
    /// `WouldBlock` while the line before waits for room in the queue; otherwise what is wrong with
    /// this one.
    pub fn poll_line(&mut self, text: &[u8]) -> nb::Result<(), Refused> {
        self.line(text).map_err(|refused| match refused {
            Refused::Busy => nb::Error::WouldBlock,
            refused => nb::Error::Other(refused),
        })
    }
}
