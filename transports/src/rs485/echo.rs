//! Own bytes that the receiver hears.

/// The origin of a received byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Heard {
    /// An own byte. Drop it.
    Echo,
    /// Not the byte that was sent: another station drives the line, or the line is disturbed. Stop
    /// sending and release the line. The bytes sent before are forgotten, and bytes received until
    /// the line rests are invalid.
    Collision,
    /// A byte of another station.
    Foreign(u8),
}

/// Up to `N` bytes that were sent and not yet heard back, for a receiver that hears its own
/// transmitter.
///
/// If the receiver is off while the driver is on (/RE tied to DE), no byte is heard back.
/// [`silence`](Echo::silence) detects this.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Echo<const N: usize> {
    sent: [u8; N],
    /// Below `N`, or 0.
    first: usize,
    /// Length, at most `N`.
    length: usize,
    hears_itself: bool,
}

impl<const N: usize> Echo<N> {
    /// Creates an echo for a line that returns sent bytes, or does not.
    pub const fn new(hears_itself: bool) -> Self {
        Echo {
            sent: [0; N],
            first: 0,
            length: 0,
            hears_itself,
        }
    }

    /// Whether sent bytes are expected back.
    pub const fn hears_itself(&self) -> bool {
        self.hears_itself
    }

    /// Notes a byte that is being sent. Returns `false` if `N` bytes are in flight, so that this
    /// one must wait.
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

    /// Returns the origin of a received byte.
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

    /// Four characters after transmission is complete: whether all bytes were heard back. Missing
    /// bytes are forgotten. They mean a broken line, or a receiver that does not hear its
    /// transmitter.
    pub fn silence(&mut self) -> bool {
        let all = self.length == 0;
        self.clear();
        all
    }

    /// Finds out with one harmless byte (0 for [`nmc`](crate::nmc)) whether the line returns the
    /// bytes that are sent. `heard` is what arrived within four characters.
    pub fn learn(&mut self, sent: u8, heard: Option<u8>) {
        self.clear();
        self.hears_itself = heard == Some(sent);
    }

    fn clear(&mut self) {
        self.first = 0;
        self.length = 0;
    }
}
