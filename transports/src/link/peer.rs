//! Either end of a line that only two ends share.

use super::conversation::{Conversation, Order};
use super::frame::{Frame, Kind, Receiver, Sent};
use super::master::has_come;
use super::{Lost, Received, Refused, Timing};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Down,
    Calling,
    Up,
}

/// What an end sends in addition to data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    Acknowledge,
    Gap,
    /// The answer to the call with this number.
    Up(u8),
    /// This end was not called since the start.
    Down,
}

/// One end of a full-duplex line. Both ends may send at any time. Up to `WINDOW` frames (1 to 7)
/// may be sent before the first is acknowledged. The size is 384 bytes, and 128 bytes per frame.
///
/// One end calls, the other end is called. Each end sends at least one frame every
/// [`Timing::ask_us`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Peer<const WINDOW: usize> {
    address: u8,
    calls: bool,
    timing: Timing,
    receiver: Receiver,
    conversation: Conversation<WINDOW>,
    state: State,
    call: u8,
    answer: Option<Answer>,
    /// Whether a gap was reported and no frame in order has arrived since.
    is_gap_told: bool,
    /// The time until which the frames in flight must be acknowledged.
    until_us: Option<u32>,
    tries: u8,
    heard_us: u32,
    spoke_us: u32,
    sending: Option<Sent>,
    lost: Option<Lost>,
}

impl<const WINDOW: usize> Peer<WINDOW> {
    /// Creates the end that is called, with this address.
    pub const fn station(address: u8, timing: Timing) -> Self {
        Peer {
            address,
            calls: false,
            timing,
            receiver: Receiver::new(),
            conversation: Conversation::new(),
            state: State::Down,
            call: 0,
            answer: None,
            is_gap_told: false,
            until_us: None,
            tries: 0,
            heard_us: 0,
            spoke_us: 0,
            sending: None,
            lost: None,
        }
    }

    /// Creates the end that calls the station with this address.
    pub const fn caller(address: u8, timing: Timing) -> Self {
        let mut peer = Self::station(address, timing);
        peer.calls = true;
        peer
    }

    /// Calls the other end, in any state. Both ends restart, and queued payloads are dropped. A
    /// payload on the line may still arrive before the call. At the end that is called, this
    /// function does nothing.
    pub fn call(&mut self) {
        if self.calls {
            self.state = State::Calling;
            self.begin();
        }
    }

    /// Queues a payload.
    ///
    /// # Errors
    /// [`Refused`]. In this case nothing changes.
    pub fn send(&mut self, payload: &[u8]) -> Result<(), Refused> {
        if self.state != State::Up {
            return Err(Refused::NotUp);
        }
        self.conversation.queue(payload)
    }

