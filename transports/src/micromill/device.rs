//! The controller's end of the line.

use super::{Answer, Axis, Order, STRING_BYTES, State, Stops};
use crate::buffer::Buffer;

/// Room that is kept for echoes and answers, in bytes.
const RESERVE: usize = 8;

/// The controller's end of the mill's line: bytes in, [`Order`]s out; echoes, steps and answers
/// out. `OUT` bytes wait for the transmitter.
///
/// | when | call |
/// | --- | --- |
/// | a byte arrives | [`push`](Device::push), which may return an order |
/// | a motion begins or ends | [`set_motion`](Device::set_motion) |
/// | a motor step was made | [`step`](Device::step), if it [`has_room`](Device::has_room) |
/// | an order was executed, or refused | [`answer`](Device::answer) |
/// | the state is asked for | [`report`](Device::report) |
/// | the transmitter is free | [`transmit`](Device::transmit) |
///
/// The link itself confirms [`Order::Stream`] and [`Order::Every`]. Memory: `OUT` and about 100
/// bytes.
#[derive(Debug, Clone)]
pub struct Device<const OUT: usize> {
    string: Buffer<STRING_BYTES>,
    motion: Motion,
    /// Whether a motion needs no strings of the host. Otherwise [`Order::Renew`] may arrive at any
    /// time.
    is_unattended: bool,
    is_streaming: bool,
    /// One step in this many is reported. 0: none.
    every: u16,
    /// Steps of each axis since the last report, fewer than `every`.
    unreported: [i16; 3],
    out: [u8; OUT],
    /// Below `OUT`.
    first: usize,
    /// At most `OUT`.
    waiting: usize,
}

/// The kind of motion, which decides the bytes that stop it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Motion {
    None,
    /// A jog. `W;`, `V;` and `L;` do not stop it.
    Jog,
    /// Another motion. Any byte stops it, unless lines are streamed. With a lease it is stopped
    /// like a jog.
    Other,
}

impl<const OUT: usize> Device<OUT> {
    /// Creates a device after a reset: it sends [`Answer::Ready`].
    pub fn new() -> Self {
        const { assert!(OUT > 2 * RESERVE, "room for echoes, answers and steps") };
        let mut device = Device {
            string: Buffer::new(),
            motion: Motion::None,
            is_unattended: true,
            is_streaming: false,
            every: 1,
            unreported: [0; 3],
            out: [0; OUT],
            first: 0,
            waiting: 0,
        };
        device.answer(Answer::Ready);
        device
    }

    /// Takes a byte from the line and returns the order that it completes. Returns [`Order::Stop`]
    /// if the byte stops the motion. While nothing moves, only the whole string `A;` is a stop.
    pub fn push(&mut self, byte: u8) -> Option<Order> {
        // With bit 7 set the echo would be an answer. `?` is in no string, so the host has not sent
        // it.
        self.send(if byte < 0x80 { byte } else { b'?' });
        if self.is_streaming && byte == b'A' {
            self.string.clear();
            self.string.push(byte);
            return (self.motion != Motion::None).then_some(Order::Stop);
        }
        let stops = !self.is_streaming && !self.passes(byte);
        if stops {
            self.string.clear();
        }
        let order = match byte {
            b';' => self.end(),
            b' ' | b'\t' | b'\r' | b'\n' => None,
            _ => {
                // For a string that is too long, one byte more than the longest string is kept.
                self.string.push(byte);
                None
            }
        };
        if stops { Some(Order::Stop) } else { order }
    }

    /// Whether a byte does not stop the present motion.
    fn passes(&self, byte: u8) -> bool {
        match (self.motion, self.string.bytes()) {
            (Motion::None, _) => true,
            (Motion::Other, _) if self.is_unattended => false,
            (_, []) => matches!(byte, b'W' | b'V' | b'L'),
            (_, b"W" | b"V" | b"L") => byte == b';',
            _ => false,
        }
    }

