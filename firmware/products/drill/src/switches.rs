//! What the drill sees: home switches of X and Y, the sensors of Z.

use husillo_controllers::DrillInputs;

/// Inputs of the board from bit 0: X, Y, up, down. A simulated machine's follow from where it is.
pub struct Switches {
    /// Steps of X and Y above their switches, of Z below its upper sensor.
    place: [i32; 3],
}

impl Switches {
    /// A simulated machine stands somewhere.
    pub fn new() -> Self {
        Switches {
            place: [500, 250, 60],
        }
    }

    /// A simulated machine moves.
    pub fn moved(&mut self, delta: &[i8; 3]) {
        for (place, delta) in self.place.iter_mut().zip(delta) {
            *place = place.wrapping_add((*delta).into());
        }
    }

    fn bits(&self) -> u8 {
        // 35 mm from one sensor of Z to the other.
        const STROKE_STEPS: i32 = 3745;
        let [x, y, z] = self.place;
        let simulated = [x <= 0, y <= 0, z <= 0, z >= STROKE_STEPS];
        let bits = simulated.iter().rev();
        board::inputs(bits.fold(0, |bits, is_closed| bits << 1 | u8::from(*is_closed)))
    }

    /// The switches and sensors.
    pub fn inputs(&self) -> DrillInputs {
        let bits = self.bits();
        DrillInputs {
            home: [bits & 1 != 0, bits & 2 != 0],
            is_up: bits & 4 != 0,
            is_down: bits & 8 != 0,
        }
    }
}
