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

    /// The pins after a step of these axes, of which those of the second mask go backwards.
    #[inline]
    pub fn step(&mut self, [mut axes, mut negative]: [u8; 2]) -> u8 {
        let mut place = 0;
        for motor in &mut self.axes {
            if axes & 1 != 0 {
                let phases = phases(motor.step(if negative & 1 != 0 { -1 } else { 1 }));
                self.levels = self.levels & !(0b11 << place) | phases << place;
            }
            (axes, negative, place) = (axes >> 1, negative >> 1, place + 2);
        }
        self.levels
    }
}

/// PH of both phases.
fn phases(Levels(levels): Levels) -> u8 {
    levels & 1 | levels >> 2 & 2
}
