//! Probing cycle for programs that wait with `nb::block!`.

use crate::{Cycle, Failure, Input, Measurement, Request};

impl Cycle {
    /// Calls [`tick`](Cycle::tick) and passes its request to `carry_out`. Does not call `carry_out`
    /// for [`Request::Wait`].
    ///
    /// # Errors
    /// Returns `WouldBlock` until the cycle is over. Then fails with the [`Failure`] of the cycle,
    /// if it has one.
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
