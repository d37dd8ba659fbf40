//! One value of backlash for the whole travel.

use crate::{BacklashModel, Flank};

/// An axis with the same backlash everywhere.
///
/// On the positive flank the motor is at the position of the load. On the negative flank it is
/// `backlash_steps` ahead of it in the negative direction. Arithmetic wraps at the ends of `i32`
/// and stays exact there.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Backlash {
    backlash_steps: u32,
    flank: Flank,
    /// Load position that was targeted or stepped to last.
    load: i32,
    /// Motor position minus load position on the positive flank. It is 0 unless the first motion
    /// was negative and determined the flank.
    origin: i32,
}

impl Backlash {
    /// Creates an axis with its backlash in motor steps and its engaged flank. Load and motor are
    /// at zero on the positive flank.
    ///
    /// With [`Flank::Unknown`] the first motion is not compensated, because it determines the
    /// flank.
    #[must_use]
    pub const fn new(backlash_steps: u32, flank: Flank) -> Backlash {
        Backlash {
            backlash_steps,
            flank,
            load: 0,
            origin: 0,
        }
    }

    /// Returns the motor position for the load at `load`. It includes the take-up if the axis
    /// reverses.
    pub fn motor_target(&mut self, load: i32) -> i32 {
        // The comparison, not the difference, which may not fit.
        let direction = if load > self.load {
            1
        } else if load < self.load {
            -1
        } else {
            0
        };
        self.turn(direction);
        self.load = load;
        load.wrapping_add(self.offset())
    }

    /// Returns the load position with the motor at `motor`, for the engaged flank.
    #[must_use]
    pub const fn load_position(&self, motor: i32) -> i32 {
        motor.wrapping_sub(self.offset())
    }

    /// Returns the engaged flank.
    #[must_use]
    pub const fn flank(&self) -> Flank {
        self.flank
    }

    /// Returns the backlash in motor steps.
    #[must_use]
    pub const fn backlash_steps(&self) -> u32 {
        self.backlash_steps
    }

    /// Returns motor position minus load position on the engaged flank.
    const fn offset(&self) -> i32 {
        match self.flank {
            Flank::Negative => self.origin.wrapping_sub(self.backlash_steps.cast_signed()),
            Flank::Positive | Flank::Unknown => self.origin,
        }
    }

    /// Stores the direction, and returns the steps of take-up.
    fn turn(&mut self, direction: i8) -> u32 {
        let Some(flank) = Flank::towards(direction) else {
            return 0;
        };
        let before = core::mem::replace(&mut self.flank, flank);
        match (before, flank) {
            (Flank::Positive, Flank::Negative) | (Flank::Negative, Flank::Positive) => {
                self.backlash_steps
            }
            (Flank::Unknown, Flank::Negative) => {
                // The motor is where it was, so the backlash lies on the other side of it.
                self.origin = self.backlash_steps.cast_signed();
                0
            }
            _ => 0,
        }
    }
}

impl<const N: usize> BacklashModel<N> for Backlash {
    fn take_up(&mut self, axis: usize, direction: i8, load: &[i32; N]) -> u32 {
        if let Some(load) = load.get(axis) {
            self.load = load.wrapping_add(i32::from(direction.signum()));
        }
        self.turn(direction)
    }

    fn is_free(&self) -> bool {
        self.backlash_steps == 0
    }
}
