//! A walk with a known number of events.

use crate::Step;
use crate::interpolator::Totals;
use crate::method::Method;

/// A walk that ends, and the number of events that remain.
#[derive(Clone, Debug)]
// In this field order a Cortex-M0 reaches the count and a walk of 32-bit words by short offsets.
#[repr(C)]
pub(crate) struct Counted<W> {
    left: u32,
    pub(crate) walk: W,
    totals: Totals,
}

impl<W> Counted<W> {
    /// Wraps a walk whose totals are known.
    pub(crate) const fn with_totals(walk: W, totals: Totals) -> Self {
        Counted {
            walk,
            left: totals.events,
            totals,
        }
    }

    /// Counts events that the walk made by itself.
    pub(crate) const fn pass(&mut self, events: u32) {
        self.left = self.left.wrapping_sub(events);
    }

    /// Number of events of the whole walk.
    pub(crate) const fn events(&self) -> u32 {
        self.totals.events
    }
}

impl<W: Iterator<Item = Step> + Clone> Counted<W> {
    /// Counts the events in a dry run; `None` when there are more than 2^31.
    pub(crate) fn new(walk: W) -> Option<Self> {
        let totals = Totals::of(walk.clone())?;
        Some(Counted::with_totals(walk, totals))
    }
}

impl<W: Iterator<Item = Step>> Method for Counted<W> {
    #[inline(always)]
    fn next_step(&mut self) -> Option<Step> {
        let step = self.walk.next()?;
        self.left = self.left.wrapping_sub(1);
        Some(step)
    }

    #[inline]
    fn left(&self) -> u32 {
        self.left
    }

    #[inline]
    fn totals(&self) -> Totals {
        self.totals
    }
}
