//! For programs that wait with `nb::block!`: a touch.

use crate::{Cycle, Failure, Input, Measurement, Request};

impl Cycle {
    /// [`tick`](Cycle::tick), for a loop: what the machine shall do goes to `carry_out`, which is
    /// not called for [`Request::Wait`].
    ///
    /// # Errors
    /// `WouldBlock` until the cycle is over; then what went wrong.
    pub fn poll<F: FnOnce(Request)>(
        &mut self,
        input: &Input,
        carry_out: F,
    ) -> nb::Result<Measurement, Failure> {
        match self.tick(input) {
            Request::Done(measurement) => Ok(measurement),
            Request::Failed(failure) => Err(nb::Error::Other(failure)),
            Request::Wait => Err(nb::Error::WouldBlock),
            request => {
                carry_out(request);
                Err(nb::Error::WouldBlock)
            }
        }
    }
}
