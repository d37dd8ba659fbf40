//! The echo of one's own bytes.

/// The origin of a received byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Heard {
    /// The echo of a byte that this end has sent. Drop it.
    Echo,
    /// The byte differs from the one that was sent. Another station drives the line, or the line is
    /// disturbed. Stop sending and release the line. The bytes sent before are forgotten, and bytes
    /// received until the line is silent are invalid.
    Collision,
    /// A byte of another station.
    Foreign(u8),
}

/// Up to `N` bytes that were sent and whose echo has not arrived, for a receiver that receives its
/// own transmitter.
///
/// If the receiver is off while the driver is on (/RE tied to DE), no echo arrives.
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
    /// Creates an echo. `hears_itself`: the line returns the bytes that are sent.
    pub const fn new(hears_itself: bool) -> Self {
        Echo {
            sent: [0; N],
            first: 0,
            length: 0,
            hears_itself,
        }
    }

    /// Whether the line returns the bytes that are sent.
    pub const fn hears_itself(&self) -> bool {
        self.hears_itself
    }

    /// Registers a byte that is being sent. Returns `false` if `N` bytes are in flight. This byte
    /// must then wait.
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

    /// Returns whether the echo of all bytes has arrived. Call it four characters after
    /// transmission is complete. Missing bytes are forgotten. They mean a broken line, or a
    /// receiver that does not receive its transmitter.
    pub fn silence(&mut self) -> bool {
        let all = self.length == 0;
        self.clear();
        all
    }

    /// Finds out with one harmless byte (0 for [`nmc`](crate::nmc)) whether the line returns the
    /// bytes that are sent. `heard` is the byte that arrived within four characters.
    pub fn learn(&mut self, sent: u8, heard: Option<u8>) {
        self.clear();
        self.hears_itself = heard == Some(sent);
    }

    fn clear(&mut self) {
        self.first = 0;
        self.length = 0;
    }
}
