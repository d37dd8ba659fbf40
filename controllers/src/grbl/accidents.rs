//! Accidents of Grbl's implementation that a dialogue shows.

/// Duration of a segment of motion of Grbl, in microseconds.
const SEGMENT_US: u32 = 10_000;
/// Segments that are made after a request to brake: the present one and the prepared ones.
const PREPARED: u32 = 5;
/// Time that Grbl needs to handle an override, in microseconds. Bytes that arrive meanwhile are bits
/// of one set, so equal ones count once.
const OVERRIDE_US: u32 = 200;

/// State of the accidents.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Accidents {
    /// The move that the segments belong to, and its time so far, in microseconds.
    tag: Option<u32>,
    moved_us: u32,
    /// Rest of the time that an override takes, and the last byte that waits for its end.
    override_us: u32,
    waiting: Option<u8>,
}

impl Accidents {
    /// Returns the time until braking begins during the move `tag`.
    pub(super) fn brakes_after_us(&self, tag: Option<u32>) -> u32 {
        let moved_us = if tag == self.tag { self.moved_us } else { 0 };
        // The remainder is below one segment.
        (PREPARED * SEGMENT_US).wrapping_sub(moved_us % SEGMENT_US)
    }

    /// Advances the time. `tag` is the move that is being made.
    pub(super) fn pass(&mut self, us: u32, tag: Option<u32>) {
        if tag != self.tag {
            self.tag = tag;
            self.moved_us = 0;
        }
        self.moved_us = self.moved_us.wrapping_add(us);
        let left = self.override_us.saturating_sub(us);
        self.override_us = match self.waiting {
            Some(_) if left == 0 => {
                self.waiting = None;
                OVERRIDE_US
            }
            _ => left,
        };
    }

    pub(super) const fn wait_us(&self) -> u32 {
        self.override_us
    }

    /// Takes an override byte. Returns whether it has an effect.
    pub(super) fn counts(&mut self, byte: u8) -> bool {
        if self.override_us == 0 {
            self.override_us = OVERRIDE_US;
            return true;
        }
        self.waiting.replace(byte) != Some(byte)
    }
}
