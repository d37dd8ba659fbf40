//! A half-duplex port on `embedded-io` 0.7, message by message.

use core::fmt;

use embedded_hal::digital::OutputPin;
use embedded_io::{Read, ReadReady, Write};

use super::{Echo, EnablePin, Heard};

/// The error of a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum IoError<S, P> {
    /// The serial port's error.
    Serial(S),
    /// The port took or gave no byte: it is closed.
    Closed,
    /// The pin's error.
    Pin(P),
    /// The received bytes differ from the sent ones. The message did not arrive.
    Collision,
}

impl<S: fmt::Debug, P: fmt::Debug> fmt::Display for IoError<S, P> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            IoError::Serial(error) => write!(out, "serial port: {error:?}"),
            IoError::Closed => out.write_str("serial port closed"),
            IoError::Pin(error) => write!(out, "driver-enable pin: {error:?}"),
            IoError::Collision => out.write_str("collision on the line"),
        }
    }
}

impl<S: fmt::Debug, P: fmt::Debug> core::error::Error for IoError<S, P> {}

/// A serial port with a transceiver. The `flush` of the port must return on transmission complete,
/// as `embedded-io` requires.
///
/// The caller observes the turnaround with [`Turnaround`](super::Turnaround) before a message.
#[derive(Debug)]
pub struct IoPort<S, P, const N: usize> {
    serial: S,
    enable: EnablePin<P>,
    echo: Echo<N>,
}

impl<S, P, const N: usize> IoPort<S, P, N>
where
    S: Read + Write + ReadReady,
    P: OutputPin,
{
    /// Takes the port, the pin and the known behaviour of the echo. The pin is written for the
    /// first time with the first message, so the caller must release the line before.
    pub const fn new(serial: S, enable: EnablePin<P>, echo: Echo<N>) -> Self {
        IoPort {
            serial,
            enable,
            echo,
        }
    }

    /// Sends a message and releases the line after its last stop bit, also after an error. It
    /// blocks until then. Echoes that arrive meanwhile are compared. A message longer than `N`
    /// needs a port that returns the echoes in time.
    ///
    /// # Errors
    /// [`IoError`]. After a collision the rest of the message is not sent.
    pub fn send(&mut self, message: &[u8]) -> Result<(), IoError<S::Error, P::Error>> {
        self.enable.set(true).map_err(IoError::Pin)?;
        let sent = self.write(message);
        let flushed = self.serial.flush().map_err(IoError::Serial);
        self.enable.set(false).map_err(IoError::Pin)?;
        sent.and(flushed)
    }

    /// Returns a byte from the line, if there is one. Echoes of one's own bytes are dropped.
    ///
    /// # Errors
    /// [`IoError`]. It is a collision if the byte should have been an echo.
    pub fn receive(&mut self) -> Result<Option<u8>, IoError<S::Error, P::Error>> {
        while self.serial.read_ready().map_err(IoError::Serial)? {
            match self.hear()? {
                Heard::Foreign(byte) => return Ok(Some(byte)),
                Heard::Collision => return Err(IoError::Collision),
                Heard::Echo => {}
            }
        }
        Ok(None)
    }

    /// Returns what is known about the echo.
    pub fn echo(&mut self) -> &mut Echo<N> {
        &mut self.echo
    }

    /// Returns port and pin.
    pub fn release(self) -> (S, P) {
        (self.serial, self.enable.release())
    }

    fn write(&mut self, message: &[u8]) -> Result<(), IoError<S::Error, P::Error>> {
        for byte in message {
            // Echoes make room for further bytes. During sending, a byte that was not sent is a
            // collision.
            while self.serial.read_ready().map_err(IoError::Serial)? {
                if self.hear()? != Heard::Echo {
                    self.echo.silence();
                    return Err(IoError::Collision);
                }
            }
            while !self.echo.sent(*byte) {
                if self.hear()? != Heard::Echo {
                    self.echo.silence();
                    return Err(IoError::Collision);
                }
            }
            match self.serial.write(&[*byte]) {
                Ok(0) => return Err(IoError::Closed),
                Ok(_) => {}
                Err(error) => return Err(IoError::Serial(error)),
            }
        }
        Ok(())
    }

    fn hear(&mut self) -> Result<Heard, IoError<S::Error, P::Error>> {
        let mut byte = [0];
        match self.serial.read(&mut byte) {
            Ok(0) => Err(IoError::Closed),
            Ok(_) => {
                let [byte] = byte;
                Ok(self.echo.received(byte))
            }
            Err(error) => Err(IoError::Serial(error)),
        }
    }
}
