//! The inputs of the drivers of a machine, wherever they are.

use core::convert::Infallible;
use core::fmt;

use embedded_hal::digital::{Error, ErrorKind};

use crate::Levels;

/// The inputs of `N` drivers, at the pins of a board.
///
/// One driver is [`LevelPins`](crate::LevelPins) or
/// [`StepDirectionPins`](crate::StepDirectionPins). Several drivers are a tuple of up to eight such
/// values, each of its own type, or an array of values of one type.
/// [`PortPins`](crate::PortPins) writes all drivers at once, if their pins are on one port.
/// Implement it for what else a board has, such as a shift register.
///
/// # Examples
/// ```
/// use husillo_stepper::{DriverPins, LevelPins, Levels, PinError, StepDirectionPins, Unwired};
/// # use embedded_hal::digital::{ErrorType, OutputPin};
/// # macro_rules! pins { ($($pin:ident)+) => { $(
/// #     struct $pin;
/// #     impl ErrorType for $pin { type Error = core::convert::Infallible; }
/// #     impl OutputPin for $pin {
/// #         fn set_low(&mut self) -> Result<(), Self::Error> { Ok(()) }
/// #         fn set_high(&mut self) -> Result<(), Self::Error> { Ok(()) }
/// #     }
/// # )+ } }
/// # pins!(PA0 PA1 PB4 PB5 PB6 PC7);
/// # let (pa0, pa1, pb4, pb5, pb6, pc7) = (PA0, PA1, PB4, PB5, PB6, PC7);
///
/// let x = StepDirectionPins::active_low(pa0, pa1, Unwired);
/// let z = LevelPins::new((pb4, pb5, pb6, pc7)); // a unipolar motor
/// let mut machine = (x, z);
/// machine.write(&[Levels::DIR, Levels(0b0011)])?;
/// # Ok::<(), PinError>(())
/// ```
pub trait DriverPins<const N: usize> {
    /// Why a write failed.
    type Error;

    /// Writes the levels of all drivers.
    ///
    /// Within one driver, ENABLE and DIR change before STEP. No time passes between them: the
    /// caller keeps the times, or [`StepPulses`](crate::StepPulses) does.
    ///
    /// # Errors
    /// The error of the first pin that fails.
    fn write(&mut self, levels: &[Levels; N]) -> Result<(), Self::Error>;
}

impl<const N: usize, D: DriverPins<N> + ?Sized> DriverPins<N> for &mut D {
    type Error = D::Error;

    fn write(&mut self, levels: &[Levels; N]) -> Result<(), Self::Error> {
        D::write(self, levels)
    }
}

impl<const N: usize, D: DriverPins<1>> DriverPins<N> for [D; N] {
    type Error = D::Error;

    fn write(&mut self, levels: &[Levels; N]) -> Result<(), Self::Error> {
        for (driver, levels) in self.iter_mut().zip(levels) {
            driver.write(&[*levels])?;
        }
        Ok(())
    }
}

/// Implements the trait for a tuple: the number of drivers, and for each a type and two names.
macro_rules! tuple {
    ($count:literal: $first:ident $x:ident $a:ident $(, $driver:ident $y:ident $b:ident)*) => {
        impl<$first: DriverPins<1>, $($driver: DriverPins<1, Error = $first::Error>),*>
            DriverPins<$count> for ($first, $($driver,)*)
        {
            type Error = $first::Error;

            fn write(&mut self, levels: &[Levels; $count]) -> Result<(), Self::Error> {
                let ($x, $($y,)*) = self;
                let [$a, $($b),*] = levels;
                $x.write(&[*$a])?;
                $($y.write(&[*$b])?;)*
                Ok(())
            }
        }
    };
}

tuple!(1: A x a);
tuple!(2: A x a, B y b);
tuple!(3: A x a, B y b, C z c);
tuple!(4: A x a, B y b, C z c, D u d);
tuple!(5: A x a, B y b, C z c, D u d, E v e);
tuple!(6: A x a, B y b, C z c, D u d, E v e, F w f);
tuple!(7: A x a, B y b, C z c, D u d, E v e, F w f, G s g);
tuple!(8: A x a, B y b, C z c, D u d, E v e, F w f, G s g, H t h);

/// A pin could not be written. The pins of a driver may have different types of errors, so this is
/// their common kind.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct PinError(pub ErrorKind);

impl PinError {
    /// The kind of the error of a pin.
    pub(super) fn of<E: Error>(error: E) -> PinError {
        PinError(error.kind())
    }
}

impl fmt::Display for PinError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a pin of a driver cannot be written")
    }
}

impl core::error::Error for PinError {}

impl From<Infallible> for PinError {
    fn from(never: Infallible) -> PinError {
        match never {}
    }
}
