//! A station on a line that several stations share.

use super::conversation::{Conversation, Order};
use super::frame::{Frame, Kind, Receiver, Sent};
use super::{BROADCAST, Lost, Refused, Timing};

/// The content of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Received<'a> {
    /// The link is up, and all numbers start again. Payloads that were queued before are dropped.
    Up,
    /// The next payload of the other end. Each payload is returned once.
    Data(&'a [u8]),
    /// A payload for all stations. Each payload is returned once.
    Broadcast(&'a [u8]),
}

/// What the station sends next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    /// Data if there is any, otherwise an acknowledgement.
    Next,
    Gap,
    /// The answer to the call with this number.
    Up(u8),
    /// This station was not called since the start.
    Down,
}

/// A station. It sends one frame when it is asked. Its size is 496 bytes.
///
/// | when | call |
/// | --- | --- |
/// | a byte arrives | [`push`](Station::push). What it returns is acknowledged with the answer |
/// | the port takes bytes | [`transmit`](Station::transmit) |
/// | every few milliseconds | [`poll`](Station::poll): whether the master is still there |
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Station {
    address: u8,
    timing: Timing,
    receiver: Receiver,
    conversation: Conversation<1>,
    is_up: bool,
    /// The number of the master's last known broadcast, and whether the station received it.
    broadcast: u8,
    has_heard: bool,
    answer: Option<Answer>,
    heard_us: u32,
    sending: Option<Sent>,
}

impl Station {
    /// Creates a station with this address, not [`BROADCAST`]. It is down until it is called.
    pub const fn new(address: u8, timing: Timing) -> Station {
        Station {
            address,
            timing,
            receiver: Receiver::new(),
            conversation: Conversation::new(),
            is_up: false,
            broadcast: 0,
            has_heard: false,
            answer: None,
            heard_us: 0,
            sending: None,
        }
    }

    /// Takes a byte from the line. Returns the content of the frame that the byte completes.
    pub fn push(&mut self, byte: u8, now_us: u32) -> Option<Received<'_>> {
        let frame = self.receiver.push(byte)?;
        if frame.from_station || (frame.address != self.address && frame.address != BROADCAST) {
            return None;
        }
        if frame.address == BROADCAST {
            let is_new = matches!(frame.number, 1..=7) && frame.number != self.broadcast;
            if !self.is_up || frame.kind != Kind::Data || !is_new {
                return None;
            }
            (self.heard_us, self.broadcast, self.has_heard) = (now_us, frame.number, true);
            return Some(Received::Broadcast(frame.payload));
        }
        self.heard_us = now_us;
        self.sending = None;
        if frame.kind == Kind::Call {
            self.answer = Some(Answer::Up(*frame.payload.first()?));
            self.conversation = Conversation::new();
            (self.is_up, self.broadcast, self.has_heard) = (true, frame.broadcast, false);
            return Some(Received::Up);
        }
        if !self.is_up {
            self.answer = Some(Answer::Down);
            return None;
        }
        if frame.broadcast != self.broadcast {
            // The station has missed this broadcast. It must not take it for a later one with the
            // same number.
            (self.broadcast, self.has_heard) = (frame.broadcast, false);
        }
        self.conversation.acknowledge(frame.acknowledged);
        self.conversation.rewind();
        self.answer = Some(Answer::Next);
        if frame.kind != Kind::Data {
            return None;
        }
        match self.conversation.take(frame.number) {
            Order::Next => Some(Received::Data(frame.payload)),
            Order::Repeat => None,
            Order::Gap => {
                self.answer = Some(Answer::Gap);
                None
            }
        }
    }

    /// Queues a payload until the master asks.
    ///
    /// # Errors
    /// [`Refused`]. In this case nothing changes.
    pub fn send(&mut self, payload: &[u8]) -> Result<(), Refused> {
        if !self.is_up {
            return Err(Refused::NotUp);
        }
        self.conversation.queue(payload)
    }

    /// Returns the next byte for the line. Returns `None` if there is none now.
    pub fn transmit(&mut self, now_us: u32) -> Option<u8> {
        if self.sending.is_none() {
            let answer = self.answer?;
            if now_us.wrapping_sub(self.heard_us) < self.timing.turnaround_us {
                return None;
            }
            self.answer = None;
            self.sending = self.say(answer);
        }
        let byte = self.sending.as_mut().and_then(Sent::transmit);
        if byte.is_none() {
            self.sending = None;
        }
        byte
    }

    /// Returns [`Lost::Silence`] if the link has gone down since the last call of this function,
    /// because nothing was received for [`Timing::silence_us`].
    pub fn poll(&mut self, now_us: u32) -> Option<Lost> {
        let silence_us = self.timing.silence_us;
        let is_lost =
            self.is_up && silence_us != 0 && now_us.wrapping_sub(self.heard_us) >= silence_us;
        if is_lost {
            self.is_up = false;
        }
        is_lost.then_some(Lost::Silence)
    }

    /// Whether the station was called and receives its master.
    pub const fn is_up(&self) -> bool {
        self.is_up
    }

    /// Returns the number of payloads that the master has not acknowledged: 0 or 1.
    pub const fn unacknowledged(&self) -> usize {
        self.conversation.unacknowledged()
    }

    fn say(&mut self, answer: Answer) -> Option<Sent> {
        let acknowledged = self.conversation.taken();
        let call;
        let (kind, number, payload): (_, _, &[u8]) = match answer {
            Answer::Next => match self.conversation.next() {
                Some((number, payload)) => (Kind::Data, number, payload),
                None => (Kind::Acknowledge, 0, &[]),
            },
            Answer::Gap => (Kind::Gap, 0, &[]),
            Answer::Up(number) => {
                call = [number];
                (Kind::Call, 0, &call)
            }
            Answer::Down => (Kind::Call, 0, &[]),
        };
        let frame = Frame {
            address: self.address,
            kind,
            from_station: true,
            broadcast: if self.has_heard { self.broadcast } else { 0 },
            number,
            acknowledged,
            payload,
        };
        frame.encode()
    }
}
