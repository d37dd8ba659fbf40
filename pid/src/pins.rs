//! A motor bridge on a PWM channel and a direction pin.

use core::fmt;

use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;

use crate::sign_magnitude::sign_magnitude;

/// A motor bridge with a PWM input and a direction input.
///
/// The duty is set to 0 before the direction changes. No pulse of the old duty then drives the
/// motor in the new direction.
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
    /// Creates a bridge with full duty at a drive of `full_drive`, which is 255 for a module.
    /// Writes nothing yet.
    pub const fn new(pwm: P, direction: D, full_drive: u16) -> Self {
        Self {
            pwm,
            direction,
            full_drive,
            is_reverse: None,
        }
    }

    /// Sets the drive: its sign on the direction pin (high is negative), its magnitude on the PWM.
    ///
    /// # Errors
    /// Fails if the pin or the channel reports an error. The duty is then unchanged or 0.
    pub fn set(&mut self, drive: i32) -> Result<(), DriveError<P::Error, D::Error>> {
        let (is_reverse, duty) = sign_magnitude(drive, self.full_drive, self.pwm.max_duty_cycle());
        // At duty 0 the direction does not change.
        if duty != 0 && self.is_reverse != Some(is_reverse) {
            self.pwm.set_duty_cycle(0).map_err(DriveError::Pwm)?;
            // The direction is unknown until the pin call succeeds.
            self.is_reverse = None;
            self.direction
                .set_state(is_reverse.into())
                .map_err(DriveError::Direction)?;
            self.is_reverse = Some(is_reverse);
        }
        self.pwm.set_duty_cycle(duty).map_err(DriveError::Pwm)
    }

    /// Returns the channel and the pin.
    pub fn release(self) -> (P, D) {
        (self.pwm, self.direction)
    }
}
