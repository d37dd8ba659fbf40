//! The outputs beside the motors.

use husillo_controllers::GrblEvent;

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
