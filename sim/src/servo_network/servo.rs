//! A servo module with its motor.

use husillo_controllers::ServoModule;
use husillo_machine::ServoInputs;
use husillo_transports::nmc::{Baud, Receiver, Verdict};

use super::node::Change;
use super::{FULL_CURRENT_A, SERVO_PERIOD_S, Surroundings};
use crate::{DcMotor, DcMotorModel};

/// Code of Hard Reset.
const HARD_RESET: u8 = 0xf;

/// A servo module with its motor.
#[derive(Clone, Debug)]
pub(super) struct Servo {
    version: u8,
    pub(super) module: ServoModule,
    pub(super) motor: DcMotor,
    duty: f64,
    /// Count that the module sees. The counts that a silent encoder lost are not in it.
    seen_counts: i64,
    lost_counts: i64,
    pub(super) around: Surroundings,
    /// Reads the packets in order to detect a Hard Reset, which the module does not report.
    receiver: Receiver,
    is_enabled: bool,
    /// Whether a Hard Reset waits for the end of the period.
    is_reset: bool,
}

impl Servo {
    /// A module of this version in its state after power-up, with its motor at rest.
    pub(super) fn new(version: u8, motor: DcMotorModel) -> Servo {
        Servo {
            version,
            module: ServoModule::new(version),
            motor: DcMotor::new(motor),
            duty: 0.0,
            seen_counts: 0,
            lost_counts: 0,
            around: Surroundings::default(),
            receiver: Receiver::new(),
            is_enabled: false,
            is_reset: false,
        }
    }

    /// Returns to the state after power-up. The motor continues without a drive.
    pub(super) fn power_up(&mut self) {
        self.module = ServoModule::new(self.version);
        self.duty = 0.0;
        self.receiver.reset();
        self.is_reset = false;
    }

    /// Takes a byte of the command line.
    pub(super) fn push(&mut self, byte: u8) {
        let link = self.module.link();
        let (own, group) = (link.address(), link.group().address);
        link.push(byte);
        if self.is_enabled && self.receiver.push(byte) == Some(Verdict::Sound) {
            let address = self.receiver.address();
            // Groups begin at 0x80.
            let is_meant = address == own || address >= 0x80 && address == group;
            self.is_reset |= is_meant && self.receiver.code() == HARD_RESET;
        }
    }

    /// Sets ADDR_IN.
    pub(super) fn set_enabled(&mut self, is_enabled: bool) {
        self.is_enabled = is_enabled;
        self.module.link().set_enabled(is_enabled);
        if !is_enabled {
            self.receiver.reset();
            self.is_reset = false;
        }
    }

    /// Counts the edges of the encoder. Those of a silent one are lost.
    fn count(&mut self) {
        let counts = self.motor.counts();
        if self.around.encoder_is_silent {
            self.lost_counts = counts - self.seen_counts;
        } else {
            self.seen_counts = counts - self.lost_counts;
        }
    }

    /// Runs motor and module for one servo period; a dead module drives nothing.
    pub(super) fn tick(&mut self, is_alive: bool) -> Option<Change> {
        let duty = if self.around.without_power || !is_alive {
            0.0
        } else {
            self.duty
        };
        if self.around.is_blocked {
            self.motor.push_against_a_stop(duty, SERVO_PERIOD_S);
        } else {
            self.motor
                .advance(duty, self.around.load_nm, SERVO_PERIOD_S);
        }
        self.count();
        if !is_alive {
            return None;
        }
        let current = self.motor.current_a().abs() / FULL_CURRENT_A * 255.0;
        let output = self.module.tick(&ServoInputs {
            counts: self.seen_counts as i32, // modulo 2^32, as the counter of a module
            limit_1: self.around.limit_1,
            limit_2: self.around.limit_2,
            index: self.motor.is_at_index() && !self.around.encoder_is_silent,
            current: current.min(255.0) as u8,
            has_power: !self.around.without_power,
        });
        self.duty = f64::from(output.drive.signed()) / 255.0;
        let is_reset = std::mem::take(&mut self.is_reset);
        match output.baud? {
            // A reset that came too soon after another packet was dropped, and changes no rate.
            Baud::B19200 if is_reset => Some(Change::Reset),
            baud => Some(Change::Baud(baud)),
        }
    }
}
