//! The interface of a machine to the driver of a motor.

use crate::{Levels, PulseTiming};

/// Turns steps into the levels of the driver of one motor.
///
/// [`Sequencer`](crate::Sequencer), [`StepDirection`](crate::StepDirection) and
/// [`StepToggle`](crate::StepToggle) are those of this crate; a machine is generic over it.
///
/// With coils a step is one change of levels. Where [`timing`](CoilDriver::timing) gives times, a
/// step is a pulse, three changes in this order: [`turn`](CoilDriver::turn) sets DIR, `step` lets
/// STEP rise, and [`end_pulse`](CoilDriver::end_pulse) lets it fall.
///
/// ```
/// use husillo_stepper::{CoilDriver, Levels};
///
/// /// A five-phase ring counter, driven one phase at a time.
/// struct Ring { phase: u8, enabled: bool }
///
/// impl CoilDriver for Ring {
///     fn step(&mut self, delta: i8) -> Levels {
///         self.phase = (self.phase as i8 + delta).rem_euclid(5) as u8;
///         self.levels()
///     }
///     fn levels(&self) -> Levels { Levels(if self.enabled { 1 << self.phase } else { 0 }) }
///     fn set_enabled(&mut self, on: bool) -> Levels { self.enabled = on; self.levels() }
/// }
///
/// let mut ring = Ring { phase: 0, enabled: true };
/// assert_eq!(ring.step(-1), Levels(0b10000));
/// ```
pub trait CoilDriver {
    /// Whether a step may be a pulse: whether [`timing`](CoilDriver::timing) ever returns times. If
    /// not (the default), a machine omits the code for pulses.
    const HAS_PULSES: bool = false;

    /// The levels after `delta` steps: -1, 0 or +1. A disabled driver stays where it is.
    fn step(&mut self, delta: i8) -> Levels;

    /// The levels before a step by `delta`, during the set-up time of
    /// [`timing`](CoilDriver::timing).
    ///
    /// Nothing changes where a step is no pulse, as here by default.
    fn turn(&mut self, delta: i8) -> Levels {
        let _ = delta;
        self.levels()
    }

    /// The levels after the pulse of a step.
    ///
    /// Nothing changes where a step is no pulse, as here by default.
    fn end_pulse(&mut self) -> Levels {
        self.levels()
    }

    /// The times of the pulse of a step. `None` (the default): a step is one change of levels.
    fn timing(&self) -> Option<PulseTiming> {
        None
    }

    /// The levels now.
    fn levels(&self) -> Levels;

    /// Turns all currents off, or on again in the last held phase. Returns the levels.
    fn set_enabled(&mut self, on: bool) -> Levels;

    /// Holds with less current, or with full current again. Returns the levels. A step needs full
    /// current.
    ///
    /// It does nothing if the inputs of the driver have no level for it. This is the default.
    fn set_reduced(&mut self, on: bool) -> Levels {
        let _ = on;
        self.levels()
    }
}
