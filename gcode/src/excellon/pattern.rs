//! Step and repeat: what lines say about patterns, and how a copy of a pattern is made.
//!
//! As the programming manual of Excellon's CNC-7 has it, with the eight mirrored and turned corners of its sample program
//! as the test of the order of swapping and mirroring.

use super::feature::{Feature, Hole, Path, Slot};
use crate::arc::Direction;
use crate::nm::Nm;

/// What a line says about step and repeat.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Pattern {
    /// `M25`: the features from here on are the set.
    Begin,
    /// `M01`: all features since [`Pattern::Begin`], copies included, are the set that is copied next, and offsets count from
    /// zero again.
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
    /// How many, 1 to 9999: `R3M02` makes three.
    pub count: u16,
    /// From one copy to the next, and to the first one from the last copy before, or from the set itself.
    pub step: [Nm; 2],
    /// `M80`: X with the other sign, before the axes are swapped.
    pub mirror_x: bool,
    /// `M90`: Y with the other sign, before the axes are swapped.
    pub mirror_y: bool,
    /// `M70`: X becomes Y, and Y becomes X.
    pub swap: bool,
}

impl Repeat {
    /// One feature of a copy that is `by` away from the set; `None` when it would be beyond [`Nm::LIMIT`].
    pub fn copy(&self, feature: &Feature, by: [Nm; 2]) -> Option<Feature> {
        Some(match *feature {
            Feature::Hole(Hole { at, tool }) => Feature::Hole(Hole {
                at: self.place(at, by)?,
                tool,
            }),
            Feature::Slot(Slot {
                from,
                to,
                path,
                tool,
            }) => Feature::Slot(Slot {
                from: self.place(from, by)?,
                to: self.place(to, by)?,
                path: match path {
                    Path::Straight => Path::Straight,
                    Path::Radius(direction, radius) => Path::Radius(self.turned(direction), radius),
                    Path::Centre(direction, centre) => {
                        Path::Centre(self.turned(direction), self.place(centre, by)?)
                    }
                },
                tool,
            }),
        })
    }

    fn place(&self, [x, y]: [Nm; 2], by: [Nm; 2]) -> Option<[Nm; 2]> {
        let signed = |nm: Nm, mirror: bool| Some(if mirror { nm.0.checked_neg()? } else { nm.0 });
        let (x, y) = (signed(x, self.mirror_x)?, signed(y, self.mirror_y)?);
        let [x, y] = if self.swap { [y, x] } else { [x, y] };
        Some([
            Nm(x.checked_add(by[0].0)?).within_limit()?,
            Nm(y.checked_add(by[1].0)?).within_limit()?,
        ])
    }

    /// Each mirror and the swap turn the sense of an arc round.
    fn turned(&self, direction: Direction) -> Direction {
        let turns = self.mirror_x ^ self.mirror_y ^ self.swap;
        match (turns, direction) {
            (false, direction) => direction,
            (true, Direction::Clockwise) => Direction::CounterClockwise,
            (true, Direction::CounterClockwise) => Direction::Clockwise,
        }
    }
}

/// Where a reader is among patterns.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(super) enum Stage {
    Outside,
    /// Between M25 and M01.
    Set,
    /// Between M01 and M08: only copies.
    Copies,
}
