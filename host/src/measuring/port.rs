//! The port of a network of modules.

use husillo_clients::Port;
use husillo_metrology::heads;
use husillo_transports::nmc::{Baud, Timing};
use std::io;

/// A serial device or a socket that leads to a network of modules.
#[derive(Debug)]
pub struct NetworkPort(Port);

impl NetworkPort {
    /// Opens a serial device or, with `tcp:HOST:PORT`, a socket.
    ///
    /// # Errors
    ///
    /// The device or socket cannot be opened.
    pub fn open(name: &str) -> io::Result<Self> {
        Ok(Self(Port::open(name, Baud::default().bits_per_s())?))
    }
}

impl heads::Port for NetworkPort {
    fn timing(&self, baud: Baud) -> Timing {
        Timing::patient(baud)
    }

    /// The vendor waits 50 ms for a reply, which is enough for an adapter. But this computer, or a
    /// simulated network on it, may delay the bytes for longer. After a late reply the line must be
    /// flushed.
    fn timing_of_known(&self, baud: Baud) -> Timing {
        Timing {
            reply_us: 250_000,
            tries: 5,
            ..self.timing(baud)
        }
    }

    fn elapsed_us(&self) -> u64 {
        self.0.elapsed_us()
    }

    fn set_baud(&mut self, baud: Baud) -> io::Result<()> {
        self.0.set_rate(baud.bits_per_s())
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.0.send(bytes)
    }

    fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
        self.0.receive(wait_us)
    }
}
