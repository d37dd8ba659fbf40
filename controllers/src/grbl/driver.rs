//! Settings of the drivers of the motors.

use super::GrblMemory;

/// Settings of the driver of an axis: a chip that takes them over a serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrblDriver {
    /// Current of the motor while it turns, RMS, in milliamperes: `$140` to `$142`.
    pub milliamperes: u16,
    /// Microsteps of a full step: `$150` to `$152`. A power of two up to 256; another number is
    /// rounded down to one.
    pub microsteps: u16,
    /// Whether the motor is driven by voltage and is silent (StealthChop): `$450`.
    pub is_silent: bool,
    /// Threshold of StallGuard, if the axis is homed without a switch: `$200` to `$202`, and
    /// `$339`.
    pub stall_threshold: Option<u8>,
}

impl GrblMemory {
    /// Returns the settings of the driver of an axis: 0 for X. `None` beyond Z.
    pub fn driver(&self, axis: u8) -> Option<GrblDriver> {
        if axis > 2 {
            return None;
        }
        // Numbers are below 500, and the ranges of the settings fit the fields.
        let whole = |number: u16| self.hal.whole(number);
        let of_axis = |first: u16| whole(first.wrapping_add(axis.into()));
        let has_bit = |number: u16| whole(number).wrapping_shr(axis.into()) & 1 == 1;
        let power = of_axis(150).checked_ilog2().unwrap_or(0).min(8);
        Some(GrblDriver {
            milliamperes: of_axis(140) as u16,
            microsteps: 1_u16.wrapping_shl(power),
            is_silent: has_bit(450),
            stall_threshold: has_bit(339).then_some(of_axis(200) as u8),
        })
    }
}
