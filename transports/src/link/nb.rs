//! For programs that wait with `nb::block!`: takes a payload, or would block until a payload is
//! acknowledged.

use super::{Master, Peer, Refused, Station};

impl<const WINDOW: usize> Peer<WINDOW> {
    /// [`send`](Peer::send), for a loop.
    ///
    /// # Errors
    /// `WouldBlock` while as many are on their way as may be; otherwise what stays wrong.
    pub fn poll_send(&mut self, payload: &[u8]) -> nb::Result<(), Refused> {
        or_full(self.send(payload))
    }
}

impl Station {
    /// [`send`](Station::send), for a loop.
    ///
    /// # Errors
    /// `WouldBlock` while the last one was not fetched; otherwise what stays wrong.
    pub fn poll_send(&mut self, payload: &[u8]) -> nb::Result<(), Refused> {
        or_full(self.send(payload))
    }
}

impl<const STATIONS: usize> Master<STATIONS> {
    /// [`send`](Master::send), for a loop.
    ///
    /// # Errors
    /// `WouldBlock` while as many are on their way as may be; otherwise what stays wrong.
    pub fn poll_send(&mut self, station: usize, payload: &[u8]) -> nb::Result<(), Refused> {
        or_full(self.send(station, payload))
    }
}

fn or_full(result: Result<(), Refused>) -> nb::Result<(), Refused> {
    result.map_err(|refused| match refused {
        Refused::Full => nb::Error::WouldBlock,
        refused => nb::Error::Other(refused),
    })
}
