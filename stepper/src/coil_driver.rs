//! What a machine needs of a motor's output stage.

use crate::Levels;

/// Turns steps into the levels of one motor's driver.
///
/// [`Sequencer`](crate::Sequencer) and [`StepToggle`](crate::StepToggle) are the two of this crate; a machine is generic
/// over it.
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
    /// The levels after `delta` steps: -1, 0 or +1. A disabled driver stays where it is.
    fn step(&mut self, delta: i8) -> Levels;

    /// The levels now.
    fn levels(&self) -> Levels;

    /// Turns all currents off, or on again in the phase that was held last; the levels after it.
    fn set_enabled(&mut self, on: bool) -> Levels;

    /// Holds with less current, or with all of it again; the levels after it. A step needs all of it.
    ///
    /// Does nothing where the inputs of the driver have no level for it, as here by default.
    fn set_reduced(&mut self, on: bool) -> Levels {
        let _ = on;
        self.levels()
    }
}
