//! The master of a line that several stations share.

use super::conversation::{Conversation, Order};
use super::frame::{Frame, Kind, Receiver, Sent};
use super::{BROADCAST, Lost, PAYLOAD_BYTES, Refused, Timing};
use crate::buffer::Buffer;

/// An event of the line. `station` counts from 0 in the order of the addresses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event<'a> {
    /// The station has answered its call.
    Up {
        /// The station.
        station: usize,
    },
    /// The station is down until it is called again.
    Down {
        /// The station.
        station: usize,
        /// The reason.
        why: Lost,
        /// Number of payloads in doubt: 0 or 1.
        unacknowledged: usize,
    },
    /// The next payload of a station. Each payload is returned once.
    Data {
        /// The station.
        station: usize,
        /// The payload.
        payload: &'a [u8],
    },
    /// The station did not receive the last broadcast.
    Missed {
        /// The station.
        station: usize,
    },
    /// Every station that is up has reported whether it received the last broadcast. Before this
    /// event, each station that did not receive it has caused [`Event::Missed`] or [`Event::Down`].
    Checked,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Down,
    Calling,
    Up,
}

/// The master's side of a station.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Line {
    address: u8,
    state: State,
    call: u8,
    conversation: Conversation<1>,
    tries: u8,
    asked_us: u32,
    /// Whether the station has sent a payload. It may have more.
    is_talking: bool,
    /// Whether the station must still report if it received the broadcast.
    is_checked: bool,
    has_missed: bool,
}

/// A master. It asks its stations in turn, as often as there is something to send. Its size is 504
/// bytes, and 176 bytes per station.
///
/// | when | call |
/// | --- | --- |
/// | a station is to be used | [`call`](Master::call) |
/// | a payload is to be sent | [`send`](Master::send), [`broadcast`](Master::broadcast) |
/// | the port takes bytes | [`transmit`](Master::transmit) |
/// | a byte arrives | [`push`](Master::push) |
/// | after each of these, and every few milliseconds | [`poll`](Master::poll) until it returns `None` |
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Master<const STATIONS: usize> {
    timing: Timing,
    lines: [Line; STATIONS],
    receiver: Receiver,
    sending: Option<Sent>,
    /// The station that must answer, and the time until which it must do so.
    awaited: Option<(usize, u32)>,
    /// The time from which the line may be used again. `None`: now.
    ready_us: Option<u32>,
    /// The station that was asked last.
    last: usize,
    shout: Option<Buffer<PAYLOAD_BYTES>>,
    /// Number of the last broadcast, 1 to 7. 0: none yet.
    broadcast: u8,
    is_checking: bool,
}

impl<const STATIONS: usize> Master<STATIONS> {
    /// Creates the master of stations with these addresses. The addresses must differ, and none may
    /// be [`BROADCAST`]. All stations are down.
    pub fn new(timing: Timing, addresses: [u8; STATIONS]) -> Self {
        Master {
            timing,
            lines: addresses.map(|address| Line {
                address,
                state: State::Down,
                call: 0,
                conversation: Conversation::new(),
                tries: 0,
                asked_us: 0,
                is_talking: false,
                is_checked: false,
                has_missed: false,
            }),
            receiver: Receiver::new(),
            sending: None,
            awaited: None,
            ready_us: None,
            last: 0,
            shout: None,
            broadcast: 0,
            is_checking: false,
        }
    }

    /// Calls a station in any state. Both ends restart, and queued payloads are dropped. A payload
    /// on the line may still arrive before the call.
    ///
    /// # Errors
    /// [`Refused::NoStation`].
    pub fn call(&mut self, station: usize) -> Result<(), Refused> {
        let line = self.lines.get_mut(station).ok_or(Refused::NoStation)?;
        line.state = State::Calling;
        line.conversation = Conversation::new();
        (line.tries, line.is_checked, line.has_missed) = (0, false, false);
        Ok(())
    }

