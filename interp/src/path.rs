//! Line or arc as one type.

use crate::interpolator::Totals;
use crate::method::{Method, interpolator};
use crate::{ArcError, ArcMove, Conic, GridEllipse, Helix, Line, Moves, Step};

/// The default set of methods: the nearest-point line and arc of this crate.
#[derive(Clone, Debug)]
// One of these lives in place in a machine; a box would need an allocator.
#[allow(clippy::large_enum_variant)]
pub enum Path<const N: usize> {
    /// A straight move.
    Line(Line<N>),
    /// An arc, flat or helical.
    Arc(Helix<N>),
    /// An arc, flat or helical, in a plane whose axes have steps of different length.
    Ellipse(Helix<N, Conic>),
}

impl<const N: usize> Moves<N> for Path<N> {
    fn line(delta: [i32; N]) -> Self {
        Path::Line(Line::new(delta))
    }

    fn arc(arc: &ArcMove, plane: [usize; 2], along: [i32; N]) -> Result<Self, ArcError> {
        Ok(Path::Arc(Helix::new(arc, plane, along)?))
    }

    const HAS_ELLIPSES: bool = true;

    fn ellipse(
        ellipse: &GridEllipse,
        plane: [usize; 2],
        along: [i32; N],
    ) -> Result<Self, ArcError> {
        Ok(Path::Ellipse(Helix::of_ellipse(ellipse, plane, along)?))
    }

    fn radius(&self) -> Option<u64> {
        match self {
            Path::Line(_) => None,
            Path::Arc(helix) => Some(helix.radius()),
            Path::Ellipse(helix) => Some(helix.radius()),
        }
    }

    fn totals_of_arc(&self) -> Option<Totals> {
        match self {
            Path::Arc(helix) => helix.totals_of_arc(),
            _ => None,
        }
    }

    fn arc_again(
        arc: &ArcMove,
        plane: [usize; 2],
        along: [i32; N],
        totals: Totals,
    ) -> Result<Self, ArcError> {
        Ok(Path::Arc(Helix::again(arc, plane, along, totals)?))
    }

    #[inline]
    fn as_arc(&mut self) -> Option<&mut Helix<N>> {
        match self {
            Path::Arc(helix) => Some(helix),
            _ => None,
        }
    }

    #[inline]
    fn as_line(&mut self) -> Option<&mut Line<N>> {
        match self {
            Path::Line(line) => Some(line),
            _ => None,
        }
    }
}

/// The long code of the conics stays out of the short one of lines and arcs.
#[inline(never)]
fn next_of_ellipse<const N: usize>(helix: &mut Helix<N, Conic>) -> Option<Step> {
    helix.next()
}

impl<const N: usize> Method for Path<N> {
    #[inline]
    fn next_step(&mut self) -> Option<Step> {
        match self {
            Path::Line(line) => line.walk.next_step(),
            Path::Arc(helix) => helix.next(),
            Path::Ellipse(helix) => next_of_ellipse(helix),
        }
    }

    #[inline]
    fn left(&self) -> u32 {
        match self {
            Path::Line(line) => line.walk.left(),
            Path::Arc(helix) => helix.left(),
            Path::Ellipse(helix) => helix.left(),
        }
    }

    #[inline]
    fn totals(&self) -> Totals {
        match self {
            Path::Line(line) => line.walk.totals(),
            Path::Arc(helix) => helix.totals(),
            Path::Ellipse(helix) => helix.totals(),
        }
    }
}

interpolator!(Path<N>);
