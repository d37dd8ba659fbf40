//! The seams: what every method is, and what a machine makes its moves of.

use crate::{ArcError, ArcMove, Step};

/// A move on its way: an iterator of events that knows what remains.
///
/// Nothing is owed between events: it may be dropped, or cloned and walked dry, at any of them.
pub trait Interpolator: Iterator<Item = Step> + Clone {
    /// Events still to come.
    fn remaining(&self) -> u32;

    /// Sum of the sweeps of all events of the whole move.
    fn total_sweep(&self) -> u64;

    /// Largest sweep of one event of the whole move.
    fn largest_sweep(&self) -> u32;
}

/// A set of methods that makes every kind of move; what a machine is generic over.
pub trait Moves<const N: usize>: Interpolator {
    /// A straight move by `delta` steps.
    fn line(delta: [i32; N]) -> Self;

    /// An arc in the axes `plane`, while the others make `along` steps (entries of the plane's axes
    /// are ignored).
    ///
    /// # Errors
    /// [`ArcError`]; for [`ArcError::Degenerate`] make a line instead.
    fn arc(arc: &ArcMove, plane: [usize; 2], along: [i32; N]) -> Result<Self, ArcError>;

    /// Of an arc the radius in the unit of its sweep (`total_sweep / radius` is its length in BLU);
    /// `None` for a line.
    fn radius(&self) -> Option<u64>;
}

/// What a walk through a whole move adds up to.
#[derive(Copy, Clone, PartialEq, Eq, Debug, Default)]
pub(crate) struct Totals {
    pub(crate) events: u32,
    pub(crate) total_sweep: u64,
    pub(crate) largest_sweep: u32,
}

impl Totals {
    /// Walks `steps` to their end; `None` when they are more than 2^31.
    pub(crate) fn of(steps: impl Iterator<Item = Step>) -> Option<Totals> {
        let mut totals = Totals::default();
        for step in steps {
            if totals.events >= 1 << 31 {
                return None;
            }
            totals.add(step.sweep);
        }
        Some(totals)
    }

    /// Those of `events` events that sweep 1 each, as the events of all lines do.
    #[inline]
    pub(crate) fn of_ones(events: u32) -> Totals {
        Totals {
            events,
            total_sweep: events.into(),
            largest_sweep: events.min(1),
        }
    }

    /// Another event; they are not more than 2^32.
    #[inline]
    pub(crate) fn add(&mut self, sweep: u32) {
        self.events = self.events.wrapping_add(1);
        // Below 2^32 times 2^32.
        self.total_sweep = self.total_sweep.wrapping_add(sweep.into());
        self.largest_sweep = self.largest_sweep.max(sweep);
    }
}