    /// Takes a byte from the line. Returns the content of the frame that the byte completes.
    pub fn push(&mut self, byte: u8, now_us: u32) -> Option<Received<'_>> {
        let frame = self.receiver.push(byte)?;
        if frame.from_station != self.calls || frame.address != self.address {
            return None;
        }
        let wait_us = self.timing.wait_us();
        match (frame.kind, self.calls) {
            (Kind::Call, false) => {
                self.answer = Some(Answer::Up(*frame.payload.first()?));
                (self.conversation, self.state) = (Conversation::new(), State::Up);
                (self.until_us, self.tries, self.is_gap_told) = (None, 0, false);
                self.heard_us = now_us;
                return Some(Received::Up);
            }
            (Kind::Call, true) => match (self.state, frame.payload.first()) {
                (State::Calling, Some(call)) if *call == self.call => {
                    (self.state, self.until_us, self.tries) = (State::Up, None, 0);
                    self.heard_us = now_us;
                    return Some(Received::Up);
                }
                (State::Up, None) => {
                    (self.state, self.lost) = (State::Down, Some(Lost::Restarted));
                    return None;
                }
                _ => return None,
            },
            _ => {}
        }
        if self.state != State::Up {
            if !self.calls {
                self.answer = Some(Answer::Down);
            }
            return None;
        }
        self.heard_us = now_us;
        if self.conversation.acknowledge(frame.acknowledged) {
            let is_waiting = self.conversation.unacknowledged() > 0;
            self.until_us = is_waiting.then(|| now_us.wrapping_add(wait_us));
            self.tries = 0;
        }
        if frame.kind == Kind::Gap {
            self.conversation.rewind();
        }
        if frame.kind != Kind::Data {
            return None;
        }
        match self.conversation.take(frame.number) {
            Order::Next => {
                self.is_gap_told = false;
                self.answer = Some(Answer::Acknowledge);
                Some(Received::Data(frame.payload))
            }
            Order::Repeat => {
                self.answer = Some(Answer::Acknowledge);
                None
            }
            Order::Gap => {
                if !core::mem::replace(&mut self.is_gap_told, true) {
                    self.answer = Some(Answer::Gap);
                }
                None
            }
        }
    }

    /// Returns the next byte for the line. Returns `None` if there is none now.
    pub fn transmit(&mut self, now_us: u32) -> Option<u8> {
        if self.sending.is_none() {
            self.sending = self.say(now_us);
            if self.sending.is_some() {
                self.spoke_us = now_us;
            }
        }
        let byte = self.sending.as_mut().and_then(Sent::transmit);
        if byte.is_none() {
            self.sending = None;
        }
        byte
    }

    /// Returns why the link has gone down since the last call of this function, if it has. The
    /// payloads in flight at that time are [`unacknowledged`](Peer::unacknowledged).
    pub fn poll(&mut self, now_us: u32) -> Option<Lost> {
        if self
            .until_us
            .is_some_and(|until_us| has_come(until_us, now_us))
        {
            self.until_us = None;
            self.tries = self.tries.saturating_add(1);
            self.conversation.rewind();
            if self.tries >= self.timing.tries {
                (self.state, self.lost) = (State::Down, Some(Lost::NoAnswer));
            }
        }
        let silence_us = self.timing.silence_us;
        let is_silent = silence_us != 0 && now_us.wrapping_sub(self.heard_us) >= silence_us;
        if self.state == State::Up && is_silent {
            (self.state, self.lost) = (State::Down, Some(Lost::Silence));
        }
        if self.state == State::Down {
            self.until_us = None;
        }
        self.lost.take()
    }

    /// Whether both ends receive each other.
    pub fn is_up(&self) -> bool {
        self.state == State::Up
    }

    /// Returns the number of payloads that the other end has not acknowledged. After the link went
    /// down, it is not known whether these payloads arrived.
    pub const fn unacknowledged(&self) -> usize {
        self.conversation.unacknowledged()
    }

    fn begin(&mut self) {
        self.conversation = Conversation::new();
        (self.answer, self.until_us, self.lost) = (None, None, None);
        (self.tries, self.is_gap_told) = (0, false);
    }

    fn say(&mut self, now_us: u32) -> Option<Sent> {
        let acknowledged = self.conversation.taken();
        let call;
        let (kind, number, payload): (_, _, &[u8]) = match (self.state, self.answer) {
            (State::Calling, _) => {
                if self.until_us.is_some() {
                    return None;
                }
                self.until_us = Some(now_us.wrapping_add(self.timing.wait_us()));
                // Each try has its own number. An answer with the number of an earlier try was sent
                // before this one.
                self.call = self.call.wrapping_add(1);
                call = [self.call];
                (Kind::Call, 0, &call)
            }
            (_, Some(Answer::Up(number))) => {
                self.answer = None;
                call = [number];
                (Kind::Call, 0, &call)
            }
            (State::Down, Some(Answer::Down)) => {
                self.answer = None;
                (Kind::Call, 0, &[])
            }
            (State::Down, _) => return None,
            (State::Up, Some(Answer::Gap)) => {
                self.answer = None;
                (Kind::Gap, 0, &[])
            }
            (State::Up, answer) => {
                let is_idle = now_us.wrapping_sub(self.spoke_us) < self.timing.ask_us;
                match self.conversation.next() {
                    Some((number, payload)) => {
                        self.answer = None;
                        self.until_us = Some(now_us.wrapping_add(self.timing.wait_us()));
                        (Kind::Data, number, payload)
                    }
                    None if answer.is_none() && is_idle => return None,
                    None => {
                        self.answer = None;
                        (Kind::Acknowledge, 0, &[])
                    }
                }
            }
        };
        let frame = Frame {
            address: self.address,
            kind,
            from_station: !self.calls,
            broadcast: 0,
            number,
            acknowledged,
            payload,
        };
        frame.encode()
    }
}
