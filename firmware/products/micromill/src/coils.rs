//! The drivers of the motors, with all their inputs: six lines for each motor, PH, I0 and I1 of
//! phase A, then those of phase B. X has the lowest ones.

use board::Pins;
use husillo_controllers::MicromillConfig;
use husillo_stepper::{CoilDriver, Driver, Levels, Mode, Sequencer};

/// The machine with full, half and quarter steps. For another machine, use other constants.
static MACHINES: [MicromillConfig; 3] = [
    MicromillConfig::with_step_of(Mode::Full.steps_per_full()),
    MicromillConfig::with_step_of(Mode::Half.steps_per_full()),
    MicromillConfig::with_step_of(Mode::Quarter.steps_per_full()),
];

/// Jumper 0: half steps.
const HALF: u8 = 1;
/// Jumper 1: quarter steps, whatever jumper 0 is.
const QUARTER: u8 = 1 << 1;
/// Jumper 2: the drivers are A3988. Without it they are PBL3717A.
const A3988: u8 = 1 << 2;

/// A motor with this driver and step. The tables below call it while they are compiled, so a driver
/// without this step is an error of the compiler.
const fn motor(driver: Driver, mode: Mode) -> Sequencer {
    match Sequencer::new(driver, mode) {
        Ok(motor) => motor,
        Err(_) => panic!("both drivers have these steps"),
    }
}

/// A motor with full, half and quarter steps.
const fn motors(driver: Driver) -> [Sequencer; 3] {
    [
        motor(driver, Mode::Full),
        motor(driver, Mode::Half),
        motor(driver, Mode::Quarter),
    ]
}

static PBL3717A_MOTORS: [Sequencer; 3] = motors(Driver::Pbl3717a);
static A3988_MOTORS: [Sequencer; 3] = motors(Driver::A3988);

/// X, Y and Z, stepped together.
pub struct Motors {
    motors: [Sequencer; 3],
    machine: &'static MicromillConfig,
}

impl Motors {
    /// The motors that the jumpers choose. All are at the first state of their cycle.
    pub fn at_start() -> Self {
        let jumpers = board::jumpers();
        let [full, half, quarter] = if jumpers & A3988 != 0 {
            &A3988_MOTORS
        } else {
            &PBL3717A_MOTORS
        };
        let [by_full, by_half, by_quarter] = &MACHINES;
        let (motor, machine) = if jumpers & QUARTER != 0 {
            (quarter, by_quarter)
        } else if jumpers & HALF != 0 {
            (half, by_half)
        } else {
            (full, by_full)
        };
        Motors {
            motors: [*motor; 3],
            machine,
        }
    }

    /// The machine with these motors.
    pub const fn machine(&self) -> &'static MicromillConfig {
        self.machine
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
