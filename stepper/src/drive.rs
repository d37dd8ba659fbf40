//! Either kind of output stage, chosen at run time by a machine file.

use crate::{CoilDriver, Levels, Sequencer, StepToggle};

/// A motor's output stage when it is known at run time only.
#[derive(Copy, Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Drive {
    /// Coil levels.
    Coils(Sequencer),
    /// Step and direction, one edge a step.
    StepDirection(StepToggle),
}

impl CoilDriver for Drive {
    #[inline]
    fn step(&mut self, delta: i8) -> Levels {
        match self {
            Drive::Coils(motor) => motor.step(delta),
            Drive::StepDirection(motor) => motor.step(delta),
        }
    }

    #[inline]
    fn levels(&self) -> Levels {
        match self {
            Drive::Coils(motor) => motor.levels(),
            Drive::StepDirection(motor) => motor.levels(),
        }
    }

    fn set_enabled(&mut self, on: bool) -> Levels {
        match self {
            Drive::Coils(motor) => motor.set_enabled(on),
            Drive::StepDirection(motor) => motor.set_enabled(on),
        }
    }

    fn set_reduced(&mut self, on: bool) -> Levels {
        match self {
            Drive::Coils(motor) => motor.set_reduced(on),
            Drive::StepDirection(motor) => motor.set_reduced(on),
        }
    }
}
