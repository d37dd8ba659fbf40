//! Character counting: the number of bytes that a sender may send ahead.

use crate::grbl::RECEIVE_BYTES;

/// The lines that a sender has sent and that are not answered yet. Their bytes fit the receive
/// buffer of the controller.
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
    /// Creates a window of this many bytes, at most 255. Grbl accepts 128.
    pub const fn new(capacity: u8) -> Self {
        Window {
            lengths: [0; RECEIVE_BYTES as usize],
            first: 0,
            count: 0,
            bytes: 0,
            capacity: capacity as u16,
        }
    }

    /// Counts a line, with its end, that the sender wants to send. Returns `false` if the line must
    /// wait. A line longer than the window may be sent alone.
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

    /// Registers an `ok` or `error:N`. Returns the length of the line that it answers, or `None` if
    /// no line waits for an answer.
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

    /// Drops all lines, after a reset of the controller.
    pub const fn clear(&mut self) {
        self.count = 0;
        self.bytes = 0;
    }

    /// Returns the number of bytes without an answer.
    pub const fn bytes(&self) -> u16 {
        self.bytes
    }

    /// Returns the number of lines without an answer.
    pub const fn lines(&self) -> usize {
        self.count
    }
}
