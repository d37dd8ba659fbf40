//! A half-duplex port on `embedded-hal-nb` 1.0, byte by byte.

use core::fmt;

use embedded_hal::digital::OutputPin;
use embedded_hal_nb::nb;
use embedded_hal_nb::serial::{Read, Write};

use super::{Echo, EnablePin, Heard};

/// The error of a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NbError<S, P> {
    /// The serial port's error.
    Serial(S),
    /// The pin's error.
    Pin(P),
    /// The received byte differs from the sent one. The driver is released. Do not send the rest.
    Collision,
}

impl<S: fmt::Debug, P: fmt::Debug> fmt::Display for NbError<S, P> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NbError::Serial(error) => write!(out, "serial port: {error:?}"),
            NbError::Pin(error) => write!(out, "driver-enable pin: {error:?}"),
            NbError::Collision => out.write_str("collision on the line"),
        }
    }
}

impl<S: fmt::Debug, P: fmt::Debug> core::error::Error for NbError<S, P> {}

/// A serial port with a transceiver. No function waits. `WouldBlock` means that the caller tries
/// again.
///
/// The caller observes the turnaround with [`Turnaround`](super::Turnaround) before the first byte.
#[derive(Debug)]
pub struct NbPort<S, P, const N: usize> {
    serial: S,
    enable: EnablePin<P>,
    echo: Echo<N>,
    is_driving: bool,
}

impl<S, P, const N: usize> NbPort<S, P, N>
where
    S: Read<u8> + Write<u8>,
    P: OutputPin,
{
    /// Takes the port, the pin and the known behaviour of the echo. The pin is written for the
    /// first time with the first byte, so the caller must release the line before.
    pub const fn new(serial: S, enable: EnablePin<P>, echo: Echo<N>) -> Self {
        NbPort {
            serial,
            enable,
            echo,
            is_driving: false,
        }
    }

    /// Drives the line and hands the byte to the transmitter.
    ///
    /// # Errors
    /// `WouldBlock` if the transmitter is full, or if the echoes of `N` bytes have not arrived yet.
    /// In this case read first.
    pub fn send(&mut self, byte: u8) -> nb::Result<(), NbError<S::Error, P::Error>> {
        if !self.is_driving {
            self.set_driving(true)?;
        }
        let before = self.echo;
        if !self.echo.sent(byte) {
            return Err(nb::Error::WouldBlock);
        }
        let written = self.serial.write(byte);
        if written.is_err() {
            self.echo = before; // it was not sent
        }
        written.map_err(|error| error.map(NbError::Serial))
    }

    /// Releases the line after the last stop bit. Call it again until it returns `Ok`, or call it
    /// once from the interrupt of transmission complete.
    ///
    /// # Errors
    /// `WouldBlock` while bytes are being sent.
    pub fn complete(&mut self) -> nb::Result<(), NbError<S::Error, P::Error>> {
        if !self.is_driving {
            return Ok(());
        }
        self.serial
            .flush()
            .map_err(|error| error.map(NbError::Serial))?;
        self.set_driving(false)
    }

    /// Returns a byte from the line. Returns `None` for the echo of one's own byte.
    ///
    /// # Errors
    /// `WouldBlock` if there is no byte. [`NbError::Collision`] if the byte should have been an
    /// echo. The line is then released.
    pub fn receive(&mut self) -> nb::Result<Option<u8>, NbError<S::Error, P::Error>> {
        let byte = self
            .serial
            .read()
            .map_err(|error| error.map(NbError::Serial))?;
        match self.echo.received(byte) {
            Heard::Foreign(byte) => Ok(Some(byte)),
            Heard::Echo => Ok(None),
            Heard::Collision => {
                self.set_driving(false)?;
                Err(nb::Error::Other(NbError::Collision))
            }
        }
    }

    /// Whether the line is driven.
    pub const fn is_driving(&self) -> bool {
        self.is_driving
    }

    /// Returns what is known about the echo.
    pub fn echo(&mut self) -> &mut Echo<N> {
        &mut self.echo
    }

    /// Returns port and pin.
    pub fn release(self) -> (S, P) {
        (self.serial, self.enable.release())
    }

    fn set_driving(&mut self, is_driving: bool) -> nb::Result<(), NbError<S::Error, P::Error>> {
        self.enable
            .set(is_driving)
            .map_err(|error| nb::Error::Other(NbError::Pin(error)))?;
        self.is_driving = is_driving;
        Ok(())
    }
}
