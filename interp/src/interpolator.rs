//! Traits of the methods and of the set of methods that a machine uses.

use crate::{ArcError, ArcMove, GridEllipse, Helix, Line, Step};

/// A move in progress: an iterator of events that knows how many remain.
///
/// There is no hidden state between events. A move may be dropped, or cloned and walked to its end,
/// at any event.
pub trait Interpolator: Iterator<Item = Step> + Clone {
    /// Number of events still to come.
    fn remaining(&self) -> u32;

    /// Sum of the sweeps of all events of the whole move.
    fn total_sweep(&self) -> u64;

    /// Largest sweep of one event of the whole move.
    fn largest_sweep(&self) -> u32;
}

/// A set of methods for every kind of move; a machine is generic over it.
pub trait Moves<const N: usize>: Interpolator {
    /// Creates a straight move by `delta` steps.
    fn line(delta: [i32; N]) -> Self;

    /// Creates an arc in the axes `plane` while the others make `along` steps (entries of the axes
    /// of the plane are ignored).
    ///
    /// # Errors
    /// [`ArcError`]; for [`ArcError::Degenerate`] use a line instead.
    fn arc(arc: &ArcMove, plane: [usize; 2], along: [i32; N]) -> Result<Self, ArcError>;

    /// Whether [`ellipse`](Self::ellipse) makes arcs. Otherwise a machine refuses arcs in planes
    /// whose axes have steps of different length.
    const HAS_ELLIPSES: bool = false;

    /// Creates an arc in a plane whose axes have steps of different length.
    ///
    /// # Errors
    /// [`ArcError`]; for [`ArcError::Degenerate`] use a line instead. [`ArcError::Unequal`] if this
    /// set has no method for it, as by default.
    fn ellipse(
        _ellipse: &GridEllipse,
        _plane: [usize; 2],
        _along: [i32; N],
    ) -> Result<Self, ArcError> {
        Err(ArcError::Unequal)
    }

    /// What making an arc with [`arc`](Self::arc) has found out by walking it, for
    /// [`arc_again`](Self::arc_again). `None` if that would walk it again, as by default.
    fn totals_of_arc(&self) -> Option<Totals> {
        None
    }

    /// Creates an arc that was created before, without walking it. The events are those of
    /// [`arc`](Self::arc).
    ///
    /// `totals` are the [`totals_of_arc`](Self::totals_of_arc) of an arc with the same parameters.
    ///
    /// # Errors
    /// As [`arc`](Self::arc).
    fn arc_again(
        arc: &ArcMove,
        plane: [usize; 2],
        along: [i32; N],
        _totals: Totals,
    ) -> Result<Self, ArcError> {
        Self::arc(arc, plane, along)
    }

    /// Radius of an arc in the unit of its sweep: `total_sweep / radius` is its length in BLU of
    /// the first axis of its plane. `None` for a line.
    fn radius(&self) -> Option<u64>;

    /// The move as an arc with motion of the other axes, if it is one, for loops over many of its
    /// events. A set with another method for arcs returns `None`.
    fn as_arc(&mut self) -> Option<&mut Helix<N>> {
        None
    }

    /// The move as a [`Line`], if it is one, for loops over many of its events. A set with another
    /// method for lines returns `None`.
    fn as_line(&mut self) -> Option<&mut Line<N>> {
        None
    }
}

/// Sums over a whole move.
#[derive(Copy, Clone, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Totals {
    /// Number of events.
    pub events: u32,
    /// Sum of the sweeps of all events.
    pub total_sweep: u64,
    /// Largest sweep of an event.
    pub largest_sweep: u32,
}

impl Totals {
    /// Walks `steps` to their end; `None` when there are more than 2^31.
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

    /// Totals of `events` events with a sweep of 1 each, as all lines have.
    #[inline]
    pub(crate) fn of_ones(events: u32) -> Totals {
        Totals {
            events,
            total_sweep: events.into(),
            largest_sweep: events.min(1),
        }
    }

    /// Adds an event; there are at most 2^32.
    #[inline]
    pub(crate) fn add(&mut self, sweep: u32) {
        self.events = self.events.wrapping_add(1);
        // Below 2^32 times 2^32.
        self.total_sweep = self.total_sweep.wrapping_add(sweep.into());
        self.largest_sweep = self.largest_sweep.max(sweep);
    }
}
