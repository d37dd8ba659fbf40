//! STEP, DIR and ENABLE at three pins.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};

use super::{DriverPins, PinError};
use crate::Levels;

/// STEP, DIR and ENABLE of a step and direction driver on three pins, each of its own type. Only
/// pins whose level changes are written: ENABLE, then DIR, then STEP.
///
/// It keeps no times. [`StepPulses`](crate::StepPulses) makes pulses with the times of a data sheet
/// at these pins.
///
/// If ENABLE of the driver is wired permanently, there is no third pin: pass [`Unwired`].
#[derive(Debug)]
pub struct StepDirectionPins<S, D, E> {
    step: S,
    direction: D,
    enable: E,
    /// Inputs that are low where their level is high.
    inverted: Levels,
    /// The levels written last. Unknown until the first write and after a failed one.
    shown: Option<Levels>,
}

impl<S: OutputPin, D: OutputPin, E: OutputPin> StepDirectionPins<S, D, E> {
    /// Creates a driver that a low ENABLE switches on, as most drivers (A4988, DRV8825, TMC).
    /// Nothing is written yet.
    pub const fn active_low(step: S, direction: D, enable: E) -> Self {
        StepDirectionPins {
            step,
            direction,
            enable,
            inverted: Levels::ENABLE,
            shown: None,
        }
    }

    /// Creates a driver that a high ENABLE switches on. Nothing is written yet.
    pub const fn active_high(step: S, direction: D, enable: E) -> Self {
        StepDirectionPins {
            step,
            direction,
            enable,
            inverted: Levels(0),
            shown: None,
        }
    }

    /// Inverts the pins of `inputs`: [`Levels::STEP`] for optocouplers whose anodes are common,
    /// [`Levels::DIR`] for a motor that turns the other way.
    #[must_use]
    pub const fn inverted(mut self, inputs: Levels) -> Self {
        self.inverted = Levels(self.inverted.0 ^ inputs.0);
        self
    }

    /// Returns the pins: STEP, DIR, ENABLE.
    pub fn release(self) -> (S, D, E) {
        (self.step, self.direction, self.enable)
    }
}

impl<S: OutputPin, D: OutputPin, E: OutputPin> DriverPins<1> for StepDirectionPins<S, D, E> {
    type Error = PinError;

    /// Writes the pins that change. After an error, the next call writes all of them.
    fn write(&mut self, [levels]: &[Levels; 1]) -> Result<(), PinError> {
        let changed = Levels::changed(self.shown.take(), *levels);
        let is_high = |input: Levels| levels.contains(input) != self.inverted.contains(input);
        if changed.contains(Levels::ENABLE) {
            let state = is_high(Levels::ENABLE).into();
            self.enable.set_state(state).map_err(PinError::of)?;
        }
        if changed.contains(Levels::DIR) {
            let state = is_high(Levels::DIR).into();
            self.direction.set_state(state).map_err(PinError::of)?;
        }
        if changed.contains(Levels::STEP) {
            let state = is_high(Levels::STEP).into();
            self.step.set_state(state).map_err(PinError::of)?;
        }
        self.shown = Some(*levels);
        Ok(())
    }
}

/// The absent pin of an input that is wired permanently.
#[derive(Copy, Clone, Debug, Default)]
pub struct Unwired;

impl ErrorType for Unwired {
    type Error = Infallible;
}

impl OutputPin for Unwired {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
