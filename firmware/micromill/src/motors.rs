//! The motors' drivers: three pairs of PH, in full steps both I0 and I1 stay low.

use husillo_stepper::{CoilDriver, Levels, Sequencer};

/// X, Y and Z.
pub struct Motors {
    axes: [Sequencer; 3],
    /// PH of both phases of X, Y and Z, from bit 0.
    levels: u8,
}

impl Motors {
    /// At rest, where a sequencer begins.
    pub fn new(motor: Sequencer) -> Self {
        let phases = phases(motor.levels());
        Motors {
            axes: [motor; 3],
            levels: phases | phases << 2 | phases << 4,
        }
    }

    /// The pins now.
    pub fn levels(&self) -> u8 {
        self.levels
    }

    /// The pins after a step.
    #[inline]
    pub fn step(&mut self, delta: &[i8; 3]) -> u8 {
        for ((motor, delta), place) in self.axes.iter_mut().zip(delta).zip(&[0, 2, 4]) {
            if *delta != 0 {
                let phases = phases(motor.step(*delta));
                self.levels = self.levels & !(0b11 << place) | phases << place;
            }
        }
        self.levels
    }
}

/// PH of both phases.
fn phases(Levels(levels): Levels) -> u8 {
    levels & 1 | levels >> 2 & 2
}
