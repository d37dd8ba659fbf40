//! Functions for programs that wait with `nb::block!`. They accept a payload. If there is no room,
//! they return `WouldBlock` until a payload is acknowledged.

use super::{Master, Peer, Refused, Station};

impl<const WINDOW: usize> Peer<WINDOW> {
    /// Like [`send`](Peer::send), but can be repeated in a loop.
    ///
    /// # Errors
    /// `WouldBlock` while the largest number of payloads is in flight. Other errors are permanent.
    pub fn poll_send(&mut self, payload: &[u8]) -> nb::Result<(), Refused> {
        or_full(self.send(payload))
    }
}

impl Station {
    /// Like [`send`](Station::send), but can be repeated in a loop.
    ///
    /// # Errors
    /// `WouldBlock` while the master has not fetched the last payload. Other errors are permanent.
    pub fn poll_send(&mut self, payload: &[u8]) -> nb::Result<(), Refused> {
        or_full(self.send(payload))
    }
}

impl<const STATIONS: usize> Master<STATIONS> {
    /// Like [`send`](Master::send), but can be repeated in a loop.
    ///
    /// # Errors
    /// `WouldBlock` while the largest number of payloads is in flight. Other errors are permanent.
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
