//! A motor bridge on a PWM channel and a direction pin.

use core::fmt;

use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;

use crate::sign_magnitude::sign_magnitude;

/// A bridge with a PWM and a direction input.
///
/// Before the direction changes the duty goes to 0, so that no pulse of the old duty drives the
/// other way.
#[derive(Debug)]
pub struct PwmDirection<P, D> {
    pwm: P,
    direction: D,
    full_drive: u16,
    is_reverse: Option<bool>,
}

/// The peripheral that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DriveError<P, D> {
    /// The PWM channel.
    Pwm(P),
    /// The direction pin.
    Direction(D),
}

impl<P: fmt::Debug, D: fmt::Debug> fmt::Display for DriveError<P, D> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pwm(error) => write!(formatter, "PWM: {error:?}"),
            Self::Direction(error) => write!(formatter, "direction pin: {error:?}"),
        }
    }
}

impl<P: fmt::Debug, D: fmt::Debug> core::error::Error for DriveError<P, D> {}

impl<P: SetDutyCycle, D: OutputPin> PwmDirection<P, D> {
    /// A bridge whose full duty is a drive of `full_drive`, 255 for a module. Nothing is written
    /// yet.
    pub const fn new(pwm: P, direction: D, full_drive: u16) -> Self {
        Self {
            pwm,
            direction,
            full_drive,
            is_reverse: None,
        }
    }

    /// Drives: sign to the direction pin (high is negative), magnitude to the PWM.
    ///
    /// # Errors
    /// What pin or channel report. The duty was then not set, or was set to 0.
    pub fn set(&mut self, drive: i32) -> Result<(), DriveError<P::Error, D::Error>> {
        let (is_reverse, duty) = sign_magnitude(drive, self.full_drive, self.pwm.max_duty_cycle());
        // At 0 the direction stays.
        if duty != 0 && self.is_reverse != Some(is_reverse) {
            self.pwm.set_duty_cycle(0).map_err(DriveError::Pwm)?;
            // Unknown until the pin has taken it.
            self.is_reverse = None;
            self.direction
                .set_state(is_reverse.into())
                .map_err(DriveError::Direction)?;
            self.is_reverse = Some(is_reverse);
        }
        self.pwm.set_duty_cycle(duty).map_err(DriveError::Pwm)
    }

    /// Gives channel and pin back.
    pub fn release(self) -> (P, D) {
        (self.pwm, self.direction)
    }
}
