//! A switch at a pin.

use embedded_hal::digital::InputPin;

/// A home or limit switch on a pin.
#[derive(Debug)]
pub struct Switch<P> {
    pin: P,
    closed_is_high: bool,
}

impl<P: InputPin> Switch<P> {
    /// Creates a switch that pulls the pin high when it is closed.
    pub const fn active_high(pin: P) -> Self {
        Switch {
            pin,
            closed_is_high: true,
        }
    }

    /// Creates a switch that pulls the pin low when it is closed.
    pub const fn active_low(pin: P) -> Self {
        Switch {
            pin,
            closed_is_high: false,
        }
    }

    /// Whether the switch is closed.
    ///
    /// # Errors
    /// The pin's error.
    pub fn is_closed(&mut self) -> Result<bool, P::Error> {
        Ok(self.pin.is_high()? == self.closed_is_high)
    }
}
