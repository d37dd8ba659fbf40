//! The receiving end of a controller.

use crate::grbl::{RECEIVE_BYTES, Realtime};

/// Separates the bytes of the line. A real-time byte is returned immediately. Other bytes wait in a
/// buffer of `N` bytes until the controller takes them.
///
/// Grbl has `N` = 128. A controller with a larger buffer should still report 128, because some
/// senders write additional lines without counting them.
///
/// # Examples
///
/// ```
/// use husillo_transports::grbl::{Realtime, Receiver};
///
/// let mut receiver = Receiver::<128>::new();
/// assert_eq!(receiver.push(b'G'), None);
/// assert_eq!(receiver.push(b'?'), Some(Realtime::Status));
/// assert_eq!((receiver.take(), receiver.take()), (Some(b'G'), None));
/// ```
#[derive(Clone, Debug)]
pub struct Receiver<const N: usize> {
    bytes: [u8; N],
    first: usize,
    length: usize,
    lost: u32,
}

impl<const N: usize> Default for Receiver<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Receiver<N> {
    /// Creates an empty buffer.
    pub const fn new() -> Self {
        Receiver {
            bytes: [0; N],
            first: 0,
            length: 0,
            lost: 0,
        }
    }

    /// Takes a byte of the line. Returns its meaning if it takes effect immediately. A byte for
    /// which there is no room is lost.
    pub fn push(&mut self, byte: u8) -> Option<Realtime> {
        if let Some(realtime) = Realtime::of(byte) {
            return Some(realtime);
        }
        let place = self.place(self.length);
        match self.bytes.get_mut(place) {
            Some(slot) if self.length < N => {
                *slot = byte;
                self.length = self.length.wrapping_add(1); // it was below N
            }
            _ => self.lost = self.lost.saturating_add(1),
        }
        None
    }

    /// Removes and returns the oldest byte.
    pub fn take(&mut self) -> Option<u8> {
        if self.length == 0 {
            return None;
        }
        let byte = self.bytes.get(self.first).copied();
        self.first = self.place(1);
        self.length = self.length.wrapping_sub(1); // it was above 0
        byte
    }

    /// Drops all bytes, as a reset does.
    pub const fn clear(&mut self) {
        self.length = 0;
    }

    /// Returns the number of free bytes for a status report: at most 128.
    pub fn free(&self) -> u8 {
        let used = u8::try_from(self.length).unwrap_or(u8::MAX);
        RECEIVE_BYTES.saturating_sub(used)
    }

    /// Returns the number of free bytes.
    pub const fn room(&self) -> usize {
        N.saturating_sub(self.length)
    }

    /// Returns the number of bytes lost so far.
    pub const fn lost(&self) -> u32 {
        self.lost
    }

    /// Returns the index of the byte `behind` bytes after the oldest. Both are at most `N`.
    const fn place(&self, behind: usize) -> usize {
        let place = self.first.wrapping_add(behind);
        if place >= N {
            place.wrapping_sub(N)
        } else {
            place
        }
    }
}
