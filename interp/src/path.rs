//! Line or arc behind one name.

use crate::{ArcError, ArcMove, Helix, Interpolator, Line, Moves, Step};

/// The default set of methods: the nearest-point line and arc of this crate.
#[derive(Clone, Debug)]
// One of these lives in a machine, in place; a box would need an allocator.
#[allow(clippy::large_enum_variant)]
pub enum Path<const N: usize> {
    /// A straight move.
    Line(Line<N>),
    /// An arc, flat or helical.
    Arc(Helix<N>),
}

impl<const N: usize> Interpolator for Path<N> {
    #[inline]
    fn remaining(&self) -> u32 {
        match self {
            Path::Line(line) => line.remaining(),
            Path::Arc(helix) => helix.remaining(),
        }
    }

    fn total_sweep(&self) -> u64 {
        match self {
            Path::Line(line) => line.total_sweep(),
            Path::Arc(helix) => helix.total_sweep(),
        }
    }

    fn largest_sweep(&self) -> u32 {
        match self {
            Path::Line(line) => line.largest_sweep(),
            Path::Arc(helix) => helix.largest_sweep(),
        }
    }
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

impl<const N: usize> Iterator for Path<N> {
    type Item = Step;

    #[inline]
    fn next(&mut self) -> Option<Step> {
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
