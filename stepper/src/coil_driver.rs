//! The interface of a machine to the driver of a motor.

use crate::{Levels, PulseTiming};

/// Turns steps into the levels of the driver of one motor.
///
/// [`Sequencer`](crate::Sequencer), [`StepDirection`](crate::StepDirection) and
/// [`StepToggle`](crate::StepToggle) implement it. A machine is generic over it.
///
/// A driver of coils makes a step by one change of levels. If [`timing`](CoilDriver::timing)
/// returns times, a step is a pulse of three changes: [`turn`](CoilDriver::turn) sets DIR, `step`
/// raises STEP, and [`end_pulse`](CoilDriver::end_pulse) lowers STEP.
///
/// # Examples
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
    /// Whether [`timing`](CoilDriver::timing) may return times, so that steps are pulses. If not
    /// (the default), a machine omits the code for pulses.
    const HAS_PULSES: bool = false;

    /// Returns the levels after `delta` steps: -1, 0 or +1. A disabled driver makes no step.
    fn step(&mut self, delta: i8) -> Levels;

    /// Returns the levels during the set-up time before a step by `delta`.
    ///
    /// The default changes nothing, for drivers whose steps are not pulses.
    fn turn(&mut self, delta: i8) -> Levels {
        let _ = delta;
        self.levels()
    }

    /// Returns the levels after the pulse of a step.
    ///
    /// The default changes nothing, for drivers whose steps are not pulses.
    fn end_pulse(&mut self) -> Levels {
        self.levels()
    }

    /// Returns the times of a pulse. `None` (the default): a step is one change of levels.
    fn timing(&self) -> Option<PulseTiming> {
        None
    }

    /// Returns the present levels.
    fn levels(&self) -> Levels;

    /// Switches all currents off, or on again in the phase held last. Returns the levels.
    fn set_enabled(&mut self, on: bool) -> Levels;

    /// Holds with reduced current, or with full current again. Returns the levels. Switch to full
    /// current before a step.
    ///
    /// The default does nothing, for drivers whose inputs have no level for it.
    fn set_reduced(&mut self, on: bool) -> Levels {
        let _ = on;
        self.levels()
    }
}
