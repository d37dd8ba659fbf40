//! Where the bytes of a client go: a simulated device, a serial device, a socket.

use crate::link::emulation::Emulation;
use crate::link::port::Port;
use crate::link::stop::stops_asked;
use std::collections::VecDeque;
use std::io::{self, BufRead};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Ctrl-C is looked for so often while a line is typed.
const LOOK: Duration = Duration::from_millis(50);

/// A wire to a device or to a simulated one, with the time that passes on it.
pub enum Wire<E> {
    /// A device in simulated time: ns since the beginning.
    Simulated {
        device: Box<E>,
        ns: u64,
        answers: VecDeque<u8>,
    },
    /// A device of its own.
    Real { port: Port, answers: VecDeque<u8> },
}

impl<E: Emulation> Wire<E> {
    /// To a simulated device.
    pub fn simulated(device: E) -> Self {
        Self::Simulated {
            device: Box::new(device),
            ns: 0,
            answers: VecDeque::new(),
        }
    }

    /// To a serial device at so many bits a second, or `tcp:HOST:PORT`.
    ///
    /// # Errors
    ///
    /// It cannot be opened.
    pub fn open(name: &str, bits_per_s: u32) -> io::Result<Self> {
        Ok(Self::Real {
            port: Port::open_at(name, bits_per_s)?,
            answers: VecDeque::new(),
        })
    }

    /// The same wire to the same device once more; bytes come to whoever reads them first.
    ///
    /// # Errors
    ///
    /// The port cannot be shared; a simulated one is not.
    pub fn try_clone(&self) -> io::Result<Self> {
        match self {
            Self::Simulated { .. } => Err(io::ErrorKind::Unsupported.into()),
            Self::Real { port, .. } => Ok(Self::Real {
                port: port.try_clone()?,
                answers: VecDeque::new(),
            }),
        }
    }

    /// Time since it was opened.
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
    /// The device is gone.
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
    /// The device is gone.
    pub fn send_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::Simulated { device, .. } => {
                bytes.iter().for_each(|byte| device.send(*byte));
                Ok(())
            }
            Self::Real { port, .. } => port.send(bytes),
        }
    }

    /// All bytes that have come, the first one within a time.
    ///
    /// # Errors
    ///
    /// The device is gone.
    pub fn receive_all(&mut self, within: Duration) -> io::Result<Vec<u8>> {
        let first = self.receive(within)?;
        Ok(first.into_iter().chain(self.answers().drain(..)).collect())
    }

    /// The next byte that comes within a time.
    ///
    /// # Errors
    ///
    /// The device is gone.
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
                } => {
                    *ns += E::PERIOD_NS;
                    answers.extend(device.tick());
                }
                Self::Real { port, answers } => {
                    // A jog of an hour in one wait is below 2^32 us.
                    let wait = u32::try_from(left.as_micros()).unwrap_or(u32::MAX);
                    answers.extend(port.receive(wait)?);
                }
            }
        }
    }

    /// What a simulated device has told; a real one has a panel of its own.
    pub fn told(&mut self) -> Vec<String> {
        match self {
            Self::Simulated { device, .. } => device.tell(),
            Self::Real { .. } => Vec::new(),
        }
    }

    fn answers(&mut self) -> &mut VecDeque<u8> {
        match self {
            Self::Simulated { answers, .. } | Self::Real { answers, .. } => answers,
        }
    }
}

/// The next line of standard input; `None` where that has ended, or Ctrl-C was pressed more often
/// than [`stops_asked`] said before the operator was asked.
pub fn typed_line(before: u32) -> Option<String> {
    static TYPED: Mutex<Option<Receiver<String>>> = Mutex::new(None);
    let mut typed = TYPED.lock().unwrap_or_else(PoisonError::into_inner);
    // A line that is waited for is not interrupted by Ctrl-C: so another thread waits.
    let typed = typed.get_or_insert_with(typed_lines);
    loop {
        match typed.recv_timeout(LOOK) {
            Ok(line) => return Some(line),
            Err(RecvTimeoutError::Disconnected) => return None,
            Err(RecvTimeoutError::Timeout) if stops_asked() > before => return None,
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// The lines of standard input as they are typed; none any more where it has ended.
pub fn typed_lines() -> Receiver<String> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    receiver
}
