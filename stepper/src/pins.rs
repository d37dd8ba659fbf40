//! Levels to pins, switches from pins: `embedded-hal` 1.0.

use core::marker::PhantomData;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};

use crate::{Levels, PulseNanoseconds};

/// The inputs of one driver on `PINS` pins: bit i of the levels is pin i. Only pins whose level
/// changes are written.
#[derive(Debug)]
pub struct LevelPins<P, const PINS: usize> {
    pins: [P; PINS],
    /// The levels of the pins. Unknown until the first write and after a failed one.
    shown: Option<Levels>,
}

impl<P: OutputPin, const PINS: usize> LevelPins<P, PINS> {
    /// Takes the pins, bit 0 first. Nothing is written yet.
    pub const fn new(pins: [P; PINS]) -> Self {
        LevelPins { pins, shown: None }
    }

    /// Writes `levels`.
    ///
    /// # Errors
    /// The error of the first pin that fails. The next write then writes all pins.
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

    /// Returns the pins.
    pub fn release(self) -> [P; PINS] {
        self.pins
    }
}

/// STEP, DIR and ENABLE of a step and direction driver on three pins.
///
/// It has two uses. [`step`](StepDirectionPins::step) makes a whole pulse and waits for it, for a
/// motor that a loop drives. [`write`](StepDirectionPins::write) writes levels, for a timer
/// interrupt that follows the phases of [`StepDirection`](crate::StepDirection).
///
/// If ENABLE of the driver is wired permanently, there is no third pin: pass [`Unwired`].
#[derive(Debug)]
pub struct StepDirectionPins<S, D, E> {
    step: S,
    direction: D,
    enable: E,
    enable_is_high: bool,
    times: PulseNanoseconds,
    /// The levels of the pins. Unknown until the first write and after a failed one.
    shown: Option<Levels>,
}

impl<S: OutputPin, D: OutputPin<Error = S::Error>, E: OutputPin<Error = S::Error>>
    StepDirectionPins<S, D, E>
{
    /// Creates a driver that a low ENABLE switches on, as most drivers (A4988, DRV8825, TMC).
    /// Nothing is written yet.
    pub const fn active_low(step: S, direction: D, enable: E, times: PulseNanoseconds) -> Self {
        StepDirectionPins {
            step,
            direction,
            enable,
            enable_is_high: false,
            times,
            shown: None,
        }
    }

    /// Creates a driver that a high ENABLE switches on. Nothing is written yet.
    pub const fn active_high(step: S, direction: D, enable: E, times: PulseNanoseconds) -> Self {
        StepDirectionPins {
            step,
            direction,
            enable,
            enable_is_high: true,
            times,
            shown: None,
        }
    }

    /// Writes `levels`: ENABLE, then DIR, then STEP. Only pins whose level changes are written.
    ///
    /// If DIR changes and STEP rises in one call, the set-up time passes between them. The caller
    /// keeps all other times; `StepDirection` gives them.
    ///
    /// # Errors
    /// The error of the first pin that fails. The next write then writes all pins.
    pub fn write<W: DelayNs>(&mut self, levels: Levels, delay: &mut W) -> Result<(), S::Error> {
        let changed = match self.shown.take() {
            Some(shown) => Levels(levels.0 ^ shown.0),
            None => Levels(0xFF),
        };
        if changed.contains(Levels::ENABLE) {
            let is_high = levels.contains(Levels::ENABLE) == self.enable_is_high;
            self.enable.set_state(is_high.into())?;
        }
        if changed.contains(Levels::DIR) {
            self.direction
                .set_state(levels.contains(Levels::DIR).into())?;
            if changed.contains(Levels::STEP) && levels.contains(Levels::STEP) {
                delay.delay_ns(self.times.setup);
            }
        }
        if changed.contains(Levels::STEP) {
            self.step.set_state(levels.contains(Levels::STEP).into())?;
        }
        self.shown = Some(levels);
        Ok(())
    }

    /// Makes one step in the direction of the sign of `delta`: DIR, the set-up time, STEP high and
    /// low for their times, and the rest of the hold time. ENABLE is switched on. With `delta` 0 it
    /// does nothing.
    ///
    /// # Errors
    /// The error of the first pin that fails. The next step then writes all pins.
    pub fn step<W: DelayNs>(&mut self, delta: i8, delay: &mut W) -> Result<(), S::Error> {
        if delta == 0 {
            return Ok(());
        }
        let direction = if delta > 0 { Levels::DIR.0 } else { 0 };
        let low = Levels(Levels::ENABLE.0 | direction);
        if self.shown != Some(low) {
            self.write(low, delay)?;
            delay.delay_ns(self.times.setup);
        }
        self.write(Levels(low.0 | Levels::STEP.0), delay)?;
        delay.delay_ns(self.times.high);
        self.write(low, delay)?;
        let pulse = self.times.high.saturating_add(self.times.low);
        let rest = self.times.hold.saturating_sub(pulse);
        delay.delay_ns(self.times.low.saturating_add(rest));
        Ok(())
    }

    /// Returns the pins: STEP, DIR, ENABLE.
    pub fn release(self) -> (S, D, E) {
        (self.step, self.direction, self.enable)
    }
}

/// The absent pin of an input that is wired permanently.
///
/// `E` is the error type of the other pins. This pin has no errors.
#[derive(Copy, Clone, Debug, Default)]
pub struct Unwired<E>(PhantomData<E>);

impl<E> Unwired<E> {
    /// Creates it.
    #[must_use]
    pub const fn new() -> Self {
        Unwired(PhantomData)
    }
}

impl<E: embedded_hal::digital::Error> ErrorType for Unwired<E> {
    type Error = E;
}

impl<E: embedded_hal::digital::Error> OutputPin for Unwired<E> {
    fn set_low(&mut self) -> Result<(), E> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), E> {
        Ok(())
    }
}

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
