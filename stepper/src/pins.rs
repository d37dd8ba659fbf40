//! Levels to pins, switches from pins: `embedded-hal` 1.0.

use embedded_hal::digital::{InputPin, OutputPin};

use crate::Levels;

/// The inputs of one driver on `PINS` pins: bit i of the levels goes to pin i. Only pins whose level changes are written.
#[derive(Debug)]
pub struct LevelPins<P, const PINS: usize> {
    pins: [P; PINS],
    /// What the pins show; unknown until the first write and after a failed one.
    shown: Option<Levels>,
}

impl<P: OutputPin, const PINS: usize> LevelPins<P, PINS> {
    /// Takes the pins, bit 0 first; nothing is written yet.
    pub const fn new(pins: [P; PINS]) -> Self {
        LevelPins { pins, shown: None }
    }

    /// Presents `levels`.
    ///
    /// # Errors
    /// The first pin's error; the next write then writes all pins again.
    pub fn write(&mut self, levels: Levels) -> Result<(), P::Error> {
        let changed = match self.shown.take() {
            Some(shown) => levels.0 ^ shown.0,
            None => 0xFF,
        };
        for (bit, pin) in (0..8).zip(&mut self.pins) {
            if changed & (1 << bit) != 0 {
                pin.set_state(levels.is_high(bit).into())?;
            }
        }
        self.shown = Some(levels);
        Ok(())
    }

    /// Gives the pins back.
    pub fn release(self) -> [P; PINS] {
        self.pins
    }
}

/// STEP and DIR on two pins.
#[derive(Debug)]
pub struct StepDirectionPins<S, D> {
    step: S,
    direction: D,
}

impl<S: OutputPin, D: OutputPin<Error = S::Error>> StepDirectionPins<S, D> {
    /// Takes the pins; nothing is written yet.
    pub const fn new(step: S, direction: D) -> Self {
        StepDirectionPins { step, direction }
    }

    /// Presents `levels`: DIR before STEP, so that a change of both is never a step the wrong way.
    ///
    /// # Errors
    /// The pin's error.
    pub fn write(&mut self, levels: Levels) -> Result<(), S::Error> {
        self.direction
            .set_state(levels.contains(Levels::DIR).into())?;
        self.step.set_state(levels.contains(Levels::STEP).into())
    }

    /// Gives the pins back.
    pub fn release(self) -> (S, D) {
        (self.step, self.direction)
    }
}

/// A home or limit switch on a pin.
#[derive(Debug)]
pub struct Switch<P> {
    pin: P,
    closed_is_high: bool,
}

impl<P: InputPin> Switch<P> {
    /// A switch that pulls the pin high when it is closed.
    pub const fn active_high(pin: P) -> Self {
        Switch {
            pin,
            closed_is_high: true,
        }
    }

    /// A switch that pulls the pin low when it is closed.
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
