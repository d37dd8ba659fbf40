//! Paths of the mill: lines in three axes, and arcs in the first two. No string describes helices
//! or arcs in other planes.

use husillo_interp::{ArcError, ArcMove, Interpolator, Line, Moves, NarrowArc, Step};

/// A line or a flat arc. The methods are those of [`husillo_interp::Path`], so the steps are the
/// same.
///
/// Helices and arcs whose state requires 64 bits are not included. Such arcs are refused. Within
/// the mill's 2.1 m they are only spirals whose radius changes much in few steps. On a Cortex-M0
/// this saves 4 kB of code and 390 bytes of stack.
#[derive(Clone, Debug)]
// A mill stores one of these directly, because a box would require an allocator.
#[allow(clippy::large_enum_variant)]
pub(super) enum Flat {
    Line(Line<3>),
    Arc(NarrowArc),
}

impl Flat {
    /// Whether an arc fits the narrow method.
    pub(super) fn fits(arc: &ArcMove) -> bool {
        // An arc that is too small becomes a line.
        matches!(NarrowArc::check(arc), Ok(()) | Err(ArcError::Degenerate))
    }
}

impl Iterator for Flat {
    type Item = Step;

    #[inline]
    fn next(&mut self) -> Option<Step> {
        match self {
            Flat::Line(line) => line.next(),
            Flat::Arc(arc) => arc.next(),
        }
    }
}

impl Interpolator for Flat {
    fn remaining(&self) -> u32 {
        match self {
            Flat::Line(line) => line.remaining(),
            Flat::Arc(arc) => arc.remaining(),
        }
    }

    fn total_sweep(&self) -> u64 {
        match self {
            Flat::Line(line) => line.total_sweep(),
            Flat::Arc(arc) => arc.total_sweep(),
        }
    }

    fn largest_sweep(&self) -> u32 {
        match self {
            Flat::Line(line) => line.largest_sweep(),
            Flat::Arc(arc) => arc.largest_sweep(),
        }
    }
}

impl Moves<3> for Flat {
    fn line(delta: [i32; 3]) -> Self {
        Flat::Line(Line::new(delta))
    }

    /// The plane is that of the first two axes. The third axis does not move, because the string of
    /// an arc does not contain it.
    fn arc(arc: &ArcMove, _plane: [usize; 2], _along: [i32; 3]) -> Result<Self, ArcError> {
        Ok(Flat::Arc(NarrowArc::new(arc)?))
    }

    fn radius(&self) -> Option<u64> {
        match self {
            Flat::Line(_) => None,
            Flat::Arc(arc) => Some(arc.radius()),
        }
    }
}
