//! One end of a numbered exchange. After a loss it repeats all frames from a number on (go back N).

use super::{PAYLOAD_BYTES, WINDOW_FRAMES};
use crate::buffer::Buffer;

/// Why a payload was not accepted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// The other end was not called, or is down.
    NotUp,
    /// The largest permitted number of payloads is in flight.
    Full,
    /// The payload has more than [`PAYLOAD_BYTES`].
    TooLong,
    /// There is no such station.
    NoStation,
}

/// The meaning of a numbered frame for its receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    Next,
    Repeat,
    Gap,
}

/// Frames in flight in one direction, and the number of the last frame accepted in the other
/// direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Conversation<const WINDOW: usize> {
    /// A ring. The oldest frame is at `head`.
    frames: [Buffer<PAYLOAD_BYTES>; WINDOW],
    head: usize,
    /// Number of the oldest frame, modulo 16.
    first: u8,
    /// At most WINDOW. `sent` of them were sent since the last rewind.
    queued: usize,
    sent: usize,
    taken: u8,
}

impl<const WINDOW: usize> Conversation<WINDOW> {
    pub(super) const fn new() -> Self {
        const { assert!(0 < WINDOW && WINDOW <= WINDOW_FRAMES) };
        Conversation {
            frames: [Buffer::new(); WINDOW],
            head: 0,
            first: 1,
            queued: 0,
            sent: 0,
            taken: 0,
        }
    }

    pub(super) fn queue(&mut self, payload: &[u8]) -> Result<(), Refused> {
        if payload.len() > PAYLOAD_BYTES {
            return Err(Refused::TooLong);
        }
        if self.queued >= WINDOW {
            return Err(Refused::Full);
        }
        // Both are below WINDOW, at most 7.
        let place = self.slot(self.queued);
        if let Some(frame) = self.frames.get_mut(place) {
            frame.clear();
            frame.extend(payload);
            self.queued = self.queued.wrapping_add(1);
        }
        Ok(())
    }

    /// Returns the number of frames that the other end has not acknowledged.
    pub(super) const fn unacknowledged(&self) -> usize {
        self.queued
    }

    pub(super) const fn all_sent(&self) -> bool {
        self.sent >= self.queued
    }

    /// Returns the number of the last accepted frame.
    pub(super) const fn taken(&self) -> u8 {
        self.taken
    }

    /// Returns the next frame to send, with its number. It counts as sent.
    pub(super) fn next(&mut self) -> Option<(u8, &[u8])> {
        if self.all_sent() {
            return None;
        }
        let place = self.slot(self.sent);
        let number = self.first.wrapping_add(self.sent as u8) & 15; // sent is below WINDOW
        self.sent = self.sent.wrapping_add(1);
        self.frames.get(place).map(|frame| (number, frame.bytes()))
    }

    /// Takes an acknowledged number. The other end has taken everything up to this number. Returns
    /// whether the number is new. A number that was never sent is ignored.
    pub(super) fn acknowledge(&mut self, number: u8) -> bool {
        let more = usize::from(number.wrapping_sub(self.first).wrapping_add(1) & 15);
        if more == 0 || more > self.queued {
            return false;
        }
        self.head = self.slot(more);
        self.first = self.first.wrapping_add(more as u8) & 15; // more is at most WINDOW
        self.queued = self.queued.wrapping_sub(more);
        // After a rewind an acknowledgement of a frame that was sent before may arrive.
        self.sent = self.sent.saturating_sub(more);
        true
    }

    /// Marks all frames that are not acknowledged to be sent again.
    pub(super) fn rewind(&mut self) {
        self.sent = 0;
    }

    /// Takes the number of a frame from the other end.
    pub(super) fn take(&mut self, number: u8) -> Order {
        match number.wrapping_sub(self.taken) & 15 {
            1 => {
                self.taken = number & 15;
                Order::Next
            }
            ahead if usize::from(ahead) > 1 && usize::from(ahead) <= WINDOW_FRAMES => Order::Gap,
            _ => Order::Repeat,
        }
    }

    /// Returns the index of the n-th frame from the head. n is at most WINDOW.
    const fn slot(&self, n: usize) -> usize {
        let place = self.head.wrapping_add(n);
        if place < WINDOW {
            place
        } else {
            place.wrapping_sub(WINDOW)
        }
    }
}
