//! A port: a serial device or a network socket.

use serialport::SerialPort;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// An open port, and the time since it was opened.
pub enum Port {
    /// A serial device.
    Serial(Box<dyn SerialPort>, Instant),
    /// A device server that forwards the bytes. It sets the rate of its serial line itself.
    Network(TcpStream, Instant),
}

/// Longest time to connect a socket.
const CONNECT: Duration = Duration::from_secs(5);

impl fmt::Debug for Port {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(port, _) => write!(f, "Serial({:?})", port.name()),
            Self::Network(socket, _) => write!(f, "Network({socket:?})"),
        }
    }
}

impl Port {
    /// Opens a serial device at a rate in bits/s or, with `tcp:HOST:PORT`, a socket.
    ///
    /// # Errors
    ///
    /// The port cannot be opened.
    pub fn open(name: &str, bits_per_s: u32) -> io::Result<Self> {
        if let Some(address) = name.strip_prefix("tcp:") {
            let mut last = io::Error::new(ErrorKind::InvalidInput, "no such address");
            for address in std::net::ToSocketAddrs::to_socket_addrs(address)? {
                match TcpStream::connect_timeout(&address, CONNECT) {
                    Ok(socket) => {
                        socket.set_nodelay(true)?;
                        return Ok(Self::Network(socket, Instant::now()));
                    }
                    Err(error) => last = advised(error),
                }
            }
            return Err(last);
        }
        match serialport::new(name, bits_per_s).open() {
            Ok(port) => Ok(Self::Serial(port, Instant::now())),
            // The library reports a locked port only in the description of the error. The system
            // reports a busy port by the kind of the error.
            Err(error) if error.description.contains("exclusive lock") => Err(taken()),
            Err(error) => match io::Error::from(error) {
                error if error.kind() == ErrorKind::ResourceBusy => Err(taken()),
                error => Err(advised(error)),
            },
        }
    }

    /// Another handle of the same port. It measures time from the same start.
    ///
    /// # Errors
    ///
    /// The system refuses.
    pub fn try_clone(&self) -> io::Result<Self> {
        match self {
            Self::Serial(port, start) => Ok(Self::Serial(port.try_clone()?, *start)),
            Self::Network(socket, start) => Ok(Self::Network(socket.try_clone()?, *start)),
        }
    }

    /// Time since the port was opened, us.
    pub fn elapsed_us(&self) -> u64 {
        match self {
            // 2^64 us are 584,000 years.
            Self::Serial(_, start) | Self::Network(_, start) => start.elapsed().as_micros() as u64,
        }
    }

    /// Sets the rate of a serial device, bits/s. A device server keeps its own rate.
    ///
    /// # Errors
    ///
    /// The device does not accept the rate.
    pub fn set_rate(&mut self, bits_per_s: u32) -> io::Result<()> {
        match self {
            Self::Serial(port, _) => Ok(port.set_baud_rate(bits_per_s)?),
            Self::Network(..) => Ok(()),
        }
    }

    /// Sends bytes.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Serial(port, _) => port.write_all(bytes),
            Self::Network(socket, _) => socket.write_all(bytes).map_err(closed),
        }
    }

    /// Waits at most `wait_us` for bytes. Returns as soon as any have arrived.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
        // The system rejects a time of zero.
        let wait = Duration::from_micros(u64::from(wait_us.max(1)));
        match self {
            Self::Serial(port, _) => {
                // The system waits in whole milliseconds.
                port.set_timeout(wait.max(Duration::from_millis(1)))?;
                read(port)
            }
            Self::Network(socket, _) => {
                socket.set_read_timeout(Some(wait))?;
                read(socket).map_err(closed)
            }
        }
    }
}

/// The error of a port that cannot be opened, with advice for the user.
fn advised(error: io::Error) -> io::Error {
    let why = match error.kind() {
        ErrorKind::NotFound => "there is no such port: check its name and its cable",
        ErrorKind::PermissionDenied => {
            "you may not open this port: on Linux join the group of the device, often `dialout`"
        }
        ErrorKind::ConnectionRefused => "no program listens at this address: start it first",
        ErrorKind::TimedOut => "nothing answers at this address: check it and the network",
        _ if error.to_string().contains("typewriter") => {
            "this is no serial port: name a device such as /dev/ttyUSB0, or tcp:HOST:PORT"
        }
        _ => return error,
    };
    io::Error::new(error.kind(), why)
}

fn taken() -> io::Error {
    io::Error::new(
        ErrorKind::ResourceBusy,
        "another program has this port open",
    )
}

/// The error of a socket. A server that serves one client at a time, as `husillo emulate` does,
/// closes the connection of a second client.
fn closed(error: io::Error) -> io::Error {
    match error.kind() {
        ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset | ErrorKind::BrokenPipe => {
            let message = "the other end closed the connection: is another client connected?";
            io::Error::new(error.kind(), message)
        }
        _ => error,
    }
}

/// Reads the bytes that have arrived. Returns none if the timeout of `from` expires.
///
/// # Errors
///
/// The connection is lost.
pub fn read(from: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut bytes = [0; 256];
    match from.read(&mut bytes) {
        Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
        Ok(count) => Ok(bytes.get(..count).unwrap_or_default().to_vec()),
        Err(error) => match error.kind() {
            ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted => Ok(Vec::new()),
            _ => Err(error),
        },
    }
}
