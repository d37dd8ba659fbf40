//! Driver enable on a pin: `embedded-hal` 1.0.

use embedded_hal::digital::OutputPin;

/// The pin DE of a transceiver. High drives the line. For an inverted pin, low drives it.
#[derive(Debug)]
pub struct EnablePin<P> {
    pin: P,
    driving_is_high: bool,
}

impl<P: OutputPin> EnablePin<P> {
    /// Takes a pin that drives the line while it is high. It is not written yet.
    pub const fn active_high(pin: P) -> Self {
        EnablePin {
            pin,
            driving_is_high: true,
        }
    }

    /// Takes a pin that drives the line while it is low. It is not written yet.
    pub const fn active_low(pin: P) -> Self {
        EnablePin {
            pin,
            driving_is_high: false,
        }
    }

    /// Drives the line, or releases it.
    ///
    /// # Errors
    /// The error of the pin.
    pub fn set(&mut self, is_driving: bool) -> Result<(), P::Error> {
        self.pin
            .set_state((is_driving == self.driving_is_high).into())
    }

    /// Returns the pin.
    pub fn release(self) -> P {
        self.pin
    }
}
