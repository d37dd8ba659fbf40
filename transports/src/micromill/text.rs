//! A string under construction.

use super::STRING_BYTES;
use crate::buffer::Buffer;

/// A string of the link with its `;`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Text(Buffer<STRING_BYTES>);

impl Text {
    pub(super) const fn new() -> Text {
        Text(Buffer::new())
    }

    /// Returns its bytes.
    pub fn bytes(&self) -> &[u8] {
        self.0.bytes()
    }

    pub(super) fn push(&mut self, byte: u8) {
        self.0.push(byte);
    }

    pub(super) fn sign(&mut self, is_forward: bool) {
        self.push(if is_forward { b'+' } else { b'-' });
    }

    /// Appends this many digits, at most five, with leading zeros.
    pub(super) fn digits(&mut self, value: u32, count: u8) {
        for (place, power) in [(4, 10_000), (3, 1000), (2, 100), (1, 10), (0, 1_u32)] {
            if place < count {
                let digit = value.checked_div(power).unwrap_or(0) % 10;
                self.push(b'0'.wrapping_add(digit as u8));
            }
        }
    }

    /// Appends a letter and micrometres, with five digits, two decimals, and a sign if negative.
    pub(super) fn coordinate(&mut self, letter: u8, value: Option<i32>) {
        let Some(value) = value else { return };
        self.push(letter);
        if value < 0 {
            self.push(b'-');
        }
        let parts = value.unsigned_abs();
        self.digits(parts / 100, 5);
        self.push(b'.');
        self.digits(parts % 100, 2);
    }
}
