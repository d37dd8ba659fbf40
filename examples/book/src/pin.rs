//! A pin that is an output of the program, an input, or both.

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

/// A pin, low at first. All clones are the same pin.
#[derive(Clone, Debug, Default)]
pub struct Pin(Rc<Inside>);

#[derive(Debug, Default)]
struct Inside {
    is_high: Cell<bool>,
    rising_edges: Cell<u32>,
}

impl Pin {
    /// The level. High is `true`.
    pub fn level(&self) -> bool {
        self.0.is_high.get()
    }

    /// Sets the level.
    pub fn set(&self, is_high: bool) {
        if is_high && !self.level() {
            self.0.rising_edges.set(self.rising_edges() + 1);
        }
        self.0.is_high.set(is_high);
    }

    /// The number of rising edges so far.
    pub fn rising_edges(&self) -> u32 {
        self.0.rising_edges.get()
    }
}

impl ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}

impl InputPin for Pin {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.level())
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.level())
    }
}