    /// Queues a payload for a station, one at a time.
    ///
    /// # Errors
    /// [`Refused`]. In this case nothing changes.
    pub fn send(&mut self, station: usize, payload: &[u8]) -> Result<(), Refused> {
        let line = self.lines.get_mut(station).ok_or(Refused::NoStation)?;
        if line.state != State::Up {
            return Err(Refused::NotUp);
        }
        line.conversation.queue(payload)
    }

    /// Queues a payload for all stations. It is sent once, before anything else, when the line is
    /// free. Then the master asks every station that is up whether it received it.
    ///
    /// # Errors
    /// [`Refused::Full`] until the last broadcast is [`Event::Checked`], [`Refused::NotUp`] if no
    /// station is up, or [`Refused::TooLong`].
    pub fn broadcast(&mut self, payload: &[u8]) -> Result<(), Refused> {
        if payload.len() > PAYLOAD_BYTES {
            return Err(Refused::TooLong);
        }
        if self.shout.is_some() || self.is_checking {
            return Err(Refused::Full);
        }
        if !self.lines.iter().any(|line| line.state == State::Up) {
            return Err(Refused::NotUp);
        }
        let mut shout = Buffer::new();
        shout.extend(payload);
        self.shout = Some(shout);
        Ok(())
    }

    /// Returns the next byte for the line. Returns `None` if there is none now.
    pub fn transmit(&mut self, now_us: u32) -> Option<u8> {
        if self.sending.is_none() {
            if self.awaited.is_some()
                || self
                    .ready_us
                    .is_some_and(|ready_us| !has_come(ready_us, now_us))
            {
                return None;
            }
            self.ready_us = None;
            self.sending = match self.shout.take() {
                Some(payload) => self.shout_out(payload.bytes(), now_us),
                None => self.ask(now_us),
            };
        }
        let byte = self.sending.as_mut().and_then(Sent::transmit);
        if byte.is_none() {
            self.sending = None;
        }
        byte
    }

