//! A serial line to a simulated device: bytes take their time in both directions, and the cable may
//! be pulled.

use std::collections::VecDeque;

/// Two directions of a line; times in microseconds.
pub struct Line {
    byte_us: u64,
    there: Direction,
    back: Direction,
    is_plugged: bool,
    /// What happens to the byte of this number, counted in both directions.
    #[cfg(test)]
    pub fault: Option<(u64, Fault)>,
    #[cfg(test)]
    pub carried: u64,
}

/// What happens to a byte.
#[cfg(test)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    Lost,
    Doubled,
    Flipped(u8),
    /// By so many microseconds.
    Late(u64),
    /// From here on no byte gets through.
    Unplugged,
    /// The button R.
    Reset,
}

#[derive(Default)]
struct Direction {
    /// Bytes on the line, with the time at which each is complete.
    bytes: VecDeque<(u64, u8)>,
    /// When it is free again.
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
    /// At so many bits a second, ten a byte.
    pub fn new(bits_per_s: u32) -> Self {
        Self {
            byte_us: u64::from(10_000_000 / bits_per_s.max(1)),
            there: Direction::default(),
            back: Direction::default(),
            is_plugged: true,
            #[cfg(test)]
            fault: None,
            #[cfg(test)]
            carried: 0,
        }
    }

    /// Puts a byte on the line; whether that presses the button.
    #[cfg(test)]
    fn carry(&mut self, is_there: bool, byte: u8, now_us: u64) -> bool {
        let fault = self.fault.filter(|(at, _)| *at == self.carried);
        let fault = fault.map(|(_, fault)| fault);
        self.carried += 1;
        if fault == Some(Fault::Unplugged) {
            self.plug(false);
        }
        if !self.is_plugged || matches!(fault, Some(Fault::Lost | Fault::Reset)) {
            return fault == Some(Fault::Reset);
        }
        let byte_us = self.byte_us;
        let direction = if is_there {
            &mut self.there
        } else {
            &mut self.back
        };
        match fault {
            Some(Fault::Flipped(bit)) => direction.put(byte ^ (1 << bit), byte_us, now_us),
            Some(Fault::Late(us)) => direction.put(byte, byte_us, now_us + us),
            Some(Fault::Doubled) => {
                direction.put(byte, byte_us, now_us);
                direction.put(byte, byte_us, now_us);
            }
            _ => direction.put(byte, byte_us, now_us),
        }
        false
    }

    #[cfg(not(test))]
    fn carry(&mut self, is_there: bool, byte: u8, now_us: u64) -> bool {
        if self.is_plugged {
            let direction = if is_there {
                &mut self.there
            } else {
                &mut self.back
            };
            direction.put(byte, self.byte_us, now_us);
        }
        false
    }

    /// A byte to the device; whether the button is pressed by it, in tests.
    pub fn send(&mut self, byte: u8, now_us: u64) -> bool {
        self.carry(true, byte, now_us)
    }

    /// A byte that has arrived at the device.
    pub fn received(&mut self, now_us: u64) -> Option<u8> {
        self.there.take(now_us)
    }

    /// When something happens next at the device's end after now: a byte arrives there, or its
    /// transmitter is free again.
    pub fn next_us(&self, now_us: u64) -> u64 {
        let arrives = self.there.bytes.front().map(|(at, _)| *at);
        let later = [arrives, Some(self.back.free_us)].into_iter().flatten();
        later.filter(|at| *at > now_us).min().unwrap_or(u64::MAX)
    }

    /// Whether the device's transmitter is free.
    pub fn is_free(&self, now_us: u64) -> bool {
        self.back.free_us <= now_us
    }

    /// A byte from the device; the same.
    pub fn answer(&mut self, byte: u8, now_us: u64) -> bool {
        self.carry(false, byte, now_us)
    }

    /// A byte that has arrived at the host.
    pub fn answered(&mut self, now_us: u64) -> Option<u8> {
        self.back.take(now_us)
    }

    /// Pulls the cable, or puts it in again; what is on the line is lost.
    pub fn plug(&mut self, in_: bool) {
        self.is_plugged = in_;
        self.there.bytes.clear();
        self.back.bytes.clear();
    }
}
