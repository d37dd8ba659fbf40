//! The bytes for the UART.

/// Sends the bytes of a controller, as fast as the UART takes them.
#[derive(Default)]
pub struct Transmitter {
    /// A byte that the UART has not taken yet.
    unsent: Option<u8>,
}

impl Transmitter {
    /// A transmitter without a byte to send.
    pub const fn new() -> Self {
        Transmitter { unsent: None }
    }

    /// Sends bytes until there is none left or the UART takes no more. Returns whether there was
    /// one.
    #[inline]
    pub fn send(&mut self, mut next: impl FnMut() -> Option<u8>) -> bool {
        let mut is_busy = false;
        while let Some(byte) = self.unsent.take().or_else(&mut next) {
            is_busy = true;
            if !board::send(byte) {
                self.unsent = Some(byte);
                break;
            }
        }
        is_busy
    }

    /// Asks for the next byte, if none is waiting. Returns whether there is nothing to send.
    #[inline]
    pub fn is_empty_after(&mut self, next: impl FnOnce() -> Option<u8>) -> bool {
        self.unsent = self.unsent.take().or_else(next);
        self.unsent.is_none()
    }

    /// Drops the byte that the UART has not taken yet.
    pub fn clear(&mut self) {
        self.unsent = None;
    }
}
