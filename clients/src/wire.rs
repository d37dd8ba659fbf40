//! The connection of a client: to a simulated device, a serial device or a socket.

use crate::Port;
use husillo_sim::device::Emulation;
use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};

/// A connection to a device, and the time since it was opened.
#[derive(Debug)]
pub enum Wire<E> {
    /// A simulated device. Its time passes only while a client waits, at any speed or at that of a
    /// `Pace`.
    Simulated {
        /// The device.
        device: Box<E>,
        /// Simulated time, ns.
        ns: u64,
        /// Bytes that are received and not yet read.
        answers: VecDeque<u8>,
        /// The speed of its time. `None`: as fast as it is computed.
        pace: Option<Pace>,
    },
    /// A device at a port.
    Real {
        /// The port.
        port: Port,
        /// Bytes that are received and not yet read.
        answers: VecDeque<u8>,
    },
}

impl<E: Emulation> Wire<E> {
    /// Connects to a simulated device.
    pub fn simulated(device: E) -> Self {
        Self::Simulated {
            device: Box::new(device),
            ns: 0,
            answers: VecDeque::new(),
            pace: None,
        }
    }

    /// Connects to a simulated device whose time passes `speed` times as fast as real time.
    pub fn paced(device: E, speed: f64) -> Self {
        Self::Simulated {
            device: Box::new(device),
            ns: 0,
            answers: VecDeque::new(),
            pace: Some(Pace::new(speed)),
        }
    }

    /// Opens a serial device at a rate in bits/s, or the socket `tcp:HOST:PORT`.
    ///
    /// # Errors
    ///
    /// The port cannot be opened.
    pub fn open(name: &str, bits_per_s: u32) -> io::Result<Self> {
        Ok(Self::Real {
            port: Port::open(name, bits_per_s)?,
            answers: VecDeque::new(),
        })
    }

    /// Another connection to the same device. A received byte goes to the connection that reads
    /// first.
    ///
    /// # Errors
    ///
    /// The port cannot be shared. A simulated device can never be shared.
    pub fn try_clone(&self) -> io::Result<Self> {
        match self {
            Self::Simulated { .. } => Err(io::ErrorKind::Unsupported.into()),
            Self::Real { port, .. } => Ok(Self::Real {
                port: port.try_clone()?,
                answers: VecDeque::new(),
            }),
        }
    }

    /// Time since the connection was opened.
    pub fn elapsed(&self) -> Duration {
        match self {
            Self::Simulated { ns, .. } => Duration::from_nanos(*ns),
            Self::Real { port, .. } => Duration::from_micros(port.elapsed_us()),
        }
    }

    /// Sends a byte.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub fn send(&mut self, byte: u8) -> io::Result<()> {
        match self {
            Self::Simulated { device, .. } => {
                device.send(byte);
                Ok(())
            }
            Self::Real { port, .. } => port.send(&[byte]),
        }
    }

    /// Sends bytes.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub fn send_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Simulated { device, .. } => {
                bytes.iter().for_each(|byte| device.send(*byte));
                Ok(())
            }
            Self::Real { port, .. } => port.send(bytes),
        }
    }

    /// Waits for a byte, at most for the time `within`. Returns all bytes received.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub fn receive_all(&mut self, within: Duration) -> io::Result<Vec<u8>> {
        let first = self.receive(within)?;
        Ok(first.into_iter().chain(self.answers().drain(..)).collect())
    }

    /// Waits for the next byte, at most for the time `within`. Returns `None` if none arrives.
    ///
    /// # Errors
    ///
    /// The connection is lost.
    pub fn receive(&mut self, within: Duration) -> io::Result<Option<u8>> {
        let end = self.elapsed() + within;
        loop {
            if let Some(byte) = self.answers().pop_front() {
                return Ok(Some(byte));
            }
            if self.elapsed() >= end {
                return Ok(None);
            }
            let left = end - self.elapsed();
            match self {
                Self::Simulated {
                    device,
                    ns,
                    answers,
                    pace,
                } => {
                    *ns += E::PERIOD_NS;
                    answers.extend(device.tick());
                    if let Some(pace) = pace {
                        pace.wait(*ns);
                    }
                }
                Self::Real { port, answers } => {
                    // A wait of one hour, as for a jog, is below 2^32 us.
                    let wait = u32::try_from(left.as_micros()).unwrap_or(u32::MAX);
                    answers.extend(port.receive(wait)?);
                }
            }
        }
    }

    /// The reports of a simulated device since the last call. A real device shows its reports on
    /// its panel, so it has none here.
    pub fn take_reports(&mut self) -> Vec<String> {
        match self {
            Self::Simulated { device, .. } => device.take_reports(),
            Self::Real { .. } => Vec::new(),
        }
    }

    fn answers(&mut self) -> &mut VecDeque<u8> {
        match self {
            Self::Simulated { answers, .. } | Self::Real { answers, .. } => answers,
        }
    }
}

/// The speed of simulated time.
#[derive(Debug)]
pub struct Pace {
    speed: f64,
    start: Instant,
}

/// Simulated time may run ahead of real time by this much, so that a wait is not too short for the
/// system.
const AHEAD: Duration = Duration::from_millis(4);
/// After a longer pause, or on a computer that is too slow, the lost time is not made up.
const BEHIND: Duration = Duration::from_millis(500);

impl Pace {
    /// Simulated time that passes `speed` times as fast as real time, from now on.
    fn new(speed: f64) -> Self {
        Self {
            speed,
            start: Instant::now(),
        }
    }

    /// Waits while simulated time is ahead.
    fn wait(&mut self, simulated_ns: u64) {
        let due = Duration::from_secs_f64(simulated_ns as f64 / 1e9 / self.speed);
        let passed = self.start.elapsed();
        if due > passed + AHEAD {
            std::thread::sleep(due - passed);
        } else if passed > due + BEHIND {
            self.start += passed - due;
        }
    }
}
