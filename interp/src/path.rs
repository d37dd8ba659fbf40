//! Line or arc as one type.

use crate::interpolator::Totals;
use crate::method::{Method, interpolator};
use crate::{ArcError, ArcMove, Helix, Line, Moves, Step};

/// The default set of methods: the nearest-point line and arc of this crate.
#[derive(Clone, Debug)]
// One of these lives in place in a machine; a box would need an allocator.
#[allow(clippy::large_enum_variant)]
pub enum Path<const N: usize> {
    /// A straight move.
    Line(Line<N>),
    /// An arc, flat or helical.
    Arc(Helix<N>),
}

impl<const N: usize> Moves<N> for Path<N> {
    fn line(delta: [i32; N]) -> Self {
        Path::Line(Line::new(delta))
    }

    fn arc(arc: &ArcMove, plane: [usize; 2], along: [i32; N]) -> Result<Self, ArcError> {
        Ok(Path::Arc(Helix::new(arc, plane, along)?))
    }

    fn radius(&self) -> Option<u64> {
        match self {
            Path::Line(_) => None,
            Path::Arc(helix) => Some(helix.radius()),
        }
    }
}

impl<const N: usize> Method for Path<N> {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        match self {
            Path::Line(line) => line.walk.next_step(),
            Path::Arc(helix) => helix.next(),
        }
    }

    #[inline]
    fn left(&self) -> u32 {
        match self {
            Path::Line(line) => line.walk.left(),
            Path::Arc(helix) => helix.left(),
        }
    }

    #[inline]
    fn totals(&self) -> Totals {
        match self {
            Path::Line(line) => line.walk.totals(),
            Path::Arc(helix) => helix.totals(),
        }
    }
}

interpolator!(Path<N>);
