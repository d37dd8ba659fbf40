//! Command packets: encoded, and decoded byte by byte.
//!
//! ```text
//!  AA | address | (n << 4) + code | n data bytes, 0..=15 | sum of all but AA, modulo 256
//! ```

use crate::buffer::Buffer;

/// First byte of every command packet. Inside a packet it is data, because there is no stuffing.
pub const HEADER: u8 = 0xAA;

/// Data bytes of the longest command.
pub const LONGEST_DATA: usize = 15;

/// Bytes of the longest command packet.
pub const LONGEST_FRAME: usize = LONGEST_DATA + 4;

/// A command packet ready to be sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame(Buffer<LONGEST_FRAME>);

impl Frame {
    /// Creates the packet for `address` from the low four bits of `code` and the first 15 bytes of
    /// `data`.
    pub fn new(address: u8, code: u8, data: &[u8]) -> Frame {
        let data = data.get(..LONGEST_DATA).unwrap_or(data);
        let command = ((data.len() as u8) << 4) | (code & 0x0F); // the length is below 16
        let mut bytes = Buffer::new();
        bytes.extend(&[HEADER, address, command]);
        bytes.extend(data);
        bytes.push(sum(data, address.wrapping_add(command)));
        Frame(bytes)
    }

    /// Returns the bytes from header to sum, 4 to 19.
    pub fn bytes(&self) -> &[u8] {
        self.0.bytes()
    }
}

/// The sum of `start` and all `bytes`, modulo 256.
pub(crate) fn sum(bytes: &[u8], start: u8) -> u8 {
    bytes
        .iter()
        .fold(start, |sum, byte| sum.wrapping_add(*byte))
}

/// Whether a complete packet is valid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Verdict {
    /// Its sum is right.
    Sound,
    /// Its sum is wrong.
    Damaged,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Outside of a packet. All bytes except the header are ignored.
    Idle,
    Address,
    Command,
    /// This many data bytes are missing, at least one.
    Data(u8),
    Sum,
}

/// Takes bytes and finds packets for any address. A module must also follow the packets for other
/// modules.
///
/// The receiver has no time limit. A packet that lost a byte takes bytes of the following packets
/// until it is complete. The flush of the host completes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Receiver {
    state: State,
    address: u8,
    command: u8,
    sum: u8,
    data: Buffer<LONGEST_DATA>,
}

impl Receiver {
    /// Creates a receiver outside of a packet.
    pub const fn new() -> Receiver {
        Receiver {
            state: State::Idle,
            address: 0,
            command: 0,
            sum: 0,
            data: Buffer::new(),
        }
    }

    /// Takes a byte. Returns `Some` if it completes a packet. [`address`](Self::address),
    /// [`code`](Self::code) and [`data`](Self::data) describe the packet until the next byte.
    pub fn push(&mut self, byte: u8) -> Option<Verdict> {
        match self.state {
            State::Idle => {
                if byte == HEADER {
                    self.state = State::Address;
                }
            }
            State::Address => {
                self.address = byte;
                self.sum = byte;
                self.state = State::Command;
            }
            State::Command => {
                self.command = byte;
                self.sum = self.sum.wrapping_add(byte);
                self.data.clear();
                self.state = match byte >> 4 {
                    0 => State::Sum,
                    missing => State::Data(missing),
                };
            }
            State::Data(missing) => {
                self.data.push(byte); // 15 at most
                self.sum = self.sum.wrapping_add(byte);
                self.state = if missing <= 1 {
                    State::Sum
                } else {
                    State::Data(missing - 1) // it is above 1
                };
            }
            State::Sum => {
                self.state = State::Idle;
                return Some(if byte == self.sum {
                    Verdict::Sound
                } else {
                    Verdict::Damaged
                });
            }
        }
        None
    }

    /// Drops an incomplete packet.
    pub fn reset(&mut self) {
        self.state = State::Idle;
    }

    /// Whether the receiver is outside of a packet.
    pub fn is_idle(&self) -> bool {
        self.state == State::Idle
    }

    /// Returns the address of the last packet.
    pub const fn address(&self) -> u8 {
        self.address
    }

    /// Returns the code of the last packet, 0 to 15.
    pub const fn code(&self) -> u8 {
        self.command & 0x0F
    }

    /// Returns the data of the last packet.
    pub fn data(&self) -> &[u8] {
        self.data.bytes()
    }
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}
