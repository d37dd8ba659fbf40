//! Where the bytes go: a serial device, a network socket.

use husillo_metrology::heads;
use husillo_transports::nmc::{Baud, Timing};
use serialport::SerialPort;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// A port, with the time that passes at it.
pub enum Port {
    /// A serial device.
    Serial(Box<dyn SerialPort>, Instant),
    /// A device server that passes the bytes on; the rate of its line is its own.
    Network(TcpStream, Instant),
}

/// The longest a socket may take to connect.
const CONNECT: Duration = Duration::from_secs(5);

impl Port {
    /// Opens a serial device or, with `tcp:HOST:PORT`, a socket.
    ///
    /// # Errors
    ///
    /// It cannot be opened.
    pub fn open(name: &str) -> io::Result<Self> {
        Self::open_at(name, Baud::default().bits_per_s())
    }

    /// The same at another rate.
    ///
    /// # Errors
    ///
    /// It cannot be opened.
    pub fn open_at(name: &str, bits_per_s: u32) -> io::Result<Self> {
        if let Some(address) = name.strip_prefix("tcp:") {
            let mut last = io::Error::new(ErrorKind::InvalidInput, "no such address");
            for address in std::net::ToSocketAddrs::to_socket_addrs(address)? {
                match TcpStream::connect_timeout(&address, CONNECT) {
                    Ok(socket) => {
                        socket.set_nodelay(true)?;
                        return Ok(Self::Network(socket, Instant::now()));
                    }
                    Err(error) => last = error,
                }
            }
            return Err(last);
        }
        match serialport::new(name, bits_per_s).open() {
            Ok(port) => Ok(Self::Serial(port, Instant::now())),
            // The library says it of its lock, the system of its own.
            Err(error) if error.description.contains("exclusive lock") => Err(taken()),
            Err(error) => match io::Error::from(error) {
                error if error.kind() == ErrorKind::ResourceBusy => Err(taken()),
                error => Err(error),
            },
        }
    }

    /// The same port once more, with the same time.
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

    /// Time since it was opened, us.
    pub fn elapsed_us(&self) -> u64 {
        match self {
            // 2^64 us are 584 000 years.
            Self::Serial(_, start) | Self::Network(_, start) => start.elapsed().as_micros() as u64,
        }
    }

    /// Sends bytes.
    ///
    /// # Errors
    ///
    /// The device is gone.
    pub fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Serial(port, _) => port.write_all(bytes),
            Self::Network(socket, _) => socket.write_all(bytes).map_err(closed),
        }
    }

    /// What comes within some microseconds; returns as soon as there is something.
    ///
    /// # Errors
    ///
    /// The device is gone.
    pub fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
        // Zero is no time to wait for the system.
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

impl heads::Port for Port {
    fn timing(&self, baud: Baud) -> Timing {
        Timing::patient(baud)
    }

    /// The vendor's 50 ms until a reply are enough for an adapter. But this computer, or a
    /// simulated chain on it, may delay the bytes for longer, and a late reply costs a flush.
    fn timing_of_known(&self, baud: Baud) -> Timing {
        Timing {
            reply_us: 250_000,
            tries: 5,
            ..self.timing(baud)
        }
    }

    fn elapsed_us(&self) -> u64 {
        self.elapsed_us()
    }

    fn set_baud(&mut self, baud: Baud) -> io::Result<()> {
        match self {
            Self::Serial(port, _) => Ok(port.set_baud_rate(baud.bits_per_s())?),
            Self::Network(..) => Ok(()),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.send(bytes)
    }

    fn receive(&mut self, wait_us: u32) -> io::Result<Vec<u8>> {
        self.receive(wait_us)
    }
}

fn taken() -> io::Error {
    io::Error::new(
        ErrorKind::ResourceBusy,
        "another program has this port open",
    )
}

/// The error of a socket. A server that serves one client at a time, as `husillo emulate` does,
/// closes the connection of a second one.
fn closed(error: io::Error) -> io::Error {
    match error.kind() {
        ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset | ErrorKind::BrokenPipe => {
            let message = "the other end closed the connection: is another client connected?";
            io::Error::new(error.kind(), message)
        }
        _ => error,
    }
}

/// What has come; nothing where the time ran out.
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
