//! One's own bytes, heard back.

/// What a received byte is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Heard {
    /// One's own: drop it.
    Echo,
    /// Not what was sent: somebody else drives the line, or it is disturbed. Stop sending and let go; the bytes sent before are
    /// forgotten, and what is heard until the line rests is worth nothing.
    Collision,
    /// Somebody else's.
    Foreign(u8),
}

/// Up to `N` bytes that were sent and not yet heard back, for a receiver that hears its own transmitter.
///
/// Where the receiver is off while the driver is on (/RE tied to DE), nothing is heard back: [`silence`](Echo::silence) finds that out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Echo<const N: usize> {
    sent: [u8; N],
    /// Below `N`, or 0.
    first: usize,
    /// At most `N`.
    length: usize,
    hears_itself: bool,
}

impl<const N: usize> Echo<N> {
    /// For a line that is expected to return what is sent, or not to.
    pub const fn new(hears_itself: bool) -> Self {
        Echo {
            sent: [0; N],
            first: 0,
            length: 0,
            hears_itself,
        }
    }

    /// Whether what is sent is expected back.
    pub const fn hears_itself(&self) -> bool {
        self.hears_itself
    }

    /// Notes a byte that is being sent; `false` when `N` are under way already and this one must wait.
    #[must_use]
    pub fn sent(&mut self, byte: u8) -> bool {
        if !self.hears_itself {
            return true;
        }
        // Both are at most N, which is far below the half of usize.
        let place = self.first.wrapping_add(self.length);
        let place = if place >= N {
            place.wrapping_sub(N)
        } else {
            place
        };
        match self.sent.get_mut(place) {
            Some(slot) if self.length < N => {
                *slot = byte;
                self.length = self.length.wrapping_add(1); // it was below N
                true
            }
            _ => false,
        }
    }

    /// Tells what a received byte is.
    pub fn received(&mut self, byte: u8) -> Heard {
        if self.length == 0 {
            return Heard::Foreign(byte);
        }
        let expected = self.sent.get(self.first).copied();
        if expected != Some(byte) {
            self.clear();
            return Heard::Collision;
        }
        let next = self.first.wrapping_add(1);
        self.first = if next >= N { 0 } else { next };
        self.length = self.length.saturating_sub(1);
        Heard::Echo
    }

    /// Four characters after transmission is complete: whether all was heard back. Bytes still missing are forgotten; they mean a broken
    /// line, or a receiver that does not hear itself.
    pub fn silence(&mut self) -> bool {
        let all = self.length == 0;
        self.clear();
        all
    }

    /// Learns from one harmless byte (0 is one for [`nmc`](crate::nmc)) whether the line returns what is sent: `heard` is what came within
    /// four characters.
    pub fn learn(&mut self, sent: u8, heard: Option<u8>) {
        self.clear();
        self.hears_itself = heard == Some(sent);
    }

    fn clear(&mut self) {
        self.first = 0;
        self.length = 0;
    }
}
