//! What a board has in this place: a motor, its encoder, and a probe against a work piece.

use husillo_machine::ServoInputs;
use husillo_pid::{Drive, ServoGains};

/// Gains of a PIC-SERVO for this motor: proportional action alone.
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

/// Where the index and the work piece are, counts.
pub const INDEX: i32 = 730;
pub const PIECE: i32 = 2_345;

/// A motor whose speed follows its drive: 1/64 count a period for each of the 255 parts of the duty.
#[derive(Default)]
pub struct Motor {
    /// 1/64 counts.
    at: i32,
}

impl Motor {
    /// A servo period goes by under this drive.
    pub fn turn(&mut self, drive: Drive) {
        self.at += i32::from(drive.signed());
    }

    /// What the board reads.
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
