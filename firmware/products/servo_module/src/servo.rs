//! The servo module with its motor and encoder, at the pins or simulated.

use husillo_controllers::ServoModule;
use husillo_encoder::Extended;
use husillo_machine::ServoInputs;

use crate::plant::Plant;

/// Inputs of the board: 1 is closed. ADDR_IN is closed when it is low, SUPPLY when the motor has
/// its supply.
const LIMIT_1: u8 = 1;
const LIMIT_2: u8 = 2;
const INDEX: u8 = 4;
const ADDR_IN: u8 = 8;
const SUPPLY: u8 = 16;

/// Outputs: driver enable of the line, amplifier enable, direction, and ADDR_OUT, which is low when
/// the module has its address.
const TRANSMIT: u8 = 1;
const AMPLIFIER: u8 = 2;
const REVERSE: u8 = 4;
const ADDR_OUT: u8 = 8;

/// Faces of the simulated machine, in counts. The probe is closed at the first value and below, and
/// at the second value and above.
const FACES: [i32; 2] = [-1500, 1500];

/// Counts between the index pulses of a simulated encoder.
const TURN: i32 = 400;

/// A servo module on a board.
pub struct Servo {
    module: ServoModule,
    encoder: Extended<16>,
    plant: Plant,
    drive: i16,
    outputs: u8,
}

impl Servo {
    /// The module after power-up.
    pub fn new() -> Self {
        Servo {
            module: ServoModule::new(4),
            encoder: Extended::new(board::counts(0).into()),
            plant: Plant::new(),
            drive: 0,
            outputs: ADDR_OUT,
        }
    }

    /// Takes a byte from the line.
    pub fn hear(&mut self, byte: u8) {
        self.module.link().push(byte);
    }

    /// Runs one servo period.
    pub fn tick(&mut self) {
        let inputs = self.read();
        let output = self.module.tick(&inputs);
        self.drive = output.drive.signed();
        board::drive(output.drive.pwm);
        self.switch(REVERSE, output.drive.is_reverse);
        self.switch(AMPLIFIER, output.amplifier);
        let enables_next = self.module.link().enables_next();
        self.switch(ADDR_OUT, !enables_next);
        board::switch(self.outputs);
        if let Some(baud) = output.baud {
            board::baud(baud.bits_per_s());
        }
    }

    fn read(&mut self) -> ServoInputs {
        let mut simulated = ADDR_IN | SUPPLY;
        let mut current = 0; // no board has a converter
        if !board::HAS_MOTOR {
            self.plant.tick(self.drive);
            let counts = self.plant.counts();
            let [low, high] = FACES;
            if counts <= low || counts >= high {
                simulated |= LIMIT_1;
            }
            if counts.rem_euclid(TURN) == 0 {
                simulated |= INDEX;
            }
            current = self.plant.current(self.drive);
        }
        self.encoder
            .update(board::counts(self.plant.counts() as u16).into());
        let bits = board::inputs(simulated);
        let is = |bit: u8| bits & bit != 0;
        self.module.link().set_enabled(is(ADDR_IN));
        ServoInputs {
            counts: self.encoder.position_32(),
            limit_1: is(LIMIT_1),
            limit_2: is(LIMIT_2),
            index: is(INDEX),
            current,
            has_power: is(SUPPLY),
        }
    }

    fn switch(&mut self, output: u8, is_high: bool) {
        if is_high {
            self.outputs |= output;
        } else {
            self.outputs &= !output;
        }
    }

    /// The next byte of a reply, if there is one. The driver of the line is enabled before it.
    pub fn speak(&mut self) -> Option<u8> {
        let byte = self.module.link().transmit();
        if byte.is_some() {
            self.switch(TRANSMIT, true);
            board::switch(self.outputs);
        }
        byte
    }

    /// Releases the line.
    pub fn be_silent(&mut self) {
        self.switch(TRANSMIT, false);
        board::switch(self.outputs);
    }

    /// Whether a reply is waiting to be sent.
    pub fn has_reply(&mut self) -> bool {
        self.module.link().is_sending()
    }
}
