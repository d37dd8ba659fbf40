//! One value of lash for the whole travel.

use crate::{Flank, Lash};

/// An axis with the same lash everywhere.
///
/// On the positive flank the motor stands at the load's position, on the negative flank
/// `lash_steps` before it. Arithmetic wraps at the ends of `i32`, and stays exact there.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Backlash {
    lash_steps: u32,
    flank: Flank,
    /// Load position last targeted or stepped to.
    load: i32,
    /// Motor position less load position on the positive flank; not 0 only where the flank was
    /// found by moving negative.
    origin: i32,
}

impl Backlash {
    /// Lash in motor steps, and the flank engaged now; load and motor zero are here on the positive
    /// flank.
    ///
    /// With [`Flank::Unknown`] the first motion is not compensated: it finds the flank.
    #[must_use]
    pub const fn new(lash_steps: u32, flank: Flank) -> Backlash {
        Backlash {
            lash_steps,
            flank,
            load: 0,
            origin: 0,
        }
    }

    /// The motor position for the load at `load`, take-up included when that turns the axis round.
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

    /// The load position with the motor at `motor`, on the flank engaged now.
    #[must_use]
    pub const fn load_position(&self, motor: i32) -> i32 {
        motor.wrapping_sub(self.offset())
    }

    /// The flank engaged now.
    #[must_use]
    pub const fn flank(&self) -> Flank {
        self.flank
    }

    /// The lash in motor steps.
    #[must_use]
    pub const fn lash_steps(&self) -> u32 {
        self.lash_steps
    }

    /// Motor less load on the flank engaged now.
    const fn offset(&self) -> i32 {
        match self.flank {
            Flank::Negative => self.origin.wrapping_sub(self.lash_steps.cast_signed()),
            Flank::Positive | Flank::Unknown => self.origin,
        }
    }

    /// Remembers the direction; steps owed.
    fn turn(&mut self, direction: i8) -> u32 {
        let Some(flank) = Flank::towards(direction) else {
            return 0;
        };
        let before = core::mem::replace(&mut self.flank, flank);
        match (before, flank) {
            (Flank::Positive, Flank::Negative) | (Flank::Negative, Flank::Positive) => {
                self.lash_steps
            }
            (Flank::Unknown, Flank::Negative) => {
                // The motor is where it was, so the play lies on the other side of it.
                self.origin = self.lash_steps.cast_signed();
                0
            }
            _ => 0,
        }
    }
}

impl<const N: usize> Lash<N> for Backlash {
    fn take_up(&mut self, axis: usize, direction: i8, load: &[i32; N]) -> u32 {
        if let Some(load) = load.get(axis) {
            self.load = load.wrapping_add(i32::from(direction.signum()));
        }
        self.turn(direction)
    }

    fn is_free(&self) -> bool {
        self.lash_steps == 0
    }
}
