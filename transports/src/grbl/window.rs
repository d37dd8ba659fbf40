//! Character counting: what a sender may send ahead.

use crate::grbl::RECEIVE_BYTES;

/// The lines that a sender has sent and that are not yet answered. Their bytes stay within the
/// receive buffer of the controller.
///
/// # Examples
///
/// ```
/// use husillo_transports::grbl::Window;
///
/// let mut window = Window::new(10);
/// assert!(window.send(6)); // "G1X10\n"
/// assert!(!window.send(6));
/// assert_eq!(window.answered(), Some(6));
/// assert!(window.send(6));
/// ```
#[derive(Clone, Debug)]
pub struct Window {
    lengths: [u8; RECEIVE_BYTES as usize],
    first: usize,
    count: usize,
    bytes: u16,
    capacity: u16,
}

impl Window {
    /// A window of a number of bytes, at most 255. Grbl takes 128.
    pub const fn new(capacity: u8) -> Self {
        Window {
            lengths: [0; RECEIVE_BYTES as usize],
            first: 0,
            count: 0,
            bytes: 0,
            capacity: capacity as u16,
        }
    }

    /// Counts a line, its end included, that is sent now. Returns `false` if it has to wait. A line
    /// that is longer than the window may be sent alone.
    pub fn send(&mut self, length: u8) -> bool {
        let place = self.first.wrapping_add(self.count) % self.lengths.len();
        let fits = self.bytes.saturating_add(length.into()) <= self.capacity || self.count == 0;
        match self.lengths.get_mut(place) {
            Some(slot) if fits && self.count < usize::from(RECEIVE_BYTES) => {
                *slot = length;
                self.count = self.count.wrapping_add(1); // it was below 128
                self.bytes = self.bytes.saturating_add(length.into());
                true
            }
            _ => false,
        }
    }

    /// An `ok` or `error:N` has come: returns the length of the line that it answers. `None`: no
    /// line was owed an answer.
    pub fn answered(&mut self) -> Option<u8> {
        if self.count == 0 {
            return None;
        }
        let length = self.lengths.get(self.first).copied()?;
        self.first = self.first.wrapping_add(1) % self.lengths.len();
        self.count = self.count.wrapping_sub(1); // it was above 0
        self.bytes = self.bytes.saturating_sub(length.into());
        Some(length)
    }

    /// Forgets all lines, after a reset of the controller.
    pub const fn clear(&mut self) {
        self.count = 0;
        self.bytes = 0;
    }

    /// Number of bytes that are not answered.
    pub const fn bytes(&self) -> u16 {
        self.bytes
    }

    /// Number of lines that are not answered.
    pub const fn lines(&self) -> usize {
        self.count
    }
}
