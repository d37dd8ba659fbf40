//! Servo modules with motors on one line: bytes in, bytes out, in steps of a servo period.

use std::collections::VecDeque;

use husillo_controllers::ServoModule;
use husillo_machine::{ServoAxis, ServoInputs};
use husillo_transports::nmc::{Baud, Frame, Receiver, Verdict, unseen_pairs_in_halves};

use crate::{DcMotor, DcMotorModel, Noise, Wire};

/// Servo period, s.
pub const SERVO_PERIOD_S: f64 = 512e-6;

/// Current at which the converter of a module reads 255, A: twice the stall current of the
/// prototype motor. Assumed; the original does not state it.
pub const FULL_CURRENT_A: f64 = 3.0;

/// External inputs and load of a module.
#[derive(Copy, Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Limit switch or probe contact 1.
    pub limit_1: bool,
    /// Limit switch or probe contact 2.
    pub limit_2: bool,
    /// Load torque against positive rotation, N m.
    pub load_nm: f64,
    /// Whether the motor supply is missing.
    pub without_power: bool,
}

/// Effects of noise on the packets of a line.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
pub struct Damage {
    /// Wrong bits, including those in silence.
    pub wrong_bits: u64,
    /// Replies sent.
    pub replies: u64,
    /// Pairs of wrong bits in replies, in halves, that the checksum does not detect: see
    /// `husillo_transports::nmc::unseen_pairs_in_halves`.
    pub pairs_in_halves: u64,
    /// Replies that arrived damaged.
    pub damaged_replies: u64,
    /// Damaged replies with the right length and checksum, which are undetectable.
    pub unseen_replies: u64,
    /// Commands that modules accepted although they were never sent in that form.
    pub unseen_commands: u64,
}

/// A module with its motor.
#[derive(Clone, Debug)]
struct Node {
    version: u8,
    /// The module neither receives nor answers, and its motor has no drive.
    is_dead: bool,
    module: ServoModule,
    motor: DcMotor,
    duty: f64,
    around: Surroundings,
}

impl Node {
    /// Runs motor and module for one servo period.
    fn tick(&mut self) -> Option<Baud> {
        let duty = if self.around.without_power || self.is_dead {
            0.0
        } else {
            self.duty
        };
        self.motor
            .advance(duty, self.around.load_nm, SERVO_PERIOD_S);
        if self.is_dead {
            return None;
        }
        let counts = self.motor.counts();
        let current = self.motor.current_a().abs() / FULL_CURRENT_A * 255.0;
        let output = self.module.tick(&ServoInputs {
            counts: counts as i32, // modulo 2^32, as the counter of a module
            limit_1: self.around.limit_1,
            limit_2: self.around.limit_2,
            index: self.motor.is_at_index(),
            current: current.min(255.0) as u8,
            has_power: !self.around.without_power,
        });
        self.duty = f64::from(output.drive.signed()) / 255.0;
        output.baud
    }
}

/// A chain of servo modules behind one host. Every byte takes its time on the line. A module
/// receives what its ADDR_IN permits. Two modules that answer at the same time corrupt each other's
/// bytes.
///
/// # Examples
/// ```
/// use husillo_sim::{DcMotorModel, ServoChain};
///
/// let mut chain = ServoChain::new(&[4, 4], DcMotorModel::PROTOTYPE);
/// for byte in [0xaa, 0x00, 0x21, 0x01, 0xff, 0x21] {
///     chain.send(byte);
/// }
/// let reply: Vec<u8> = (0..20).flat_map(|_| chain.tick()).collect();
/// assert_eq!(reply, [0x19, 0x19]);
/// ```
#[derive(Clone, Debug)]
pub struct ServoChain {
    nodes: Vec<Node>,
    baud: Baud,
    /// Bytes on their way to the modules.
    to_modules: VecDeque<u8>,
    /// Bytes that still fit on the line in the present period; the fraction is carried.
    room: f64,
    /// Wire to the modules, and wire from them.
    wires: [Wire; 2],
    /// Carried fractions of a bit of silence on both wires.
    silence: [f64; 2],
    /// Receivers of the packets as sent and as received.
    receivers: [Receiver; 2],
    /// The last complete packet sent.
    sent: Option<Frame>,
    damage: Damage,
}

impl ServoChain {
    /// Creates modules of these versions, all with the same motor. The first module is at the far
    /// end and is addressed first.
    pub fn new(versions: &[u8], motor: DcMotorModel) -> ServoChain {
        let nodes = versions
            .iter()
            .map(|&version| Node {
                version,
                is_dead: false,
                module: ServoModule::new(version),
                motor: DcMotor::new(motor),
                duty: 0.0,
                around: Surroundings::default(),
            })
            .collect();
        ServoChain {
            nodes,
            baud: Baud::default(),
            to_modules: VecDeque::new(),
            room: 0.0,
            wires: [
                Wire::new(Noise::default(), 1),
                Wire::new(Noise::default(), 2),
            ],
            silence: [0.0; 2],
            receivers: [Receiver::new(), Receiver::new()],
            sent: None,
            damage: Damage::default(),
        }
    }

    /// Adds noise on both pairs of wires; the same seed gives the same noise.
    pub fn with_noise(mut self, noise: Noise, seed: u64) -> ServoChain {
        let seed = seed.wrapping_mul(2);
        self.wires = [
            Wire::new(noise, seed),
            Wire::new(noise, seed.wrapping_add(1)),
        ];
        self
    }

