//! A serial line to a simulated device. Each byte takes its transmission time, in both directions.
//! The cable can be pulled, and a fault can hit one byte.

use std::collections::VecDeque;

/// Both directions of a serial line. Times are in microseconds.
#[derive(Debug)]
pub struct Line {
    byte_us: u64,
    there: Direction,
    back: Direction,
    is_plugged: bool,
    /// A fault, and the number of the byte that it hits. Bytes of both directions are counted
    /// together, from 0.
    pub fault: Option<(u64, LineFault)>,
    /// Number of bytes so far, in both directions.
    pub carried: u64,
}

/// A fault that hits one byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineFault {
    /// The byte does not arrive.
    Lost,
    /// The byte arrives twice.
    Doubled,
    /// This bit of the byte is flipped, 0 to 7.
    Flipped(u8),
    /// The byte is late by this time in us.
    Late(u64),
    /// The cable is pulled: neither this byte nor a later one arrives.
    Unplugged,
    /// The reset button is pressed, and the byte is lost.
    Reset,
}

/// One direction of the line.
#[derive(Debug, Default)]
struct Direction {
    /// Bytes on the line, with the time at which each is complete.
    bytes: VecDeque<(u64, u8)>,
    /// Time at which the line is free again.
    free_us: u64,
}

impl Direction {
    fn put(&mut self, byte: u8, byte_us: u64, now_us: u64) {
        self.free_us = self.free_us.max(now_us) + byte_us;
        self.bytes.push_back((self.free_us, byte));
    }

    fn take(&mut self, now_us: u64) -> Option<u8> {
        let (_, byte) = *self.bytes.front().filter(|(at, _)| *at <= now_us)?;
        self.bytes.pop_front();
        Some(byte)
    }
}

impl Line {
    /// Creates a line at a rate in bits/s. A byte takes ten bits.
    pub fn new(bits_per_s: u32) -> Self {
        Self {
            byte_us: u64::from(10_000_000 / bits_per_s.max(1)),
            there: Direction::default(),
            back: Direction::default(),
            is_plugged: true,
            fault: None,
            carried: 0,
        }
    }

    /// Puts a byte on the line. Returns whether its fault presses the reset button.
    fn carry(&mut self, is_there: bool, byte: u8, now_us: u64) -> bool {
        let fault = self.fault.filter(|(at, _)| *at == self.carried);
        let fault = fault.map(|(_, fault)| fault);
        self.carried += 1;
        if fault == Some(LineFault::Unplugged) {
            self.plug(false);
        }
        if !self.is_plugged || matches!(fault, Some(LineFault::Lost | LineFault::Reset)) {
            return fault == Some(LineFault::Reset);
        }
        let byte_us = self.byte_us;
        let direction = if is_there {
            &mut self.there
        } else {
            &mut self.back
        };
        match fault {
            Some(LineFault::Flipped(bit)) => {
                direction.put(byte ^ (1 << (bit & 7)), byte_us, now_us);
            }
            Some(LineFault::Late(us)) => direction.put(byte, byte_us, now_us + us),
            Some(LineFault::Doubled) => {
                direction.put(byte, byte_us, now_us);
                direction.put(byte, byte_us, now_us);
            }
            _ => direction.put(byte, byte_us, now_us),
        }
        false
    }

    /// Sends a byte to the device. Returns whether its fault presses the reset button.
    pub fn send(&mut self, byte: u8, now_us: u64) -> bool {
        self.carry(true, byte, now_us)
    }

    /// Number of bytes that have not arrived at the device yet.
    pub fn waiting(&self) -> usize {
        self.there.bytes.len()
    }

    /// Takes a byte that has arrived at the device.
    pub fn received(&mut self, now_us: u64) -> Option<u8> {
        self.there.take(now_us)
    }

    /// Time of the next change at the device's end after `now_us`: a byte arrives, or its
    /// transmitter becomes free.
    pub fn next_us(&self, now_us: u64) -> u64 {
        let arrives = self.there.bytes.front().map(|(at, _)| *at);
        let later = [arrives, Some(self.back.free_us)].into_iter().flatten();
        later.filter(|at| *at > now_us).min().unwrap_or(u64::MAX)
    }

    /// Whether the device's transmitter is free.
    pub fn is_free(&self, now_us: u64) -> bool {
        self.back.free_us <= now_us
    }

    /// Sends a byte from the device. Returns whether its fault presses the reset button.
    pub fn answer(&mut self, byte: u8, now_us: u64) -> bool {
        self.carry(false, byte, now_us)
    }

    /// Takes a byte that has arrived at the host.
    pub fn answered(&mut self, now_us: u64) -> Option<u8> {
        self.back.take(now_us)
    }

    /// Pulls the cable or plugs it in again. Bytes on the line are lost.
    pub fn plug(&mut self, is_plugged: bool) {
        self.is_plugged = is_plugged;
        self.there.bytes.clear();
        self.back.bytes.clear();
    }
}
