//! Motors whose coils are at the pins, four wires each, by transistors (ULN2003) or bridges (L298).
//!
//! Wires 0 and 2 are the ends of one phase, wires 1 and 3 those of the other.

use board::Pins;
use husillo_stepper::{Driver, Idle, Mode, Sequencer};

/// No pin has a pulse: a step is one change of levels.
pub const STEPS: Pins = 0;
/// Motors' pin 12: mist coolant.
pub const MIST: Pins = 1 << 12;

/// The driver of a motor. For other chips, choose another `Driver` and the number of its wires, or
/// any other `CoilDriver` without pulses.
type Motor = Sequencer;

/// Half steps: one phase and two phases in turn.
const MOTOR: Motor = match Sequencer::new(Driver::Unipolar, Mode::Half) {
    Ok(motor) => motor,
    Err(_) => panic!("the driver has this mode"),
};

/// The number of wires of a motor. The board has 18 pins for motors.
const WIRES: usize = 4;

/// The motors of X, Y and Z: X has the lowest pins.
pub struct Motors(husillo_stepper::Motors<3, Motor>);

impl Motors {
    /// All at the first state of their cycle, with the current off until the pins are set.
    pub fn new() -> Self {
        let mut coils = husillo_stepper::Motors::new([MOTOR; 3], Idle::Hold);
        coils.set_enabled(false);
        Motors(coils)
    }

    /// The levels after the last step.
    pub fn levels(&self) -> Pins {
        let wires = self.0.levels().iter().enumerate();
        wires.fold(0, |pins, (axis, levels)| {
            pins | Pins::from(levels.0) << (WIRES * axis)
        })
    }

    /// Begins a step. Returns the levels before it, and those at the step.
    pub fn step(&mut self, delta: [i8; 3]) -> [Pins; 2] {
        let before = self.levels();
        self.0.step(0, &delta, |_, _| ());
        [before, self.levels()]
    }

    /// Returns to the levels before this step, which was not made.
    pub fn undo(&mut self, delta: [i8; 3]) {
        let back = delta.map(i8::wrapping_neg);
        self.0.step(0, &back, |_, _| ());
    }

    /// Switches the current of all coils. The next current is that of the same state.
    ///
    /// It is on from power-on for the time `$1`, during a motion and for that time after it, and
    /// with `$1=255` until sleep.
    pub fn set_enabled(&mut self, is_on: bool) {
        self.0.set_enabled(is_on);
    }
}
