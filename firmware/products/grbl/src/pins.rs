//! Which pin of a board has which signal.

use board::Pins;
use husillo_controllers::GrblEvent;

/// Motors' pins 0 to 2: the steps of X, Y and Z. Pins 3 to 5 are their directions, high for
/// backwards.
pub const STEPS: Pins = 0b111;
/// Motors' pin 6: mist coolant. The boards have four other outputs.
pub const MIST: Pins = 1 << 6;

/// The step pins of a step, and the levels with its directions. The direction of an axis that
/// stands is kept.
pub fn motors(delta: [i8; 3], mut levels: Pins) -> (Pins, Pins) {
    let mut steps = 0;
    for (bit, delta) in (0_u32..).zip(delta) {
        let (step, direction) = (1 << bit, 8 << bit);
        if delta != 0 {
            steps |= step;
            levels &= !direction;
        }
        if delta < 0 {
            levels |= direction;
        }
    }
    (steps, levels)
}

/// Outputs 0 to 3 of the board, and its PWM for the speed of the spindle.
#[derive(Default)]
pub struct Outputs(u8);

impl Outputs {
    /// The motors are off, `$4` included.
    const DISABLE: u8 = 1;
    /// The spindle turns.
    const SPINDLE: u8 = 1 << 1;
    /// It turns counter-clockwise.
    const DIRECTION: u8 = 1 << 2;
    const FLOOD: u8 = 1 << 3;

    /// Switches an output.
    pub fn switch(&mut self, event: GrblEvent) {
        match event {
            GrblEvent::Disable { is_high } => self.set(Self::DISABLE, is_high),
            GrblEvent::SpindleDirection { is_high } => self.set(Self::DIRECTION, is_high),
            GrblEvent::SpindleDuty { duty } => {
                board::drive(duty);
                self.set(Self::SPINDLE, duty > 0);
            }
            GrblEvent::Flood { is_on } => self.set(Self::FLOOD, is_on),
            _ => {}
        }
    }

    fn set(&mut self, output: u8, is_high: bool) {
        self.0 = if is_high {
            self.0 | output
        } else {
            self.0 & !output
        };
        board::switch(self.0);
    }
}