    /// Ends a string at its `;`.
    fn end(&mut self) -> Option<Order> {
        let string = core::mem::replace(&mut self.string, Buffer::new());
        let order = match string.bytes() {
            [] => return None,
            bytes if bytes.len() >= STRING_BYTES => None,
            bytes => Order::read(bytes),
        };
        match order {
            None => self.answer(Answer::Wrong),
            Some(Order::Stream(on)) => {
                // Queued lines end under the rules that applied when they were sent.
                let is_free = self.motion == Motion::None;
                if is_free {
                    self.is_streaming = on;
                }
                self.answer(if is_free {
                    Answer::Taken
                } else {
                    Answer::Refused
                });
            }
            Some(Order::Every(steps)) => {
                self.every = steps;
                self.unreported = [0; 3];
                self.answer(Answer::Taken);
            }
            Some(order) => {
                if let Order::Lease(ms) = order {
                    self.is_unattended = ms == 0;
                }
                return Some(order);
            }
        }
        None
    }

    /// Sets the present motion: none, a jog, or another one. While lines are streamed, queued lines
    /// count as motion.
    pub fn set_motion(&mut self, is_moving: bool, is_jog: bool) {
        self.motion = match (is_moving, is_jog) {
            (false, _) => Motion::None,
            (true, true) => Motion::Jog,
            (true, false) => Motion::Other,
        };
    }

    /// Returns the bytes that stop the present motion.
    pub const fn stops(&self) -> Stops {
        match (self.motion, self.is_streaming) {
            (Motion::None, _) => Stops::Nothing,
            (_, true) => Stops::Letter,
            (Motion::Other, false) if self.is_unattended => Stops::Anything,
            (_, false) => Stops::Jog,
        }
    }

    /// Whether lines are streamed.
    pub const fn is_streaming(&self) -> bool {
        self.is_streaming
    }

    /// Whether this many steps can be reported now, with enough room left for echoes and answers.
    /// The number must include the steps that are queued for the motors, because they will be
    /// reported as well.
    pub const fn has_room(&self, steps: usize) -> bool {
        // At most OUT wait.
        steps.saturating_add(RESERVE) <= OUT.wrapping_sub(self.waiting)
    }

    /// Whether nothing waits for the transmitter.
    pub const fn is_silent(&self) -> bool {
        self.waiting == 0
    }

    /// Whether steps are reported at all. If not, [`step`](Device::step) need not be called.
    pub const fn tells_steps(&self) -> bool {
        self.every != 0
    }

    /// Reports a motor step, or counts it if only one in several is reported.
    pub fn step(&mut self, axis: Axis, forward: bool) {
        let Some(unreported) = self.unreported.get_mut(axis as usize) else {
            return; // there is no other axis
        };
        if self.every != 0 {
            // Below 1000 in both directions.
            *unreported = unreported.wrapping_add(if forward { 1 } else { -1 });
            if unreported.unsigned_abs() >= self.every {
                *unreported = 0;
                self.answer(Answer::Step { axis, forward });
            }
        }
    }

    /// Sends an answer.
    pub fn answer(&mut self, answer: Answer) {
        self.send(answer.byte());
    }

    /// Sends the state, then [`Answer::Taken`]: 74 bytes. If there is no room for all of them, some
    /// are dropped, and the host asks again.
    #[inline(never)]
    pub fn report(&mut self, state: &State) {
        for axis in &state.axes {
            for mut bits in axis.words() {
                for _ in 0..8 {
                    bits = bits.rotate_left(4);
                    self.answer(Answer::Digit(bits as u8));
                }
            }
        }
        self.answer(Answer::Digit(state.is_homed.into()));
        self.answer(Answer::Taken);
    }

    /// Returns the next byte for the line.
    pub fn transmit(&mut self) -> Option<u8> {
        if self.waiting == 0 {
            return None;
        }
        let byte = self.out.get(self.first).copied();
        self.first = wrapped::<OUT>(self.first.wrapping_add(1));
        self.waiting = self.waiting.wrapping_sub(1); // it was not 0
        byte
    }

    /// Queues a byte for the line. Without room the byte is dropped. A host that does not read
    /// therefore misses echoes of its own bytes.
    fn send(&mut self, byte: u8) {
        // Both at most OUT.
        let place = wrapped::<OUT>(self.first.wrapping_add(self.waiting));
        if self.waiting < OUT {
            if let Some(place) = self.out.get_mut(place) {
                *place = byte;
                self.waiting = self.waiting.wrapping_add(1);
            }
        }
    }
}

impl<const OUT: usize> Default for Device<OUT> {
    fn default() -> Self {
        Device::new()
    }
}

/// Returns the index in a ring for an index below twice its length.
const fn wrapped<const OUT: usize>(place: usize) -> usize {
    if place >= OUT {
        place.wrapping_sub(OUT)
    } else {
        place
    }
}
