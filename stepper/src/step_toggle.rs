//! Step and direction for drivers that count both edges: one edge per step.

use crate::{CoilDriver, Levels};

/// A step and direction driver that takes a step on both edges of STEP ("double edge": TMC2209 with
/// `dedge` set). A step is therefore one change of levels.
///
/// DIR is high for positive steps. **Most chips count rising edges only. They would lose every
/// second step**, and need [`StepDirection`](crate::StepDirection).
///
/// # Examples
/// ```
/// use husillo_stepper::{CoilDriver, Levels, StepToggle};
/// let mut drive = StepToggle::new();
/// assert_eq!(drive.levels(), Levels(0b110)); // enabled, DIR high
/// assert_eq!(drive.step(1), Levels(0b111));
/// assert_eq!(drive.step(-1), Levels(0b100));
/// assert_eq!(drive.step(0), Levels(0b100));
/// ```
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StepToggle {
    levels: Levels,
}

impl StepToggle {
    /// Creates an enabled driver with STEP low and DIR high.
    #[must_use]
    pub const fn new() -> StepToggle {
        StepToggle {
            levels: Levels(Levels::DIR.0 | Levels::ENABLE.0),
        }
    }
}

impl Default for StepToggle {
    fn default() -> StepToggle {
        StepToggle::new()
    }
}

impl CoilDriver for StepToggle {
    #[inline]
    fn step(&mut self, delta: i8) -> Levels {
        if delta != 0 && self.levels.contains(Levels::ENABLE) {
            let direction = if delta > 0 { Levels::DIR.0 } else { 0 };
            // One edge cannot show two steps. Events have -1, 0 or +1.
            let step = (self.levels.0 ^ Levels::STEP.0) & Levels::STEP.0;
            self.levels = Levels(step | direction | Levels::ENABLE.0);
        }
        self.levels
    }

    #[inline]
    fn levels(&self) -> Levels {
        self.levels
    }

    fn set_enabled(&mut self, on: bool) -> Levels {
        let enable = if on { Levels::ENABLE.0 } else { 0 };
        self.levels = Levels(self.levels.0 & !Levels::ENABLE.0 | enable);
        self.levels
    }
}
