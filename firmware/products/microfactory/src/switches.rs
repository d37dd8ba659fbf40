//! What the microfactory sees: home switches of X, Y and Z, the tool at the work piece.

use husillo_controllers::{MICROFACTORY_MOTORS, MicrofactoryInputs};

/// Inputs of the board from bit 0: X, Y, Z, contact. Those of a simulated machine follow from the
/// positions of its loads.
pub struct Switches {
    /// Steps of the motors ahead of their loads, and of the loads from where they were at first.
    ahead: [i32; 3],
    loads: [i32; 3],
}

impl Switches {
    /// A simulated machine stands somewhere.
    pub fn new() -> Self {
        Switches {
            ahead: LASH,
            loads: [0; 3],
        }
    }

    /// A simulated machine moves; its spindle closes no switch.
    pub fn moved(&mut self, delta: &[i8; MICROFACTORY_MOTORS]) {
        let axes = self.ahead.iter_mut().zip(&mut self.loads);
        for ((ahead, load), (delta, lash)) in axes.zip(delta.iter().zip(LASH)) {
            let motor = ahead.wrapping_add((*delta).into());
            *ahead = motor.max(0).min(lash);
            *load = load.wrapping_add(motor.wrapping_sub(*ahead));
        }
    }

    /// The switches.
    pub fn inputs(&self) -> MicrofactoryInputs {
        let [x, y, z] = self.loads;
        let simulated = [x <= -420, y <= -380, z <= -900, y >= 1200];
        let bits = simulated.iter().rev();
        let bits = board::inputs(bits.fold(0, |bits, is_closed| bits << 1 | u8::from(*is_closed)));
        MicrofactoryInputs {
            home: [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0],
            contact: bits & 8 != 0,
        }
    }
}

/// As `MicrofactoryConfig::ORIGINAL` has it.
const LASH: [i32; 3] = [200, 0, 200];
