//! A walk with its events counted.

use crate::interpolator::{Totals, exactly};
use crate::{ArcError, Step};

/// A walk and what remains of it.
#[derive(Clone, Debug)]
pub(crate) struct Counted<W> {
    walk: W,
    left: u32,
    pub(crate) totals: Totals,
}

impl<W: Iterator<Item = Step> + Clone> Counted<W> {
    /// Walks it dry once.
    pub(crate) fn new(walk: W) -> Result<Self, ArcError> {
        let totals = Totals::of(walk.clone()).ok_or(ArcError::TooLong)?;
        Ok(Counted {
            walk,
            left: totals.events,
            totals,
        })
    }

    #[inline]
    pub(crate) fn next(&mut self) -> Option<Step> {
        self.left = self.left.checked_sub(1)?;
        self.walk.next()
    }

    #[inline]
    pub(crate) const fn left(&self) -> u32 {
        self.left
    }

    #[inline]
    pub(crate) fn size_hint(&self) -> (usize, Option<usize>) {
        exactly(self.left)
    }
}
