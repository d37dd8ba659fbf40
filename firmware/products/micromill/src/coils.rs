//! The drivers of the motors, with all their inputs: six lines for each motor, PH, I0 and I1 of
//! phase A, then those of phase B. X has the lowest ones.

use board::Pins;
use husillo_stepper::{CoilDriver, Levels, Sequencer};

/// X, Y and Z, stepped together.
pub struct Motors {
    motors: [Sequencer; 3],
}

impl Motors {
    /// All motors are at the first state of the sequencer.
    pub fn new(motor: Sequencer) -> Self {
        Motors { motors: [motor; 3] }
    }

    /// Makes a step of the axes of the first mask. Those of the second mask step backwards. Returns
    /// the levels of the pins.
    #[inline]
    pub fn step(&mut self, [axes, negative]: [u8; 2]) -> Pins {
        let (mut levels, mut bit) = (0, 1);
        for (axis, motor) in self.motors.iter_mut().enumerate() {
            let delta = match (axes & bit != 0, negative & bit != 0) {
                (false, _) => 0,
                (true, false) => 1,
                (true, true) => -1,
            };
            let Levels(inputs) = motor.step(delta);
            levels |= Pins::from(inputs) << (6 * axis);
            bit <<= 1;
        }
        levels
    }
}