    /// Takes a byte from the line. Returns the event of the frame that the byte completes.
    pub fn push(&mut self, byte: u8, now_us: u32) -> Option<Event<'_>> {
        let frame = self.receiver.push(byte)?;
        let (station, _) = self.awaited?;
        let line = self.lines.get_mut(station)?;
        // A late answer to an earlier question is dropped. The station repeats it when the master
        // asks again.
        if !frame.from_station || frame.address != line.address {
            return None;
        }
        let ready_us = Some(now_us.wrapping_add(self.timing.turnaround_us));
        if frame.kind == Kind::Call {
            let event = match (line.state, frame.payload.first()) {
                (State::Calling, Some(call)) if *call == line.call => {
                    line.state = State::Up;
                    line.asked_us = now_us;
                    Event::Up { station }
                }
                (State::Up, None) => line.lose(station, Lost::Restarted),
                _ => return None,
            };
            (self.awaited, self.ready_us, line.tries) = (None, ready_us, 0);
            return Some(event);
        }
        if line.state != State::Up {
            return None;
        }
        (self.awaited, self.ready_us, line.tries) = (None, ready_us, 0);
        line.conversation.acknowledge(frame.acknowledged);
        line.conversation.rewind();
        if core::mem::take(&mut line.is_checked) {
            line.has_missed = frame.broadcast != self.broadcast;
        }
        line.is_talking = frame.kind == Kind::Data;
        let is_next = line.is_talking && line.conversation.take(frame.number) == Order::Next;
        is_next.then_some(Event::Data {
            station,
            payload: frame.payload,
        })
    }

    /// Returns an event that is due because of the time. Call this until it returns `None`.
    pub fn poll(&mut self, now_us: u32) -> Option<Event<'static>> {
        if let Some((station, until_us)) = self.awaited {
            if has_come(until_us, now_us) {
                self.awaited = None;
                self.sending = None;
                // A station that still sends must finish before the next question.
                self.ready_us = Some(now_us.wrapping_add(self.timing.turnaround_us));
                let line = self.lines.get_mut(station)?;
                line.tries = line.tries.saturating_add(1);
                line.conversation.rewind();
                if line.tries >= self.timing.tries {
                    return Some(line.lose(station, Lost::NoAnswer));
                }
            }
        }
        for (station, line) in (0..STATIONS).zip(&mut self.lines) {
            if core::mem::take(&mut line.has_missed) {
                return Some(Event::Missed { station });
            }
        }
        if self.is_checking && !self.lines.iter().any(|line| line.is_checked) {
            self.is_checking = false;
            return Some(Event::Checked);
        }
        None
    }

    /// Whether a station was called and answers.
    pub fn is_up(&self, station: usize) -> bool {
        self.lines
            .get(station)
            .is_some_and(|line| line.state == State::Up)
    }

    /// Returns the number of payloads that a station has not acknowledged: 0 or 1. After the
    /// station went down, the number is kept until the station is called again.
    pub fn unacknowledged(&self, station: usize) -> usize {
        self.lines
            .get(station)
            .map_or(0, |line| line.conversation.unacknowledged())
    }

    fn shout_out(&mut self, payload: &[u8], now_us: u32) -> Option<Sent> {
        // The number is 1 to 7. Two successive numbers differ.
        self.broadcast = if self.broadcast >= 7 {
            1
        } else {
            self.broadcast.wrapping_add(1)
        };
        for line in &mut self.lines {
            line.is_checked = line.state == State::Up;
        }
        self.is_checking = true;
        let frame = Frame {
            address: BROADCAST,
            kind: Kind::Data,
            from_station: false,
            broadcast: 0,
            number: self.broadcast,
            acknowledged: 0,
            payload,
        };
        let sent = frame.encode()?;
        // At most 127 characters.
        let on_line_us = self
            .timing
            .character_us
            .saturating_mul(sent.bytes().len() as u32);
        let busy_us = on_line_us.saturating_add(self.timing.turnaround_us);
        self.ready_us = Some(now_us.wrapping_add(busy_us));
        Some(sent)
    }

    /// Returns the question to the next station that is due.
    fn ask(&mut self, now_us: u32) -> Option<Sent> {
        let (timing, broadcast) = (self.timing, self.broadcast);
        let (before, behind) = self
            .lines
            .split_at_mut_checked(self.last.saturating_add(1))?;
        let numbers = (before.len()..STATIONS).chain(0..before.len());
        let lines = behind.iter_mut().chain(before.iter_mut());
        let (station, line) = numbers
            .zip(lines)
            .find(|(_, line)| line.is_due(timing, now_us))?;
        (line.asked_us, line.is_talking) = (now_us, false);
        if line.state == State::Calling {
            // Each try has its own number. An answer with the number of an earlier try was sent
            // before this one.
            line.call = line.call.wrapping_add(1);
        }
        let acknowledged = line.conversation.taken();
        let call = [line.call];
        let (kind, number, payload): (_, _, &[u8]) = match line.state {
            State::Calling => (Kind::Call, 0, &call),
            _ => match line.conversation.next() {
                Some((number, payload)) => (Kind::Data, number, payload),
                None => (Kind::Acknowledge, 0, &[]),
            },
        };
        let frame = Frame {
            address: line.address,
            kind,
            from_station: false,
            broadcast,
            number,
            acknowledged,
            payload,
        };
        self.last = station;
        self.awaited = Some((station, now_us.wrapping_add(timing.wait_us())));
        frame.encode()
    }
}

impl Line {
    fn is_due(&self, timing: Timing, now_us: u32) -> bool {
        match self.state {
            State::Down => false,
            State::Calling => true,
            State::Up => {
                self.tries > 0
                    || self.is_talking
                    || self.is_checked
                    || self.conversation.unacknowledged() > 0
                    || now_us.wrapping_sub(self.asked_us) >= timing.ask_us
            }
        }
    }

    fn lose(&mut self, station: usize, why: Lost) -> Event<'static> {
        (self.state, self.tries) = (State::Down, 0);
        (self.is_checked, self.has_missed, self.is_talking) = (false, false, false);
        Event::Down {
            station,
            why,
            unacknowledged: self.conversation.unacknowledged(),
        }
    }
}

/// Whether a time has been reached, up to 2^31 us ago.
pub(super) const fn has_come(at_us: u32, now_us: u32) -> bool {
    now_us.wrapping_sub(at_us) as i32 >= 0
}
