//! The lines that are sent and not yet answered.

use husillo_transports::grbl::{RECEIVE_BYTES, Window};
use std::collections::VecDeque;

/// The lines that are sent and not yet answered, each with its purpose. A controller answers lines
/// in their order.
#[derive(Debug)]
pub struct Stream<T> {
    window: Window,
    purposes: VecDeque<T>,
}

impl<T> Default for Stream<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> Stream<T> {
    /// Creates it without lines.
    pub const fn new() -> Self {
        Self {
            // Grbl's buffer holds one byte less than Grbl reports.
            window: Window::new(RECEIVE_BYTES - 1),
            purposes: VecDeque::new(),
        }
    }

    /// Whether the receive buffer of the controller has room for a line. A line that is longer than
    /// the buffer has room if all other lines are answered.
    pub fn has_room(&self, line: &str) -> bool {
        let fits = usize::from(self.window.bytes()) + line.len() + 1 < usize::from(RECEIVE_BYTES);
        fits || self.purposes.is_empty()
    }

    /// Counts a line that is sent.
    pub fn sent(&mut self, line: &str, purpose: T) {
        let length = u8::try_from(line.len() + 1).unwrap_or(u8::MAX);
        self.window.send(length);
        self.purposes.push_back(purpose);
    }

    /// Counts an answer. Returns the purpose of its line, or `None` if no line waits for an answer.
    pub fn answered(&mut self) -> Option<T> {
        self.window.answered();
        self.purposes.pop_front()
    }

    /// The purpose of the line that is answered next.
    pub fn next(&self) -> Option<&T> {
        self.purposes.front()
    }

    /// The purposes of all lines without an answer, in the order of the answers.
    pub fn purposes(&self) -> impl Iterator<Item = &T> {
        self.purposes.iter()
    }

    /// Whether all lines are answered.
    pub fn is_empty(&self) -> bool {
        self.purposes.is_empty()
    }

    /// Forgets all lines, after a reset of the controller. Returns their purposes.
    pub fn clear(&mut self) -> impl Iterator<Item = T> + use<T> {
        self.window.clear();
        std::mem::take(&mut self.purposes).into_iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fill_the_buffer_and_are_answered_in_order() {
        let mut stream = Stream::new();
        let line = "G1X1.000Y1.000Z1.000F100.0"; // 27 bytes with its end
        let mut sent = 0;
        while stream.has_room(line) {
            stream.sent(line, sent);
            sent += 1;
        }
        assert_eq!(sent, 4);
        assert_eq!(stream.answered(), Some(0));
        assert!(stream.has_room(line));
        assert_eq!(stream.clear().collect::<Vec<_>>(), [1, 2, 3]);
        assert!(stream.is_empty() && stream.answered().is_none());
    }

    #[test]
    fn a_line_longer_than_the_buffer_is_sent_alone() {
        let mut stream = Stream::new();
        let long = "X".repeat(300);
        assert!(stream.has_room(&long));
        stream.sent("G0", ());
        assert!(!stream.has_room(&long));
    }
}
