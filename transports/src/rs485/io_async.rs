//! A half-duplex port on `embedded-io-async` 0.7, message by message.

use embedded_hal::digital::OutputPin;
use embedded_io_async::{Read, ReadReady, Write};

use super::{Echo, EnablePin, Heard, IoError};

/// As [`IoPort`](super::IoPort), for a task: other tasks run while bytes are sent or awaited. The
/// `flush` of the port must return on transmission complete, as `embedded-io-async` requires.
///
/// The caller observes the turnaround with [`Turnaround`](super::Turnaround) before a message.
#[derive(Debug)]
pub struct AsyncIoPort<S, P, const N: usize> {
    serial: S,
    enable: EnablePin<P>,
    echo: Echo<N>,
}

/// Drives the line until it is dropped.
struct Driving<'a, P: OutputPin, const N: usize> {
    /// `None` after the end of the message.
    enable: Option<&'a mut EnablePin<P>>,
    echo: &'a mut Echo<N>,
}

impl<P: OutputPin, const N: usize> Driving<'_, P, N> {
    fn release(mut self) -> Result<(), P::Error> {
        self.enable
            .take()
            .map_or(Ok(()), |enable| enable.set(false))
    }
}

impl<P: OutputPin, const N: usize> Drop for Driving<'_, P, N> {
    fn drop(&mut self) {
        if let Some(enable) = self.enable.take() {
            enable.set(false).ok();
            // It is unknown which bytes have been sent. One that has not would never be heard.
            self.echo.silence();
        }
    }
}

impl<S, P, const N: usize> AsyncIoPort<S, P, N>
where
    S: Read + Write + ReadReady,
    P: OutputPin,
{
    /// Takes the port, the pin and the known behaviour of the echo. The pin is written for the
    /// first time with the first message, so the caller must release the line before.
    pub const fn new(serial: S, enable: EnablePin<P>, echo: Echo<N>) -> Self {
        AsyncIoPort {
            serial,
            enable,
            echo,
        }
    }

    /// Sends a message and releases the line after its last stop bit, also after an error. Echoes
    /// that arrive meanwhile are compared. A message longer than `N` needs a port that returns the
    /// echoes in time.
    ///
    /// A dropped future releases the line at once, so that no other station is blocked. The message
    /// is then cut, and bytes that the port has buffered are lost. As after a collision, bytes
    /// received until the line is silent are invalid: they may be echoes.
    ///
    /// # Errors
    /// [`IoError`]. After a collision the rest of the message is not sent.
    pub async fn send(&mut self, message: &[u8]) -> Result<(), IoError<S::Error, P::Error>> {
        self.enable.set(true).map_err(IoError::Pin)?;
        let driving = Driving {
            enable: Some(&mut self.enable),
            echo: &mut self.echo,
        };
        let sent = write(&mut self.serial, driving.echo, message).await;
        let flushed = self.serial.flush().await.map_err(IoError::Serial);
        driving.release().map_err(IoError::Pin)?;
        sent.and(flushed)
    }

    /// Waits for a byte from the line. Echoes of one's own bytes are dropped. For a time limit,
    /// drop the future: a byte is not lost if the port keeps bytes that it has not given.
    ///
    /// # Errors
    /// [`IoError`]. It is a collision if the byte should have been an echo.
    pub async fn receive(&mut self) -> Result<u8, IoError<S::Error, P::Error>> {
        loop {
            let mut byte = [0];
            let read = self.serial.read(&mut byte).await;
            match heard(read, byte[0], &mut self.echo)? {
                Heard::Foreign(byte) => return Ok(byte),
                Heard::Collision => return Err(IoError::Collision),
                Heard::Echo => {}
            }
        }
    }

    /// Returns what is known about the echo.
    pub fn echo(&mut self) -> &mut Echo<N> {
        &mut self.echo
    }

    /// Returns port and pin.
    pub fn release(self) -> (S, P) {
        (self.serial, self.enable.release())
    }
}

async fn write<S: Read + Write + ReadReady, E, const N: usize>(
    serial: &mut S,
    echo: &mut Echo<N>,
    message: &[u8],
) -> Result<(), IoError<S::Error, E>> {
    for byte in message {
        // Echoes make room for further bytes. During sending, a byte that was not sent is a
        // collision.
        loop {
            let is_ready = serial.read_ready().map_err(IoError::Serial)?;
            if !is_ready && echo.sent(*byte) {
                break;
            }
            let mut heard_byte = [0];
            let read = serial.read(&mut heard_byte).await;
            if heard(read, heard_byte[0], echo)? != Heard::Echo {
                echo.silence();
                return Err(IoError::Collision);
            }
        }
        match serial.write(&[*byte]).await {
            Ok(0) => return Err(IoError::Closed),
            Ok(_) => {}
            Err(error) => return Err(IoError::Serial(error)),
        }
    }
    Ok(())
}

/// What a read has given.
fn heard<S, E, const N: usize>(
    read: Result<usize, S>,
    byte: u8,
    echo: &mut Echo<N>,
) -> Result<Heard, IoError<S, E>> {
    match read {
        Ok(0) => Err(IoError::Closed),
        Ok(_) => Ok(echo.received(byte)),
        Err(error) => Err(IoError::Serial(error)),
    }
}
