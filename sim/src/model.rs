//! Model of one axis.

use husillo_stepper::{Driver, Mode, PulseTiming};

/// Motor, drive and screw of one simulated axis.
///
/// The mode only defines the length of a drive step, in which positions are counted. The currents
/// turn the rotor.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct AxisModel {
    pub(crate) stage: Stage,
    pub(crate) steps_per_full: u8,
    pub(crate) backlash_steps: u32,
    pub(crate) pull_out_ticks: u32,
    pub(crate) reversed: bool,
    pub(crate) ends_steps: [Option<u32>; 2],
}

/// Conversion of levels to a rotor angle.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Stage {
    Coils(Driver),
    /// Rising edges of STEP count if the pulse has the required times.
    StepDirection(PulseTiming),
    /// Both edges of STEP count.
    StepToggle,
}

impl AxisModel {
    /// A two-phase motor on `driver`, counted in steps of `mode`; without backlash and without a
    /// speed limit.
    #[must_use]
    pub const fn coils(driver: Driver, mode: Mode) -> AxisModel {
        AxisModel::new(Stage::Coils(driver), mode.steps_per_full())
    }

    /// A step and direction driver like the A4988, which counts rising edges of STEP only. A step
    /// is lost if STEP is high or low for too short a time, if DIR is not stable around the edge,
    /// or if ENABLE is off. Matches [`StepDirection`](husillo_stepper::StepDirection).
    #[must_use]
    pub const fn step_direction(timing: PulseTiming) -> AxisModel {
        AxisModel::new(Stage::StepDirection(timing), 1)
    }

    /// A step and direction driver that counts both edges of STEP. Matches
    /// [`StepToggle`](husillo_stepper::StepToggle).
    #[must_use]
    pub const fn step_toggle() -> AxisModel {
        AxisModel::new(Stage::StepToggle, 1)
    }

    const fn new(stage: Stage, steps_per_full: u8) -> AxisModel {
        AxisModel {
            stage,
            steps_per_full,
            backlash_steps: 0,
            pull_out_ticks: 0,
            reversed: false,
            ends_steps: [None; 2],
        }
    }

    /// Sets the backlash of the screw in drive steps.
    #[must_use]
    pub const fn with_backlash(self, backlash_steps: u32) -> AxisModel {
        AxisModel {
            backlash_steps,
            ..self
        }
    }

    /// Sets the shortest interval between two steps (changes of levels, or counted edges of STEP)
    /// that the rotor can follow, in timer ticks.
    #[must_use]
    pub const fn with_pull_out_ticks(self, pull_out_ticks: u32) -> AxisModel {
        AxisModel {
            pull_out_ticks,
            ..self
        }
    }

    /// Sets a mechanical end: the rotor turns at most this number of drive steps backward from its
    /// first position. A motor that is driven against it loses steps.
    #[must_use]
    pub const fn with_end_below(self, steps: u32) -> AxisModel {
        let [_, above] = self.ends_steps;
        AxisModel {
            ends_steps: [Some(steps), above],
            ..self
        }
    }

    /// Sets a mechanical end as [`with_end_below`](Self::with_end_below) does, in forward
    /// direction.
    #[must_use]
    pub const fn with_end_above(self, steps: u32) -> AxisModel {
        let [below, _] = self.ends_steps;
        AxisModel {
            ends_steps: [below, Some(steps)],
            ..self
        }
    }

    /// Reverses the screw or the motor: when the field turns in the positive direction, the tool
    /// moves in the negative one.
    #[must_use]
    pub const fn reversed(self) -> AxisModel {
        AxisModel {
            reversed: !self.reversed,
            ..self
        }
    }
}
