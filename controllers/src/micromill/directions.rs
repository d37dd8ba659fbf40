//! Axes that step, and their directions.

use husillo_interp::Step;
use husillo_transports::micromill::Axis;

/// Axes that step, and those of them that step backwards. Bit 0 is X. The two bytes fit a register.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) struct Directions {
    pub(super) axes: u8,
    pub(super) negative: u8,
}

impl Directions {
    pub(super) const NONE: Directions = Directions {
        axes: 0,
        negative: 0,
    };

    /// Returns one axis in one direction.
    pub(super) const fn one(axis: Axis, is_forward: bool) -> Directions {
        Directions::NONE.with(axis as u8, if is_forward { 1 } else { -1 })
    }

    /// Converts -1, 0 or +1 of every axis.
    pub(super) fn of(deltas: [i8; 3]) -> Directions {
        (0..)
            .zip(deltas)
            .fold(Directions::NONE, |directions, (axis, delta)| {
                directions.with(axis, delta)
            })
    }

    /// Adds another axis, 0 to 2.
    pub(super) const fn with(self, axis: u8, delta: i8) -> Directions {
        let bit = 1_u8.wrapping_shl(axis as u32);
        Directions {
            axes: self.axes | if delta != 0 { bit } else { 0 },
            negative: self.negative | if delta < 0 { bit } else { 0 },
        }
    }

    /// Returns the number of the only axis.
    pub(super) const fn number(self) -> usize {
        (self.axes >> 1) as usize // for the bits 1, 2 and 4
    }

    /// Returns -1, 0 or +1 for every axis.
    pub(super) const fn deltas(self) -> [i8; 3] {
        [self.delta(0), self.delta(1), self.delta(2)]
    }

    const fn delta(self, axis: u32) -> i8 {
        let bit = 1_u8.wrapping_shl(axis);
        match (self.axes & bit != 0, self.negative & bit != 0) {
            (false, _) => 0,
            (true, false) => 1,
            (true, true) => -1,
        }
    }
}

impl From<Step> for Directions {
    fn from(step: Step) -> Directions {
        Directions {
            axes: step.axes,
            negative: step.negative,
        }
    }
}
