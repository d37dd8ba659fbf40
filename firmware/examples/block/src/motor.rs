//! Stands in for the hardware of a board: a motor, its encoder, and a probe at a work piece.

use husillo_machine::ServoInputs;
use husillo_pid::{Drive, ServoGains};

/// Gains of a PIC-SERVO for this motor. Only the proportional gain is used.
pub const GAINS: ServoGains = ServoGains {
    proportional: 2_000,
    derivative: 0,
    integral: 0,
    integral_limit: 0,
    output_limit: 255,
    current_limit: 0,
    error_limit: 2_000,
    rate_divisor: 1,
    dead_band: 0,
};

/// Position of the index, in counts.
pub const INDEX: i32 = 730;
/// Position of the work piece, in counts.
pub const PIECE: i32 = 2_345;

/// A motor whose speed follows its drive: 1/64 count per period for each 1/255 of the duty.
#[derive(Default)]
pub struct Motor {
    /// Position, in 1/64 counts.
    at: i32,
}

impl Motor {
    /// Advances by one servo period under this drive.
    pub fn turn(&mut self, drive: Drive) {
        self.at += i32::from(drive.signed());
    }

    /// The inputs that a board would read.
    pub fn read(&self) -> ServoInputs {
        let counts = self.at / 64;
        ServoInputs {
            counts,
            limit_1: counts >= PIECE,
            index: counts >= INDEX,
            has_power: true,
            ..ServoInputs::default()
        }
    }
}
