//! The lamps of the panel, behind a shift register 74HC595 at three outputs.

use husillo_controllers::DrillLights;

/// Outputs of the board: the relay of the drill motor, and the lines of the register.
const SPINDLE: u8 = 1;
const DATA: u8 = 2;
const CLOCK: u8 = 4;
const LATCH: u8 = 8;

/// The outputs of the board: the spindle, and with the feature `lights` the lamps.
pub struct Lights {
    spindle: u8,
    /// The lamps that the register shows.
    shown: Option<u8>,
}

impl Lights {
    /// The spindle is off, and the register has not been written.
    pub const fn new() -> Self {
        Lights {
            spindle: 0,
            shown: None,
        }
    }

    /// Switches the spindle.
    pub fn switch_spindle(&mut self, on: bool) {
        self.spindle = if on { SPINDLE } else { 0 };
        board::switch(self.spindle);
    }

    /// Shows the lamps, if they have changed. The lamp of the heartbeat is lit if `heartbeat`.
    pub fn show(&mut self, lights: DrillLights, heartbeat: bool) {
        let lamps = lights.bits(heartbeat);
        if cfg!(not(feature = "lights")) || self.shown.replace(lamps) == Some(lamps) {
            return;
        }
        let spindle = self.spindle;
        for lamp in (0..8).rev() {
            let data = if lamps >> lamp & 1 == 1 { DATA } else { 0 };
            board::switch(spindle | data);
            board::switch(spindle | data | CLOCK);
        }
        board::switch(spindle);
        board::switch(spindle | LATCH);
        board::switch(spindle);
    }
}
