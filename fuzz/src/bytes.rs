//! Fuzzer bytes as a stream of numbers.

/// Takes numbers from the front of the input; zeros when the bytes are used up.
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    /// Creates a stream of all of `data`.
    pub fn new(data: &'a [u8]) -> Bytes<'a> {
        Bytes(data)
    }

    /// Whether no byte is left.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        self.take::<1>()[0]
    }

    /// The next four bytes as a number. A fifth byte chooses the magnitude, so that small numbers
    /// are as likely as large ones.
    pub fn i32(&mut self) -> i32 {
        let shift = self.byte() % 32;
        i32::from_le_bytes(self.take()) >> shift
    }

    /// The next eight bytes as a number; a ninth byte chooses the magnitude.
    pub fn u64(&mut self) -> u64 {
        let shift = self.byte() % 64;
        u64::from_le_bytes(self.take()) >> shift
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, rest) = self.0.split_at(N.min(self.0.len()));
        self.0 = rest;
        let mut bytes = [0; N];
        bytes[..head.len()].copy_from_slice(head);
        bytes
    }
}
