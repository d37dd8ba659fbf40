//! Step and repeat: commands for patterns, and copies of patterns.
//!
//! The behaviour is that of the programming manual of Excellon's CNC-7. The eight mirrored and
//! turned corners of its sample program test the order of swapping and mirroring.

use crate::feature::{Feature, Hole, Path, Slot};
use crate::length::within_limit;

/// A step-and-repeat command.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Pattern {
    /// `M25`: the following features form the set.
    Begin,
    /// `M01`: all features since [`Pattern::Begin`], including copies, form the set for the next
    /// copies. Offsets start from zero again.
    EndOfSet,
    /// `M02X..Y..`: copies of the set.
    Repeat(Repeat),
    /// `M08`: no more copies.
    End,
}

/// Copies of a set of features.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Repeat {
    /// Number of copies, 1 to 9999: `R3M02` makes three.
    pub count: u16,
    /// Step in nanometres from the previous copy to the next. The first copy is relative to the
    /// last copy of the previous command, or to the set.
    pub step_nm: [i64; 2],
    /// `M80`: negates X before the axes are swapped.
    pub mirror_x: bool,
    /// `M90`: negates Y before the axes are swapped.
    pub mirror_y: bool,
    /// `M70`: swaps X and Y.
    pub swap: bool,
}

impl Repeat {
    /// Returns the copy of one feature, at the offset `by_nm` from the set. Returns `None` if it is
    /// beyond [`LIMIT_NM`](crate::LIMIT_NM).
    pub fn copy(&self, feature: &Feature, by_nm: [i64; 2]) -> Option<Feature> {
        Some(match *feature {
            Feature::Hole(Hole { at_nm, tool }) => Feature::Hole(Hole {
                at_nm: self.place(at_nm, by_nm)?,
                tool,
            }),
            Feature::Slot(Slot {
                from_nm,
                to_nm,
                path,
                tool,
            }) => Feature::Slot(Slot {
                from_nm: self.place(from_nm, by_nm)?,
                to_nm: self.place(to_nm, by_nm)?,
                path: match path {
                    Path::Straight => Path::Straight,
                    Path::Radius {
                        clockwise,
                        radius_nm,
                    } => Path::Radius {
                        clockwise: clockwise ^ self.turns_arcs(),
                        radius_nm,
                    },
                    Path::Centre {
                        clockwise,
                        centre_nm,
                    } => Path::Centre {
                        clockwise: clockwise ^ self.turns_arcs(),
                        centre_nm: self.place(centre_nm, by_nm)?,
                    },
                },
                tool,
            }),
        })
    }

    fn place(&self, [x, y]: [i64; 2], by_nm: [i64; 2]) -> Option<[i64; 2]> {
        let signed = |nm: i64, mirror: bool| Some(if mirror { nm.checked_neg()? } else { nm });
        let (x, y) = (signed(x, self.mirror_x)?, signed(y, self.mirror_y)?);
        let [x, y] = if self.swap { [y, x] } else { [x, y] };
        Some([
            within_limit(x.checked_add(by_nm[0])?)?,
            within_limit(y.checked_add(by_nm[1])?)?,
        ])
    }

    /// Whether arcs reverse their direction. Each mirror and the swap reverse it once.
    const fn turns_arcs(&self) -> bool {
        self.mirror_x ^ self.mirror_y ^ self.swap
    }
}

/// The state of a reader in step and repeat.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Stage {
    Outside,
    /// Between M25 and M01.
    Set,
    /// Between M01 and M08: only copies are allowed.
    Copies,
}
