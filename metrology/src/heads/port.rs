//! Where the bytes of a line go.

use husillo_transports::nmc::{Baud, Timing};
use std::io;

/// A port with the time that passes at it: a serial device, a socket, a simulated line.
pub trait Port {
    /// The waits that suit the port at a rate.
    fn timing(&self, baud: Baud) -> Timing;

    /// The same once it is known who answers.
    fn timing_of_known(&self, baud: Baud) -> Timing {
        self.timing(baud)
    }

    /// Time since it was opened, us.
    fn elapsed_us(&self) -> u64;

    /// Goes on at another rate.
    ///
    /// # Errors
    ///
    /// The device refuses.
    fn set_baud(&mut self, baud: Baud) -> io::Result<()>;

    /// Sends bytes.
    ///
    /// # Errors
    ///
    /// The device is gone.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// What comes within some microseconds; returns as soon as there is something.
    ///
    /// # Errors
    ///
    /// The device is gone.
    fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>>;
}

impl<P: Port + ?Sized> Port for Box<P> {
    fn timing(&self, baud: Baud) -> Timing {
        (**self).timing(baud)
    }

    fn timing_of_known(&self, baud: Baud) -> Timing {
        (**self).timing_of_known(baud)
    }

    fn elapsed_us(&self) -> u64 {
        (**self).elapsed_us()
    }

    fn set_baud(&mut self, baud: Baud) -> io::Result<()> {
        (**self).set_baud(baud)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        (**self).send(bytes)
    }

    fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
        (**self).receive(wait_us)
    }
}
