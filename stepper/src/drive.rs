//! Any driver of a motor, selected at run time by a machine file.

use crate::{CoilDriver, Levels, PulseTiming, Sequencer, StepDirection, StepToggle};

/// The driver of a motor that is known at run time only.
#[derive(Copy, Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Drive {
    /// Coil levels.
    Coils(Sequencer),
    /// Step and direction with one pulse per step: rising edges count.
    StepDirection(StepDirection),
    /// Step and direction for drivers that count both edges of STEP.
    StepToggle(StepToggle),
}

impl CoilDriver for Drive {
    const HAS_PULSES: bool = true;

    #[inline]
    fn step(&mut self, delta: i8) -> Levels {
        match self {
            Drive::Coils(motor) => motor.step(delta),
            Drive::StepDirection(motor) => motor.step(delta),
            Drive::StepToggle(motor) => motor.step(delta),
        }
    }

    #[inline]
    fn turn(&mut self, delta: i8) -> Levels {
        match self {
            Drive::StepDirection(motor) => motor.turn(delta),
            _ => self.levels(),
        }
    }

    #[inline]
    fn end_pulse(&mut self) -> Levels {
        match self {
            Drive::StepDirection(motor) => motor.end_pulse(),
            _ => self.levels(),
        }
    }

    fn timing(&self) -> Option<PulseTiming> {
        match self {
            Drive::StepDirection(motor) => motor.timing(),
            _ => None,
        }
    }

    #[inline]
    fn levels(&self) -> Levels {
        match self {
            Drive::Coils(motor) => motor.levels(),
            Drive::StepDirection(motor) => motor.levels(),
            Drive::StepToggle(motor) => motor.levels(),
        }
    }

    fn set_enabled(&mut self, on: bool) -> Levels {
        match self {
            Drive::Coils(motor) => motor.set_enabled(on),
            Drive::StepDirection(motor) => motor.set_enabled(on),
            Drive::StepToggle(motor) => motor.set_enabled(on),
        }
    }

    fn set_reduced(&mut self, on: bool) -> Levels {
        match self {
            Drive::Coils(motor) => motor.set_reduced(on),
            Drive::StepDirection(motor) => motor.set_reduced(on),
            Drive::StepToggle(motor) => motor.set_reduced(on),
        }
    }
}
