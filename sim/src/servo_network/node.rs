//! A module on the line: its device, its rate, and what it receives and sends.

use husillo_transports::nmc::Baud;

use super::ear::Ear;
use super::io_module::{IoInputs, IoModule};
use super::servo::Servo;
use crate::DcMotorModel;

/// A change of the line in a period.
pub(super) enum Change {
    Baud(Baud),
    Reset,
}

/// The description of a module for [`ServoNetwork::of_modules`](super::ServoNetwork::of_modules).
#[derive(Copy, Clone, Debug, PartialEq)]
pub enum NetworkModule {
    /// A servo module.
    Servo {
        /// 4 for the original chip, 5 or 10.
        version: u8,
        /// Its motor.
        motor: DcMotorModel,
    },
    /// A module with twelve inputs and outputs.
    Io {
        /// The version in its replies.
        version: u8,
    },
}

#[derive(Clone, Debug)]
pub(super) enum Device {
    // In a box, because it is much larger than the other variant.
    Servo(Box<Servo>),
    Io(Box<IoModule>, IoInputs),
}

/// A byte that a module is sending.
#[derive(Copy, Clone, Debug)]
pub(super) struct Byte {
    pub(super) value: u8,
    pub(super) start_ns: u64,
    pub(super) end_ns: u64,
}

/// A module on the line.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) device: Device,
    pub(super) baud: Baud,
    /// Whether the supply is off: the module neither receives nor answers, and its motor has no
    /// drive.
    is_dead: bool,
    /// End of the time after a reset in which it receives nothing.
    deaf_until_ns: u64,
    ear: Ear,
    /// The byte that it sends.
    pub(super) saying: Option<Byte>,
}

impl Node {
    pub(super) fn new(module: NetworkModule) -> Node {
        let device = match module {
            NetworkModule::Servo { version, motor } => {
                Device::Servo(Box::new(Servo::new(version, motor)))
            }
            NetworkModule::Io { version } => {
                Device::Io(Box::new(IoModule::new(version)), IoInputs::default())
            }
        };
        Node {
            device,
            baud: Baud::default(),
            is_dead: false,
            deaf_until_ns: 0,
            ear: Ear::default(),
            saying: None,
        }
    }

    /// Switches the supply. The module is then in the state of power-up.
    pub(super) fn set_dead(&mut self, is_dead: bool, deaf_until_ns: u64) {
        self.is_dead = is_dead;
        self.saying = None;
        self.restart(deaf_until_ns);
        match &mut self.device {
            Device::Servo(servo) => servo.power_up(),
            Device::Io(module, _) => **module = IoModule::new(module.version()),
        }
    }

    fn restart(&mut self, deaf_until_ns: u64) {
        self.baud = Baud::default();
        self.deaf_until_ns = deaf_until_ns;
        self.ear = Ear::default();
    }

    /// Time of a bit at its rate, ns.
    pub(super) fn bit_ns(&self) -> u64 {
        1_000_000_000 / u64::from(self.baud.bits_per_s())
    }

    /// Whether the module understands a host of this rate: they differ by at most 2 %.
    pub(super) fn understands(&self, host_bits_per_s: Option<u32>) -> bool {
        let own = self.baud.bits_per_s();
        host_bits_per_s.is_none_or(|rate| rate.abs_diff(own) <= own / 50)
    }

    /// Receives a byte that ends at `now_ns`.
    pub(super) fn push(&mut self, byte: u8, now_ns: u64) {
        if self.is_dead || now_ns < self.deaf_until_ns {
            return;
        }
        self.fall_silent(now_ns);
        match &mut self.device {
            Device::Servo(servo) => servo.push(byte),
            Device::Io(module, _) => module.push(byte),
        }
    }

    /// Receives a byte that was sent at another rate.
    pub(super) fn overhear(&mut self, byte: Byte, bit_ns: u64) {
        let own = self.bit_ns();
        let heard = self.ear.byte(byte.value, byte.start_ns, bit_ns, own);
        heard
            .into_iter()
            .for_each(|heard| self.push(heard, byte.end_ns));
    }

    /// Receives silence until `now_ns`, with the receiver for other rates.
    pub(super) fn overhear_silence(&mut self, now_ns: u64) {
        let heard = self.ear.rest(now_ns, self.bit_ns());
        heard.into_iter().for_each(|heard| self.push(heard, now_ns));
    }

    /// Stops sending in the middle of a byte, because the module has received one. The line is then
    /// idle, so the rest of the bits read 1.
    fn fall_silent(&mut self, now_ns: u64) {
        let bit_ns = self.bit_ns();
        self.saying = self.saying.and_then(|byte| {
            let bits = now_ns.saturating_sub(byte.start_ns) / bit_ns;
            // The start bit and the data bits that were sent.
            let missing = match bits {
                0 => return None,
                1..=8 => 0xff << (bits - 1),
                _ => 0,
            };
            Some(Byte {
                value: byte.value | missing as u8,
                ..byte
            })
        });
    }

    /// Runs one period. `reset_ns` is the time after a reset in which it receives nothing.
    pub(super) fn tick(&mut self, now_ns: u64, reset_ns: u64) -> Option<Baud> {
        let is_alive = !self.is_dead;
        let change = match &mut self.device {
            Device::Servo(servo) => servo.tick(is_alive),
            Device::Io(module, inputs) => is_alive.then(|| module.tick(inputs)).flatten(),
        };
        match change? {
            Change::Baud(baud) => self.baud = baud,
            Change::Reset => self.restart(now_ns + reset_ns),
        }
        Some(self.baud)
    }

    /// The next byte of a reply.
    pub(super) fn transmit(&mut self) -> Option<u8> {
        match &mut self.device {
            Device::Servo(servo) => servo.module.link().transmit(),
            Device::Io(module, _) => module.transmit(),
        }
    }

    /// Begins to send the next byte of a reply, if there is one.
    pub(super) fn say(&mut self, now_ns: u64) {
        let end_ns = now_ns + 10 * self.bit_ns();
        self.saying = self.transmit().map(|value| Byte {
            value,
            start_ns: now_ns,
            end_ns,
        });
    }

    /// Sets ADDR_IN.
    pub(super) fn set_enabled(&mut self, is_enabled: bool) {
        match &mut self.device {
            Device::Servo(servo) => servo.set_enabled(is_enabled),
            Device::Io(module, _) => module.set_enabled(is_enabled),
        }
    }

    /// Whether ADDR_OUT enables the next module.
    pub(super) fn enables_next(&mut self) -> bool {
        match &mut self.device {
            Device::Servo(servo) => servo.module.link().enables_next(),
            Device::Io(module, _) => module.enables_next(),
        }
    }
}
