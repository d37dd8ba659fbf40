//! What one axis is made of.

use husillo_stepper::{Driver, Mode, PulseTiming};

/// Motor, drive and screw of one simulated axis.
///
/// The mode only says what one step of the drive is, for the counts; the rotor is moved by currents.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct AxisModel {
    pub(crate) stage: Stage,
    pub(crate) steps_per_full: u8,
    pub(crate) lash_steps: u32,
    pub(crate) pull_out_ticks: u32,
    pub(crate) reversed: bool,
}

/// What turns levels into rotor angle.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Stage {
    Coils(Driver),
    /// Rising edges of STEP count, where the times are kept.
    StepDirection(PulseTiming),
    /// Both edges of STEP count.
    StepToggle,
}

impl AxisModel {
    /// A two-phase motor on `driver`, counted in steps of `mode`; no lash, no speed limit.
    #[must_use]
    pub const fn coils(driver: Driver, mode: Mode) -> AxisModel {
        AxisModel::new(Stage::Coils(driver), mode.steps_per_full())
    }

    /// A step and direction driver like the A4988: it counts rising edges of STEP alone. A step is
    /// lost where STEP is high or low too shortly, DIR not stable around the edge, or ENABLE off.
    /// What [`StepDirection`](husillo_stepper::StepDirection) drives.
    #[must_use]
    pub const fn step_direction(timing: PulseTiming) -> AxisModel {
        AxisModel::new(Stage::StepDirection(timing), 1)
    }

    /// A step and direction driver that counts both edges of STEP: what
    /// [`StepToggle`](husillo_stepper::StepToggle) drives.
    #[must_use]
    pub const fn step_toggle() -> AxisModel {
        AxisModel::new(Stage::StepToggle, 1)
    }

    const fn new(stage: Stage, steps_per_full: u8) -> AxisModel {
        AxisModel {
            stage,
            steps_per_full,
            lash_steps: 0,
            pull_out_ticks: 0,
            reversed: false,
        }
    }

    /// Play of the screw in steps of the drive.
    #[must_use]
    pub const fn with_lash(self, lash_steps: u32) -> AxisModel {
        AxisModel { lash_steps, ..self }
    }

    /// The shortest interval between two steps (changes of levels, or counted edges of STEP) that
    /// the rotor still follows, in timer ticks.
    #[must_use]
    pub const fn with_pull_out_ticks(self, pull_out_ticks: u32) -> AxisModel {
        AxisModel {
            pull_out_ticks,
            ..self
        }
    }

    /// Screw or motor mounted the other way round: the tool moves negative where the field turns positive.
    #[must_use]
    pub const fn reversed(self) -> AxisModel {
        AxisModel {
            reversed: !self.reversed,
            ..self
        }
    }
}
