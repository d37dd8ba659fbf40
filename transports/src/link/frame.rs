//! Frames to bytes and back.

use crc::{CRC_16_IBM_SDLC, Crc, Table};

use super::PAYLOAD_BYTES;
use crate::buffer::Buffer;

/// Address, control, sequence.
const HEAD_BYTES: usize = 3;

/// Head, payload, check.
const BODY_BYTES: usize = HEAD_BYTES + PAYLOAD_BYTES + 2;

/// A whole frame on the line: the first distance, the body, and the zero at its end.
pub(super) const WIRE_BYTES: usize = BODY_BYTES + 2;

// All distances of COBS are then below 255. The value 255, which stands for a run without a zero,
// does not occur.
const _: () = assert!(BODY_BYTES < 254);

const CHECK: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_IBM_SDLC);

/// The kind of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Kind {
    /// A numbered payload.
    Data,
    /// Only the number of the last accepted frame. Sent by a master, it is a question.
    Acknowledge,
    /// The number of the last accepted frame. The frame after it was missing and must be sent
    /// again.
    Gap,
    /// A call and its answer. Both ends restart their numbers. A call without payload means that
    /// the station has restarted and waits for a call.
    Call,
}

impl Kind {
    const fn bits(self) -> u8 {
        match self {
            Kind::Data => 0,
            Kind::Acknowledge => 1,
            Kind::Gap => 2,
            Kind::Call => 3,
        }
    }

    const fn of(bits: u8) -> Option<Kind> {
        Some(match bits {
            0 => Kind::Data,
            1 => Kind::Acknowledge,
            2 => Kind::Gap,
            3 => Kind::Call,
            _ => return None,
        })
    }
}

/// A frame, without its encoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Frame<'a> {
    /// Address of the station that sends or receives the frame, or [`BROADCAST`](super::BROADCAST).
    pub address: u8,
    /// Its kind.
    pub kind: Kind,
    /// Whether a station sends it.
    pub from_station: bool,
    /// From a master: the number of its last broadcast, 1 to 7, or 0 if there was none. From a
    /// station: the same number if it received that broadcast, otherwise 0.
    pub broadcast: u8,
    /// Its number, 0 to 15. A broadcast has 1 to 7. A frame without data has 0.
    pub number: u8,
    /// The number of the last accepted frame, 0 to 15.
    pub acknowledged: u8,
    /// Its payload, up to [`PAYLOAD_BYTES`].
    pub payload: &'a [u8],
}

impl<'a> Frame<'a> {
    /// Returns the frame as bytes of the line. Returns `None` if the payload is too long. Numbers
    /// are taken modulo 16, the number of the broadcast modulo 8.
    ///
    /// # Examples
    /// ```
    /// use husillo_transports::link::{Frame, Kind};
    ///
    /// let frame = Frame {
    ///     address: 1,
    ///     kind: Kind::Data,
    ///     from_station: false,
    ///     broadcast: 0,
    ///     number: 1,
    ///     acknowledged: 0,
    ///     payload: &[0, 7],
    /// };
    /// assert_eq!(frame.encode().unwrap().bytes(), [2, 1, 2, 0x10, 4, 7, 0x19, 0x35, 0]);
    /// ```
    pub fn encode(&self) -> Option<Sent> {
        if self.payload.len() > PAYLOAD_BYTES {
            return None;
        }
        let flags = u8::from(self.from_station) | (self.broadcast & 7) << 1;
        let mut body = Buffer::<BODY_BYTES>::new();
        body.push(self.address);
        body.push(self.kind.bits() << 4 | flags);
        body.push((self.number & 15) << 4 | self.acknowledged & 15);
        body.extend(self.payload);
        body.extend(&CHECK.checksum(body.bytes()).to_le_bytes());
        let mut wire = Buffer::new();
        // Each zero becomes the distance to the next one. All distances are below 255: see
        // `WIRE_BYTES`.
        for run in body.bytes().split(|byte| *byte == 0) {
            wire.push((run.len() as u8).wrapping_add(1));
            wire.extend(run);
        }
        wire.push(0);
        Some(Sent { wire, next: 0 })
    }

    /// Reads the frame of a body with its check. Returns `None` if the check or the content is
    /// wrong.
    fn of(body: &'a [u8]) -> Option<Frame<'a>> {
        let (checked, check) = body.split_last_chunk::<2>()?;
        if CHECK.checksum(checked) != u16::from_le_bytes(*check) {
            return None;
        }
        let (&[address, control, sequence], payload) = checked.split_first_chunk::<HEAD_BYTES>()?;
        Some(Frame {
            address,
            kind: Kind::of(control >> 4)?,
            from_station: control & 1 != 0,
            broadcast: control >> 1 & 7,
            number: sequence >> 4,
            acknowledged: sequence & 15,
            payload,
        })
    }
}

/// A frame that is being sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sent {
    wire: Buffer<WIRE_BYTES>,
    next: usize,
}

impl Sent {
    /// Returns all of its bytes.
    pub fn bytes(&self) -> &[u8] {
        self.wire.bytes()
    }

    /// Returns the next byte to send. Returns `None` if all bytes are sent.
    pub fn transmit(&mut self) -> Option<u8> {
        let byte = self.wire.bytes().get(self.next).copied()?;
        self.next = self.next.wrapping_add(1); // at most WIRE_BYTES
        Some(byte)
    }
}

/// Converts bytes to frames. A zero begins a new frame, whatever came before it.
///
/// A byte costs one or two comparisons. The check is made at the end of a frame. The size is 144
/// bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Receiver {
    body: Buffer<BODY_BYTES>,
    /// Number of bytes up to the next distance. 0: the next byte is a distance.
    run: u8,
    state: State,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// No byte has arrived since the last zero.
    Empty,
    Filling,
    /// The frame is too long. Bytes are dropped up to the next zero.
    Skipping,
    /// The body was returned.
    Given,
}

impl Receiver {
    /// Creates a receiver at the beginning of a frame.
    pub const fn new() -> Receiver {
        Receiver {
            body: Buffer::new(),
            run: 0,
            state: State::Empty,
        }
    }

    /// Takes a byte and returns the frame that it completes, if the check of the frame is right. A
    /// wrong frame is dropped silently, because its address may be wrong as well.
    pub fn push(&mut self, byte: u8) -> Option<Frame<'_>> {
        if self.state == State::Given {
            *self = Receiver::new();
        }
        if byte == 0 {
            let is_whole = self.state == State::Filling && self.run == 0;
            self.state = State::Given;
            return if is_whole {
                Frame::of(self.body.bytes())
            } else {
                None
            };
        }
        match self.state {
            State::Skipping => {}
            _ if self.run > 0 => {
                self.run = self.run.wrapping_sub(1); // above zero
                self.take(byte);
            }
            state => {
                // This byte is a distance. Each distance except the first one stands for a zero
                // before it.
                self.run = byte.wrapping_sub(1); // above zero
                if state == State::Filling {
                    self.take(0);
                }
                if self.state == State::Empty {
                    self.state = State::Filling;
                }
            }
        }
        None
    }

    fn take(&mut self, byte: u8) {
        if self.body.bytes().len() < BODY_BYTES {
            self.body.push(byte);
        } else {
            self.state = State::Skipping;
        }
    }
}

impl Default for Receiver {
    fn default() -> Self {
        Receiver::new()
    }
}
