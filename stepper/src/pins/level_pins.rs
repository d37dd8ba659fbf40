//! The inputs of any driver: bit i of the levels is pin i.

use core::fmt;

use super::{DriverPins, OutputPins, PinError};
use crate::{Driver, Levels};

/// The inputs of one driver on pins of any types: bit i of the levels is pin i. Only pins whose
/// level changes are written.
///
/// # Examples
/// ```
/// use husillo_stepper::{Driver, LevelPins, PinCount};
/// # use embedded_hal::digital::{ErrorType, OutputPin};
/// # struct Pin;
/// # impl ErrorType for Pin { type Error = core::convert::Infallible; }
/// # impl OutputPin for Pin {
/// #     fn set_low(&mut self) -> Result<(), Self::Error> { Ok(()) }
/// #     fn set_high(&mut self) -> Result<(), Self::Error> { Ok(()) }
/// # }
/// # let (p0, p1, p2) = (Pin, Pin, Pin);
///
/// // A unipolar motor has four coils.
/// let short = LevelPins::of(Driver::Unipolar, (p0, p1, p2));
/// assert_eq!(short.err(), Some(PinCount { given: 3, wanted: 4 }));
/// ```
#[derive(Debug)]
pub struct LevelPins<P> {
    pins: P,
    /// The levels of the pins. Unknown until the first write and after a failed one.
    shown: Option<Levels>,
}

/// The number of pins is not that of the inputs of the driver.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PinCount {
    /// The number of pins.
    pub given: usize,
    /// The number of inputs of the driver.
    pub wanted: usize,
}

impl fmt::Display for PinCount {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PinCount { given, wanted } = self;
        write!(formatter, "{given} pins for {wanted} inputs")
    }
}

impl core::error::Error for PinCount {}

impl<P: OutputPins> LevelPins<P> {
    /// Takes the pins of a driver of your own, bit 0 first: a tuple or an array. Bits without a pin
    /// have no effect. Nothing is written yet.
    pub const fn new(pins: P) -> Self {
        LevelPins { pins, shown: None }
    }

    /// Takes the pins of `driver`, in the order of [`Driver::pins`]. HOME of the L297 is an output
    /// of the chip, so it has no pin here. Nothing is written yet.
    ///
    /// # Errors
    /// [`PinCount`] if there are fewer or more pins than inputs.
    pub fn of(driver: Driver, pins: P) -> Result<Self, PinCount> {
        let (given, wanted) = (P::COUNT, driver.inputs());
        if given == wanted {
            Ok(LevelPins::new(pins))
        } else {
            Err(PinCount { given, wanted })
        }
    }

    /// Returns the pins.
    pub fn release(self) -> P {
        self.pins
    }
}

impl<P: OutputPins> DriverPins<1> for LevelPins<P> {
    type Error = PinError;

    /// Writes the pins that change. After an error, the next call writes all of them.
    fn write(&mut self, [levels]: &[Levels; 1]) -> Result<(), PinError> {
        let changed = Levels::changed(self.shown.take(), *levels);
        self.pins.set(*levels, changed)?;
        self.shown = Some(*levels);
        Ok(())
    }
}
