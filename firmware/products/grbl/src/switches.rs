//! The inputs: limits, probe and buttons.

use husillo_controllers::GrblInputs;

use crate::Grbl;

/// Inputs of the board from bit 0: limits of X, Y, Z, probe, hold, start, reset, door. Each is
/// closed to ground. On a board with five inputs there is no start, reset and door.
///
/// Without the feature `switches` of `board` they are those of the machine that
/// `husillo emulate grbl` simulates.
pub struct Switches {
    /// Steps of the motors from their place at power-on.
    motors: [i32; 3],
    /// The step that is being made.
    begun: [i8; 3],
}

/// Where the limit switches close above that place, and the probe below it, mm.
const LIMITS_MM: [i64; 3] = [20, 20, 10];
const PLATE_MM: i64 = -10;

impl Switches {
    /// The machine at power-on.
    pub const fn new() -> Self {
        Switches {
            motors: [0; 3],
            begun: [0; 3],
        }
    }

    /// A step begins.
    pub const fn moves(&mut self, delta: [i8; 3]) {
        self.begun = delta;
    }

    /// The step was made.
    pub fn moved(&mut self) {
        for (motor, delta) in self.motors.iter_mut().zip(self.begun) {
            *motor = motor.wrapping_add(delta.into());
        }
        self.dropped();
    }

    /// The step was not made.
    pub const fn dropped(&mut self) {
        self.begun = [0; 3];
    }

    /// Reads the inputs.
    pub fn inputs(&self, grbl: &Grbl) -> GrblInputs {
        let closed = board::inputs(if board::HAS_SWITCHES {
            0
        } else {
            self.simulated(grbl)
        });
        let is_high = |bit: u8| closed >> bit & 1 == 0;
        GrblInputs {
            limits: [is_high(0), is_high(1), is_high(2)],
            probe: is_high(3),
            hold: is_high(4),
            start: is_high(5),
            reset: is_high(6),
            door: is_high(7),
        }
    }

    fn simulated(&self, grbl: &Grbl) -> u8 {
        let settings = grbl.memory().settings();
        let steps = |axis: u8, mm: i64| {
            // A setting is below 2^32.
            mm.wrapping_mul(settings.milli(100_u8.wrapping_add(axis)).into()) / 1000
        };
        let mut closed = 0;
        for (axis, (motor, mm)) in (0_u8..).zip(self.motors.iter().zip(LIMITS_MM)) {
            if i64::from(*motor) >= steps(axis, mm) {
                closed |= 1 << axis;
            }
        }
        let [.., z] = self.motors;
        if i64::from(z) <= steps(2, PLATE_MM) {
            closed |= 1 << 3;
        }
        closed
    }
}