    /// Effects of the noise so far.
    pub fn damage(&self) -> Damage {
        let [to, from] = &self.wires;
        Damage {
            wrong_bits: to.wrong_bits() + from.wrong_bits(),
            ..self.damage
        }
    }

    /// Switches the supply of a module off or on. After that it is in the state of power-up without
    /// an address, and the modules beyond it are disabled until it gets one. Modules count from 0;
    /// other numbers have no effect.
    pub fn set_dead(&mut self, module: usize, is_dead: bool) {
        if let Some(node) = self.nodes.get_mut(module) {
            node.is_dead = is_dead;
            node.module = ServoModule::new(node.version);
            node.duty = 0.0;
        }
    }

    /// Number of modules.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no module.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Puts a byte on the command line; bytes arrive in order.
    pub fn send(&mut self, byte: u8) {
        self.to_modules.push_back(byte);
    }

    /// Changes the inputs of a module, counted from 0; other numbers have no effect.
    pub fn surround(&mut self, module: usize, around: Surroundings) {
        if let Some(node) = self.nodes.get_mut(module) {
            node.around = around;
        }
    }

    /// The axis of a module, from 0 on.
    pub fn axis(&self, module: usize) -> Option<&ServoAxis> {
        self.nodes.get(module).map(|node| node.module.axis())
    }

    /// The motor of a module, from 0 on.
    pub fn motor(&self, module: usize) -> Option<&DcMotor> {
        self.nodes.get(module).map(|node| &node.motor)
    }

    /// Baud rate of the line.
    pub fn baud(&self) -> Baud {
        self.baud
    }

    /// Runs one servo period: bytes that fit on the line arrive, motors turn, modules act. Returns
    /// the bytes they send, all bytes of a reply at once.
    pub fn tick(&mut self) -> Vec<u8> {
        let bits = f64::from(self.baud.bits_per_s()) * SERVO_PERIOD_S;
        // Ten bits per byte.
        self.room += bits / 10.0;
        let mut carried = 0.0;
        while self.room >= 1.0 {
            self.room -= 1.0;
            let Some(byte) = self.to_modules.pop_front() else {
                self.room = self.room.min(1.0);
                break;
            };
            carried += 10.0;
            self.note_sent(byte);
            for heard in self.wires[0].carry(byte) {
                self.deliver(heard);
            }
        }
        let silence = self.silence(0, bits - carried);
        for heard in self.wires[0].rest(silence) {
            self.deliver(heard);
        }
        let mut replies: Vec<Vec<u8>> = Vec::new();
        for node in &mut self.nodes {
            if let Some(baud) = node.tick() {
                self.baud = baud;
            }
            let reply: Vec<u8> = std::iter::from_fn(|| node.module.link().transmit()).collect();
            if !reply.is_empty() {
                replies.push(reply);
            }
        }
        self.enable();
        self.tell(&together(&replies), bits)
    }

    /// Carries the reply line of a period.
    fn tell(&mut self, reply: &[u8], bits: f64) -> Vec<u8> {
        let silence = self.silence(1, bits - 10.0 * reply.len() as f64);
        let [_, wire] = &mut self.wires;
        let mut heard: Vec<u8> = reply.iter().flat_map(|byte| wire.carry(*byte)).collect();
        if reply.is_empty() {
            return wire.rest(silence);
        }
        // A byte that began too late ends in the following silence, which is at least a character.
        heard.extend(wire.rest(silence.max(10)));
        let has_its_sum = heard.split_last().is_some_and(|(sum, rest)| {
            *sum == rest.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte))
        });
        self.damage.replies += 1;
        self.damage.pairs_in_halves += u64::from(unseen_pairs_in_halves(reply.len() as u16));
        self.damage.damaged_replies += u64::from(heard != reply);
        self.damage.unseen_replies +=
            u64::from(heard != reply && heard.len() == reply.len() && has_its_sum);
        heard
    }

    /// Whole bits of silence on a wire; the remainder, positive or negative, is carried to the next
    /// period.
    fn silence(&mut self, wire: usize, bits: f64) -> u64 {
        let due = self.silence[wire] + bits;
        let whole = due.floor().max(0.0);
        self.silence[wire] = due - whole;
        whole as u64
    }

    fn note_sent(&mut self, byte: u8) {
        if self.receivers[0].push(byte) == Some(Verdict::Sound) {
            self.sent = Some(frame(&self.receivers[0]));
        }
    }

    fn deliver(&mut self, byte: u8) {
        self.enable();
        if self.receivers[1].push(byte) == Some(Verdict::Sound)
            && self.sent != Some(frame(&self.receivers[1]))
        {
            self.damage.unseen_commands += 1;
        }
        for node in self.nodes.iter_mut().filter(|node| !node.is_dead) {
            node.module.link().push(byte);
        }
    }

    /// Connects ADDR_OUT of each module to ADDR_IN of the next.
    fn enable(&mut self) {
        let mut enabled = true;
        for node in &mut self.nodes {
            let link = node.module.link();
            link.set_enabled(enabled);
            enabled = enabled && link.enables_next();
        }
    }
}

fn frame(receiver: &Receiver) -> Frame {
    Frame::new(receiver.address(), receiver.code(), receiver.data())
}

/// Bytes on the line when several modules drive it: low wins.
fn together(replies: &[Vec<u8>]) -> Vec<u8> {
    let longest = replies.iter().map(Vec::len).max().unwrap_or(0);
    (0..longest)
        .map(|place| {
            let bytes = replies.iter().filter_map(|reply| reply.get(place));
            bytes.fold(0xff, |all, byte| all & byte)
        })
        .collect()
}
