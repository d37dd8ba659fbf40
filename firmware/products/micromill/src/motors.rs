//! The drivers of the motors: two PH inputs for each motor. In full steps, I0 and I1 stay low.

use husillo_controllers::MicromillConfig;
use husillo_stepper::{CoilDriver, Driver, Levels, Mode, Sequencer};

/// The machine. For another machine, use another constant.
static MACHINE: MicromillConfig = MicromillConfig::MICROMILL;

/// Two lines for each motor suffice for full steps, with either driver.
const MOTOR: Sequencer = match Sequencer::new(Driver::Pbl3717a, Mode::Full) {
    Ok(motor) => motor,
    Err(_) => panic!("the driver has full steps"),
};

/// X, Y and Z, stepped together.
pub struct Motors {
    /// The state of each motor in its cycle of four states: two bits per motor, X lowest.
    at: u8,
    /// PH of both phases of X, Y and Z, from bit 0, for each value of `at`.
    levels: [u8; 64],
}

/// The change of `at` for each pair of masks: the axes that step, and from bit 3 the axes that step
/// backwards. The two bits of an axis are 1 for a step forwards and 3 for a step backwards.
const STEPS: [u8; 64] = {
    let mut steps = [0; 64];
    let mut masks = 0;
    while masks < 64 {
        let (axes, negative) = (masks as u8, masks as u8 >> 3);
        steps[masks] = spread(axes) | spread(negative) << 1;
        masks += 1;
    }
    steps
};

/// Spreads three bits: above each of them is an empty bit.
const fn spread(bits: u8) -> u8 {
    bits & 1 | (bits & 2) << 1 | (bits & 4) << 2
}

impl Motors {
    /// All motors are at the first state of their cycle.
    pub fn at_start() -> Self {
        let mut motor = MOTOR;
        let cycle = [0, 1, 1, 1].map(|step| phases(motor.step(step)));
        let mut levels = [0; 64];
        for (at, levels) in levels.iter_mut().enumerate() {
            *levels = cycle[at & 3] | cycle[at >> 2 & 3] << 2 | cycle[at >> 4] << 4;
        }
        Motors { at: 0, levels }
    }

    /// The machine with these motors.
    pub const fn machine(&self) -> &'static MicromillConfig {
        &MACHINE
    }

    /// Makes a step of the axes of the first mask. Those of the second mask step backwards. Returns
    /// the levels of the pins.
    #[inline]
    pub fn step(&mut self, [axes, negative]: [u8; 2]) -> u8 {
        let step = STEPS[usize::from(axes | negative << 3) % 64];
        // Adds within each pair of bits. No carry reaches the next pair.
        const LOW: u8 = 0b010101;
        self.at = ((self.at & LOW) + (step & LOW)) ^ ((self.at ^ step) & !LOW);
        self.levels[usize::from(self.at % 64)]
    }
}

/// PH of both phases.
fn phases(Levels(levels): Levels) -> u8 {
    levels & 1 | levels >> 2 & 2
}
