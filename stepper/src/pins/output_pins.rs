//! The pins of one driver, each of its own type.

use embedded_hal::digital::OutputPin;

use super::PinError;
use crate::Levels;

/// Up to eight pins, the first one for bit 0: a tuple of pins, each of its own type, or an array of
/// pins of one type.
pub trait OutputPins {
    /// The number of pins.
    const COUNT: usize;

    /// Sets the pins of the bits that are set in `changed`. Bits without a pin have no effect.
    ///
    /// # Errors
    /// The error of the first pin that fails.
    fn set(&mut self, levels: Levels, changed: Levels) -> Result<(), PinError>;
}

fn set<P: OutputPin>(
    pin: &mut P,
    bit: u32,
    levels: Levels,
    changed: Levels,
) -> Result<(), PinError> {
    if !changed.is_high(bit) {
        return Ok(());
    }
    pin.set_state(levels.is_high(bit).into())
        .map_err(PinError::of)
}

impl<P: OutputPin, const N: usize> OutputPins for [P; N] {
    const COUNT: usize = N;

    fn set(&mut self, levels: Levels, changed: Levels) -> Result<(), PinError> {
        for (bit, pin) in (0..8).zip(self) {
            set(pin, bit, levels, changed)?;
        }
        Ok(())
    }
}

/// Implements the trait for a tuple: the number of pins, and for each a type and its place.
macro_rules! tuple {
    ($count:literal: $($pin:ident $bit:tt),+) => {
        impl<$($pin: OutputPin),+> OutputPins for ($($pin,)+) {
            const COUNT: usize = $count;

            fn set(&mut self, levels: Levels, changed: Levels) -> Result<(), PinError> {
                $(set(&mut self.$bit, $bit, levels, changed)?;)+
                Ok(())
            }
        }
    };
}

tuple!(1: A 0);
tuple!(2: A 0, B 1);
tuple!(3: A 0, B 1, C 2);
tuple!(4: A 0, B 1, C 2, D 3);
tuple!(5: A 0, B 1, C 2, D 3, E 4);
tuple!(6: A 0, B 1, C 2, D 3, E 4, F 5);
tuple!(7: A 0, B 1, C 2, D 3, E 4, F 5, G 6);
tuple!(8: A 0, B 1, C 2, D 3, E 4, F 5, G 6, H 7);
