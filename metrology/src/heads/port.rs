//! The port of a line.

use husillo_transports::nmc::{Baud, Timing};
use std::io;

/// A port with its clock: a serial device, a socket, or a simulated line.
pub trait Port {
    /// The waiting times for the port at a baud rate.
    fn timing(&self, baud: Baud) -> Timing;

    /// The waiting times after the start-up, when all modules are known.
    fn timing_of_known(&self, baud: Baud) -> Timing {
        self.timing(baud)
    }

    /// Time since the port was opened, us.
    fn elapsed_us(&self) -> u64;

    /// Changes the baud rate.
    ///
    /// # Errors
    ///
    /// The device refuses the rate.
    fn set_baud(&mut self, baud: Baud) -> io::Result<()>;

    /// Sends bytes.
    ///
    /// # Errors
    ///
    /// The device is gone.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Receives bytes for at most `wait_us` microseconds. Returns as soon as there are some.
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
