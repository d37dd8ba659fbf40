//! Lost steps, and where each axis lost its first ones.

/// The place where an axis lost its first steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstLoss {
    /// Number of the step event, from 1.
    pub event: u64,
    /// Seconds from the start.
    pub time_s: f64,
    /// Position of the tool, nm of the machine frame.
    pub at_nm: [f64; 3],
}

/// Steps that the motors lost.
#[derive(Clone, Copy, Debug, Default)]
pub struct Losses {
    lost: [u64; 3],
    first: [Option<FirstLoss>; 3],
}

impl Losses {
    /// Steps lost so far.
    pub const fn lost(&self) -> [u64; 3] {
        self.lost
    }

    /// The first loss of each axis.
    pub const fn first(&self) -> [Option<FirstLoss>; 3] {
        self.first
    }

    /// Records new totals of lost steps, at `here`.
    #[cold]
    pub fn lose(&mut self, lost: [u64; 3], here: FirstLoss) {
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
            at_nm: [0.0; 3],
        };
        let mut losses = Losses::default();
        losses.lose([1, 0, 0], at(10));
        losses.lose([2, 0, 3], at(20));
        assert_eq!(losses.lost(), [2, 0, 3]);
        assert_eq!(losses.first(), [Some(at(10)), None, Some(at(20))]);
    }
}
