//! Line or arc behind one name, and the seam for other interpolators.

use crate::{Arc, ArcError, ArcMove, Helix, Line, Step};

/// Anything that turns a move into events; what a machine is generic over.
pub trait Interpolator<const N: usize>: Iterator<Item = Step<N>> + Sized {
    /// A straight move by `delta` steps.
    fn line(delta: [i32; N]) -> Self;

    /// An arc in the axes `plane`, while the others make `along` steps (entries of the plane's axes
    /// are ignored).
    ///
    /// # Errors
    /// [`ArcError`]; for [`ArcError::Degenerate`] make a line instead.
    fn arc(arc: &ArcMove, plane: [usize; 2], along: [i32; N]) -> Result<Self, ArcError>;

    /// Events still to come.
    fn remaining(&self) -> u32;

    /// Sum of the sweeps of all events of the whole move.
    fn total_sweep(&self) -> u64;

    /// Largest sweep of one event of the whole move.
    fn largest_sweep(&self) -> u64;

    /// Of an arc the radius in the unit of its sweep (`total_sweep / radius` is its length in BLU);
    /// `None` for a line.
    fn radius(&self) -> Option<u64>;
}

/// The default interpolator: the nearest-point line and arc of this crate.
#[derive(Clone, Debug)]
// One of these lives in a machine, in place; a box would need an allocator.
#[allow(clippy::large_enum_variant)]
pub enum Path<const N: usize> {
    /// A straight move.
    Line(Line<N>),
    /// An arc, flat or helical.
    Arc(Helix<N>),
}

impl<const N: usize> Interpolator<N> for Path<N> {
    fn line(delta: [i32; N]) -> Self {
        Path::Line(Line::new(delta))
    }

    fn arc(arc: &ArcMove, plane: [usize; 2], along: [i32; N]) -> Result<Self, ArcError> {
        Ok(Path::Arc(Helix::new(Arc::new(arc)?, plane, along)?))
    }

    #[inline]
    fn remaining(&self) -> u32 {
        match self {
            Path::Line(line) => line.remaining(),
            Path::Arc(helix) => helix.remaining(),
        }
    }

    fn total_sweep(&self) -> u64 {
        match self {
            Path::Line(line) => line.events().into(),
            Path::Arc(helix) => helix.total_sweep(),
        }
    }

    fn largest_sweep(&self) -> u64 {
        match self {
            Path::Line(line) => line.events().min(1).into(),
            Path::Arc(helix) => helix.largest_sweep(),
        }
    }

    fn radius(&self) -> Option<u64> {
        match self {
            Path::Line(_) => None,
            Path::Arc(helix) => Some(helix.radius()),
        }
    }
}

impl<const N: usize> Iterator for Path<N> {
    type Item = Step<N>;

    #[inline]
    fn next(&mut self) -> Option<Step<N>> {
        match self {
            Path::Line(line) => line.next(),
            Path::Arc(helix) => helix.next(),
        }
    }

    #[inline]
    fn size_hint(&self) -> (usize, Option<usize>) {
        match self {
            Path::Line(line) => line.size_hint(),
            Path::Arc(helix) => helix.size_hint(),
        }
    }
}

impl<const N: usize> core::iter::FusedIterator for Path<N> {}
