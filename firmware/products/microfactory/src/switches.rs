//! The inputs of the microfactory: the home switches of X, Y and Z, and the contact of the tool
//! with the work piece.

use husillo_controllers::{MICROFACTORY_MOTORS, MicrofactoryInputs};

/// Inputs of the board from bit 0: X, Y, Z, contact. Without the feature `switches` of `board`,
/// they are computed from the positions of a simulated machine.
pub struct Switches {
    /// The take-up of each axis: how many steps its motor is ahead of its load.
    ahead: [i32; 3],
    /// The position of each load in steps, counted from power-on.
    loads: [i32; 3],
}

impl Switches {
    /// The simulated machine at power-on.
    pub fn new() -> Self {
        Switches {
            ahead: BACKLASH,
            loads: [0; 3],
        }
    }

    /// Moves the simulated machine by these steps. Its spindle closes no switch.
    pub fn moved(&mut self, delta: &[i8; MICROFACTORY_MOTORS]) {
        let axes = self.ahead.iter_mut().zip(&mut self.loads);
        for ((ahead, load), (delta, backlash)) in axes.zip(delta.iter().zip(BACKLASH)) {
            let motor = ahead.wrapping_add((*delta).into());
            *ahead = motor.max(0).min(backlash);
            *load = load.wrapping_add(motor.wrapping_sub(*ahead));
        }
    }

    /// Reads the switches.
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

/// The backlash of each axis in steps, as in `MicrofactoryConfig::ORIGINAL`.
const BACKLASH: [i32; 3] = [200, 0, 200];
