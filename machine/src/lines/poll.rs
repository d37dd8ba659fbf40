//! Room in the queue, for programs that wait with `nb::block!`.

use husillo_backlash::BacklashModel;
use husillo_interp::Moves;

use crate::lines::extension::Extension;
use crate::lines::path_ramp::PathRamp;
use crate::{Machine, Refused};

impl<
    const N: usize,
    P: Moves<N>,
    L: BacklashModel<N>,
    const QUEUE: usize,
    E: Extension<N>,
    R: PathRamp,
> Machine<N, P, L, QUEUE, E, R>
{
    /// Takes a line as [`line`](Machine::line) does, for a loop that takes events meanwhile.
    ///
    /// # Errors
    /// `WouldBlock` while the previous line waits for room in the queue; otherwise the reason for
    /// the refusal of this line.
    pub fn poll_line(&mut self, text: &[u8]) -> nb::Result<(), Refused> {
        self.line(text).map_err(|refused| match refused {
            Refused::Busy => nb::Error::WouldBlock,
            refused => nb::Error::Other(refused),
        })
    }
}
