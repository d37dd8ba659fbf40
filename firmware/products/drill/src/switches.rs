//! The inputs of the drill: the home switches of X and Y, and the two sensors of Z.

use husillo_controllers::DrillInputs;

/// Inputs of the board from bit 0: X, Y, Z up, Z down. Without the feature `switches` of `board`,
/// they are computed from the position of a simulated machine.
pub struct Switches {
    /// Steps of X and Y above their switches, of Z below its upper sensor.
    position: [i32; 3],
}

impl Switches {
    /// The simulated machine stands at any position when it is switched on.
    pub fn new() -> Self {
        Switches {
            position: [500, 250, 60],
        }
    }

    /// Moves the simulated machine by these steps.
    pub fn moved(&mut self, delta: &[i8; 3]) {
        for (position, delta) in self.position.iter_mut().zip(delta) {
            *position = position.wrapping_add((*delta).into());
        }
    }

    fn bits(&self) -> u8 {
        // The distance between the sensors of Z is 35 mm.
        const STROKE_STEPS: i32 = 3745;
        let [x, y, z] = self.position;
        let simulated = [x <= 0, y <= 0, z <= 0, z >= STROKE_STEPS];
        let bits = simulated.iter().rev();
        board::inputs(bits.fold(0, |bits, is_closed| bits << 1 | u8::from(*is_closed)))
    }

    /// Reads the switches and sensors.
    pub fn inputs(&self) -> DrillInputs {
        let bits = self.bits();
        DrillInputs {
            home: [bits & 1 != 0, bits & 2 != 0],
            is_up: bits & 4 != 0,
            is_down: bits & 8 != 0,
        }
    }
}
