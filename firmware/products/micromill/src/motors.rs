//! The motors' drivers: three pairs of PH, in full steps both I0 and I1 stay low.

use husillo_stepper::{CoilDriver, Levels, Sequencer};

/// X, Y and Z, stepped together.
pub struct Motors {
    /// Where in its cycle of four states each motor is: two bits, X has the lowest.
    at: u8,
    /// PH of both phases of X, Y and Z, from bit 0, for each of that.
    levels: [u8; 64],
}

/// Two bits per axis, for masks of the axes that step and, from bit 3, of those that step
/// backwards: one for a step forwards, three for a step backwards.
const STEPS: [u8; 64] = {
    let mut steps = [0; 64];
    let mut ways = 0;
    while ways < 64 {
        let (axes, negative) = (ways as u8, ways as u8 >> 3);
        steps[ways] = spread(axes) | spread(negative) << 1;
        ways += 1;
    }
    steps
};

/// Three bits, each of them followed by an empty one.
const fn spread(bits: u8) -> u8 {
    bits & 1 | (bits & 2) << 1 | (bits & 4) << 2
}

impl Motors {
    /// At rest, where the sequencer of full steps begins.
    pub fn new(mut motor: Sequencer) -> Self {
        let cycle = [0, 1, 1, 1].map(|step| phases(motor.step(step)));
        let mut levels = [0; 64];
        for (at, levels) in levels.iter_mut().enumerate() {
            *levels = cycle[at & 3] | cycle[at >> 2 & 3] << 2 | cycle[at >> 4] << 4;
        }
        Motors { at: 0, levels }
    }

    /// The pins after a step of these axes, of which those of the second mask go backwards.
    #[inline]
    pub fn step(&mut self, [axes, negative]: [u8; 2]) -> u8 {
        let step = STEPS[usize::from(axes | negative << 3) % 64];
        // A sum in each two bits, with no carry to the next ones.
        const LOW: u8 = 0b010101;
        self.at = ((self.at & LOW) + (step & LOW)) ^ ((self.at ^ step) & !LOW);
        self.levels[usize::from(self.at % 64)]
    }
}

/// PH of both phases.
fn phases(Levels(levels): Levels) -> u8 {
    levels & 1 | levels >> 2 & 2
}
