//! The controller's end of the line.

use super::{Answer, Axis, Order, STRING_BYTES, Stops};
use crate::buffer::Buffer;

/// Room that echoes and answers keep beside the steps.
const RESERVE: usize = 8;

/// The controller's end of the mill's line: bytes in, [`Order`]s out; echoes, steps and answers
/// out. `OUT` bytes wait for the transmitter.
///
/// | when | call |
/// | --- | --- |
/// | a byte arrives | [`push`](Device::push), which gives an order or none |
/// | the machine begins or ends something that a byte stops | [`set_motion`](Device::set_motion) |
/// | a motor step was made | [`step`](Device::step), where it [`has_room`](Device::has_room) |
/// | an order was obeyed, or refused | [`answer`](Device::answer) |
/// | the transmitter is free | [`transmit`](Device::transmit) |
///
/// The link itself confirms [`Order::Stream`] and [`Order::Every`]. Memory: `OUT` and about 100
/// bytes.
#[derive(Debug, Clone)]
pub struct Device<const OUT: usize> {
    string: Buffer<STRING_BYTES>,
    motion: Motion,
    /// A motion needs no strings of the host. Otherwise [`Order::Renew`] may come at any time.
    is_unattended: bool,
    is_streaming: bool,
    /// One step in so many is told; 0: none.
    every: u16,
    /// Steps of each axis that were not told, less than `every` of them.
    untold: [i16; 3],
    out: [u8; OUT],
    /// Below `OUT`.
    first: usize,
    /// At most `OUT`.
    waiting: usize,
}

/// What moves, as far as the line is concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Motion {
    None,
    /// `W;`, `V;` and `L;` are for it.
    Jog,
    /// Any byte stops it, unless lines are streamed. With a lease it is as a jog.
    Other,
}

impl<const OUT: usize> Device<OUT> {
    /// After a reset: it says [`Answer::Ready`].
    pub fn new() -> Self {
        const { assert!(OUT > 2 * RESERVE, "room for echoes, answers and steps") };
        let mut device = Device {
            string: Buffer::new(),
            motion: Motion::None,
            is_unattended: true,
            is_streaming: false,
            every: 1,
            untold: [0; 3],
            out: [0; OUT],
            first: 0,
            waiting: 0,
        };
        device.answer(Answer::Ready);
        device
    }

    /// Takes a byte of the line and returns the order that it completes, or [`Order::Stop`] if the
    /// byte stops the motion. While nothing moves, a stop is the whole string `A;`.
    pub fn push(&mut self, byte: u8) -> Option<Order> {
        // With bit 7 set it would be an answer. `?` is in no string, and the host has not sent it.
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
                // One byte more than a string may have marks one that is too long.
                self.string.push(byte);
                None
            }
        };
        if stops { Some(Order::Stop) } else { order }
    }

    /// Whether a byte leaves alone what moves.
    fn passes(&self, byte: u8) -> bool {
        match (self.motion, self.string.bytes()) {
            (Motion::None, _) => true,
            (Motion::Other, _) if self.is_unattended => false,
            (_, []) => matches!(byte, b'W' | b'V' | b'L'),
            (_, b"W" | b"V" | b"L") => byte == b';',
            _ => false,
        }
    }

    /// A `;` has come.
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
                // Lines in the queue are finished by the rules they were sent under.
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
                self.untold = [0; 3];
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

    /// Sets what moves: nothing, a jog, or another motion. While lines are streamed, queued lines
    /// count as motion.
    pub fn set_motion(&mut self, is_moving: bool, is_jog: bool) {
        self.motion = match (is_moving, is_jog) {
            (false, _) => Motion::None,
            (true, true) => Motion::Jog,
            (true, false) => Motion::Other,
        };
    }

    /// Which bytes stop what moves now.
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

    /// Whether this many steps can be reported now, with room left for echoes and answers. Steps
    /// that are queued for the motors will be reported as well.
    pub const fn has_room(&self, steps: usize) -> bool {
        // At most OUT wait.
        steps.saturating_add(RESERVE) <= OUT.wrapping_sub(self.waiting)
    }

    /// Whether nothing waits for the transmitter.
    pub const fn is_silent(&self) -> bool {
        self.waiting == 0
    }

    /// Whether steps are told, or counted to be told: without there is no need to say them.
    pub const fn tells_steps(&self) -> bool {
        self.every != 0
    }

    /// Tells a motor step, or counts it where only one in so many is told.
    pub fn step(&mut self, axis: Axis, forward: bool) {
        let Some(untold) = self.untold.get_mut(axis as usize) else {
            return; // there is no other axis
        };
        if self.every != 0 {
            // Below 1000 either way.
            *untold = untold.wrapping_add(if forward { 1 } else { -1 });
            if untold.unsigned_abs() >= self.every {
                *untold = 0;
                self.answer(Answer::Step { axis, forward });
            }
        }
    }

    /// Answers.
    pub fn answer(&mut self, answer: Answer) {
        self.send(answer.byte());
    }

    /// The next byte for the line.
    pub fn transmit(&mut self) -> Option<u8> {
        if self.waiting == 0 {
            return None;
        }
        let byte = self.out.get(self.first).copied();
        self.first = wrapped::<OUT>(self.first.wrapping_add(1));
        self.waiting = self.waiting.wrapping_sub(1); // it was not 0
        byte
    }

    /// What finds no room is dropped: a host that sends without reading misses its own echoes.
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

/// A place in a ring, from one below twice its length.
const fn wrapped<const OUT: usize>(place: usize) -> usize {
    if place >= OUT {
        place.wrapping_sub(OUT)
    } else {
        place
    }
}
