//! Features of a drill file: holes and slots.

use crate::tool::Tool;

/// A hole or a slot.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Feature {
    /// A drilled hole.
    Hole(Hole),
    /// A slot.
    Slot(Slot),
}

/// A drilled hole.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Hole {
    /// X and Y of the centre, in nanometres.
    pub at_nm: [i64; 2],
    /// The tool with its diameter.
    pub tool: Tool,
}

/// A slot, or one piece of a longer rout. It is as wide as its tool, which moves from one end to
/// the other.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Slot {
    /// X and Y of one end, in nanometres.
    pub from_nm: [i64; 2],
    /// X and Y of the other end, in nanometres.
    pub to_nm: [i64; 2],
    /// The path between the ends.
    pub path: Path,
    /// The tool with its diameter.
    pub tool: Tool,
}

/// The path of a slot.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Path {
    /// Straight: `G85`, or `G01` of a rout.
    Straight,
    /// An arc with a given radius (`A`) of at most half a turn. The reader does not check that the
    /// radius spans the distance of the ends.
    Radius {
        /// `G02`; `G03` otherwise.
        clockwise: bool,
        /// Above zero, in nanometres.
        radius_nm: i64,
    },
    /// An arc about a given centre (`I` and `J`, relative to the start). The reader does not check
    /// that the end is on the arc.
    Centre {
        /// `G02`; `G03` otherwise.
        clockwise: bool,
        /// X and Y in nanometres.
        centre_nm: [i64; 2],
    },
}

/// Iterator over the features of one line: none, one, or the holes of a repeat.
#[derive(Clone, Debug)]
pub struct Features {
    next: Option<Feature>,
    step: [i64; 2],
    left: u16,
}

impl Features {
    pub(crate) const NONE: Features = Features {
        next: None,
        step: [0; 2],
        left: 0,
    };

    pub(crate) const fn one(feature: Feature) -> Features {
        Features {
            next: Some(feature),
            step: [0; 2],
            left: 1,
        }
    }

    /// Creates `count` holes, each `step` nanometres from the previous one. The last hole is within
    /// [`LIMIT_NM`](crate::LIMIT_NM), so all are.
    pub(crate) const fn repeated(first: Hole, step: [i64; 2], count: u16) -> Features {
        Features {
            next: Some(Feature::Hole(first)),
            step,
            left: count,
        }
    }
}

impl Iterator for Features {
    type Item = Feature;

    fn next(&mut self) -> Option<Feature> {
        self.left = self.left.checked_sub(1)?;
        let feature = self.next?;
        if let Some(Feature::Hole(Hole { at_nm: [x, y], .. })) = &mut self.next {
            let [step_x, step_y] = self.step;
            // The sums are below 2^50 + 2^50.
            *x = x.wrapping_add(step_x);
            *y = y.wrapping_add(step_y);
        }
        Some(feature)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = usize::from(self.left);
        (left, Some(left))
    }
}

impl ExactSizeIterator for Features {}
impl core::iter::FusedIterator for Features {}
