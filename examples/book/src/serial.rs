//! A serial port whose other end is the test.

use embedded_io::{ErrorType, Read, ReadReady, Write};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;

/// A port. All clones are the same port.
#[derive(Clone, Debug, Default)]
pub struct Serial(Rc<RefCell<Buffers>>);

#[derive(Debug, Default)]
struct Buffers {
    received: VecDeque<u8>,
    sent: Vec<u8>,
}

impl Serial {
    /// Puts bytes into the receive buffer, as if the other end had sent them.
    pub fn receive(&self, bytes: &[u8]) {
        self.0.borrow_mut().received.extend(bytes);
    }

    /// Takes everything that the program has sent, as text.
    pub fn take_sent(&self) -> String {
        String::from_utf8_lossy(&std::mem::take(&mut self.0.borrow_mut().sent)).into_owned()
    }
}

impl ErrorType for Serial {
    type Error = Infallible;
}

impl ReadReady for Serial {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.borrow().received.is_empty())
    }
}

impl Read for Serial {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let received = &mut self.0.borrow_mut().received;
        let length = bytes.len().min(received.len());
        bytes
            .iter_mut()
            .zip(received.drain(..length))
            .for_each(|(to, from)| *to = from);
        Ok(length)
    }
}

impl Write for Serial {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        self.0.borrow_mut().sent.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
