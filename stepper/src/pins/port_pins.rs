//! All drivers at the pins of one port.

use super::DriverPins;
use crate::Levels;

/// A port of a board, whose pins are written together.
///
/// Most chips have a register that sets and clears pins in one write: BSRR of an STM32, for which
/// the value is `high | low << 16`. Others have one register for each.
///
/// # Examples
/// ```
/// use core::convert::Infallible;
/// use husillo_stepper::Port;
///
/// /// Port A of an STM32. On the chip, this is a write to `GPIOA.bsrr()`.
/// struct PortA { bsrr: u32 }
///
/// impl Port for PortA {
///     type Error = Infallible;
///     fn write(&mut self, high: u32, low: u32) -> Result<(), Infallible> {
///         self.bsrr = high | low << 16;
///         Ok(())
///     }
/// }
/// ```
pub trait Port {
    /// Why a write failed. `Infallible` for a register.
    type Error;

    /// Sets the pins of `high` and clears the pins of `low`. No bit is in both. All other pins keep
    /// their levels.
    ///
    /// # Errors
    /// The error of the port.
    fn write(&mut self, high: u32, low: u32) -> Result<(), Self::Error>;
}

/// Which bits of a port the inputs of one driver are. An input may have several bits, such as STEP
/// of two motors of one axis, or none. Several drivers may share a bit, such as ENABLE: it is on
/// while one of them is on.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PortBits {
    inputs: [u32; 8],
    inverted: u32,
}

impl PortBits {
    /// The inputs of any driver: bit i of its levels is high where the bits of `inputs[i]` are.
    /// Missing inputs have no bits.
    #[must_use]
    pub fn new(inputs: &[u32]) -> PortBits {
        let mut all = [0; 8];
        for (bits, given) in all.iter_mut().zip(inputs) {
            *bits = *given;
        }
        PortBits {
            inputs: all,
            inverted: 0,
        }
    }

    /// STEP, DIR and ENABLE of a driver that a low ENABLE switches on. Without a pin for ENABLE
    /// pass 0.
    #[must_use]
    pub fn active_low(step: u32, direction: u32, enable: u32) -> PortBits {
        PortBits::new(&[step, direction, enable]).inverted(enable)
    }

    /// STEP, DIR and ENABLE of a driver that a high ENABLE switches on.
    #[must_use]
    pub fn active_high(step: u32, direction: u32, enable: u32) -> PortBits {
        PortBits::new(&[step, direction, enable])
    }

    /// Inverts these bits of the port.
    #[must_use]
    pub const fn inverted(mut self, bits: u32) -> PortBits {
        self.inverted ^= bits;
        self
    }

    /// The bits of all inputs.
    fn all(self) -> u32 {
        self.inputs.iter().fold(0, |all, bits| all | bits)
    }

    /// The bits of the inputs that are high.
    fn high(self, levels: Levels) -> u32 {
        let inputs = (0..8).zip(self.inputs);
        let high = inputs.filter(|(bit, _)| levels.is_high(*bit));
        high.fold(0, |all, (_, bits)| all | bits)
    }
}

/// The inputs of `N` drivers at one port. A change of levels is one write of the port, however many
/// motors step: all STEP pins rise together.
///
/// # Examples
/// ```
/// use husillo_stepper::{DriverPins, Levels, PortBits, PortPins};
/// # use husillo_stepper::Port;
/// # struct PortA { writes: Vec<(u32, u32)> }
/// # impl Port for PortA {
/// #     type Error = core::convert::Infallible;
/// #     fn write(&mut self, high: u32, low: u32) -> Result<(), Self::Error> {
/// #         self.writes.push((high, low));
/// #         Ok(())
/// #     }
/// # }
/// # let mut port = PortA { writes: Vec::new() };
///
/// // STEP of X and Y at pins 0 and 1, DIR at pins 2 and 3, a common ENABLE at pin 8.
/// let x = PortBits::active_low(1 << 0, 1 << 2, 1 << 8);
/// let y = PortBits::active_low(1 << 1, 1 << 3, 1 << 8);
/// let mut motors = PortPins::new(&mut port, [x, y]);
/// let on = Levels(Levels::ENABLE.0 | Levels::DIR.0);
/// motors.write(&[on, on])?;
/// let step = Levels(on.0 | Levels::STEP.0);
/// motors.write(&[step, step])?;
/// assert_eq!(port.writes, [(0b1100, 0b1_0000_0011), (0b0011, 0)]);
/// # Ok::<(), core::convert::Infallible>(())
/// ```
#[derive(Debug)]
pub struct PortPins<P, const N: usize> {
    port: P,
    bits: [PortBits; N],
    /// The levels of the pins. Unknown until the first write and after a failed one.
    shown: Option<u32>,
}

impl<P: Port, const N: usize> PortPins<P, N> {
    /// Takes the port, and the bits of each driver. Nothing is written yet.
    pub const fn new(port: P, bits: [PortBits; N]) -> Self {
        PortPins {
            port,
            bits,
            shown: None,
        }
    }

    /// Returns the port.
    pub fn release(self) -> P {
        self.port
    }
}

impl<P: Port + ?Sized> Port for &mut P {
    type Error = P::Error;

    fn write(&mut self, high: u32, low: u32) -> Result<(), Self::Error> {
        P::write(self, high, low)
    }
}

impl<P: Port, const N: usize> DriverPins<N> for PortPins<P, N> {
    type Error = P::Error;

    /// Writes the port once, or not at all if no pin changes. After an error, the next call writes
    /// all pins.
    fn write(&mut self, levels: &[Levels; N]) -> Result<(), P::Error> {
        let (mut all, mut high, mut inverted) = (0, 0, 0);
        for (bits, levels) in self.bits.iter().zip(levels) {
            all |= bits.all();
            high |= bits.high(*levels);
            inverted |= bits.inverted;
        }
        let wanted = (high ^ inverted) & all;
        let changed = match self.shown.take() {
            Some(shown) => wanted ^ shown,
            None => all,
        };
        if changed != 0 {
            self.port.write(wanted & changed, !wanted & changed)?;
        }
        self.shown = Some(wanted);
        Ok(())
    }
}
