//! The data of Set Gain.

use crate::buffer::{Buffer, Fields};

use super::frame::LONGEST_DATA;

/// Data of Set Gain: the servo law `kp e + kd (e - e_before) + ki sum(e) / 256` and its limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Gains {
    /// Proportional gain, 0 to 0x7FFF.
    pub proportional: u16,
    /// Derivative gain, 0 to 0x7FFF.
    pub derivative: u16,
    /// Integral gain, 0 to 0x7FFF.
    pub integral: u16,
    /// Limit of the sum of errors, 0 to 0x7FFF.
    pub integration_limit: u16,
    /// Limit of the PWM, 0 to 255.
    pub output_limit: u8,
    /// Current limit. With an odd value the sense signal is proportional to the current. With an
    /// even value it is inversely proportional. 0: no limit.
    pub current_limit: u8,
    /// Position error in counts above which the servo is switched off, 0 to 0x3FFF (0x7FFF in
    /// version 10).
    pub error_limit: u16,
    /// Servo-rate divisor, 1 to 255.
    pub rate_divisor: u8,
    /// Dead-band compensation of the PWM, 0 to 255.
    pub dead_band: u8,
    /// Step multiplier, version 10 only.
    pub step_multiplier: Option<u8>,
}

impl Gains {
    pub(super) fn write(&self, to: &mut Buffer<LONGEST_DATA>) {
        for gain in [
            self.proportional,
            self.derivative,
            self.integral,
            self.integration_limit,
        ] {
            to.extend(&gain.to_le_bytes());
        }
        to.extend(&[self.output_limit, self.current_limit]);
        to.extend(&self.error_limit.to_le_bytes());
        to.extend(&[self.rate_divisor, self.dead_band]);
        if let Some(multiplier) = self.step_multiplier {
            to.push(multiplier);
        }
    }

    pub(super) fn read(data: &[u8], version: u8) -> Option<Gains> {
        let mut fields = Fields(data);
        let gains = Gains {
            proportional: fields.u16()?,
            derivative: fields.u16()?,
            integral: fields.u16()?,
            integration_limit: fields.u16()?,
            output_limit: fields.u8()?,
            current_limit: fields.u8()?,
            error_limit: fields.u16()?,
            rate_divisor: fields.u8()?,
            dead_band: fields.u8()?,
            step_multiplier: if version >= 10 { fields.u8() } else { None },
        };
        fields.0.is_empty().then_some(gains)
    }

    pub(super) fn is_in_range(&self, version: u8) -> bool {
        let longest_error = if version >= 10 { 0x7FFF } else { 0x3FFF };
        self.proportional <= 0x7FFF
            && self.derivative <= 0x7FFF
            && self.integral <= 0x7FFF
            && self.integration_limit <= 0x7FFF
            && self.error_limit <= longest_error
            && self.rate_divisor > 0
            && (version >= 10 || self.step_multiplier.is_none())
    }
}
