//! Lost steps, and where each axis lost its first ones.

use crate::observers::AXES;

/// The position and time at which an axis lost its first steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstLoss {
    /// Number of the step event, from 1.
    pub event: u64,
    /// Seconds from the start.
    pub time_s: f64,
    /// Position of the tool, nm of the machine frame.
    pub at_nm: [f64; AXES],
}

/// Steps that the motors lost.
#[derive(Clone, Copy, Debug, Default)]
pub struct Losses {
    lost: [u64; AXES],
    first: [Option<FirstLoss>; AXES],
}

impl Losses {
    /// Steps lost so far.
    pub const fn lost(&self) -> [u64; AXES] {
        self.lost
    }

    /// The first loss of each axis.
    pub const fn first(&self) -> [Option<FirstLoss>; AXES] {
        self.first
    }

    /// Records new totals of lost steps, at `here`.
    #[cold]
    pub fn lose(&mut self, lost: [u64; AXES], here: FirstLoss) {
        for ((first, before), now) in self.first.iter_mut().zip(self.lost).zip(lost) {
            if before != now && first.is_none() {
                *first = Some(here);
            }
        }
        self.lost = lost;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_loss_of_each_axis_is_kept() {
        let at = |event| FirstLoss {
            event,
            time_s: 0.5,
            at_nm: [0.0; AXES],
        };
        let mut losses = Losses::default();
        losses.lose([1, 0, 0, 0, 0, 0], at(10));
        losses.lose([2, 0, 3, 0, 0, 0], at(20));
        assert_eq!(losses.lost(), [2, 0, 3, 0, 0, 0]);
        assert_eq!(losses.first()[..3], [Some(at(10)), None, Some(at(20))]);
    }
}
