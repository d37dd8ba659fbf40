//! Modules on one line, among them servo modules with motors: bytes in, bytes out, in steps of a
//! servo period.

mod damage;
mod ear;
mod io_module;
mod line;
mod node;
mod pair;
mod servo;

use std::collections::VecDeque;

use husillo_machine::ServoAxis;
use husillo_transports::nmc::Baud;

pub use damage::Damage;
pub use io_module::IoInputs;
pub use node::NetworkModule;

use crate::{DcMotor, DcMotorModel, Noise};
use damage::Account;
use ear::Ear;
use node::{Byte, Device, Node};
use pair::Pair;

/// Servo period, s.
pub const SERVO_PERIOD_S: f64 = 512e-6;
/// Servo period, ns.
const PERIOD_NS: u64 = 512_000;

/// Current at which the converter of a module reads 255, A: twice the stall current of the
/// prototype motor. Assumed; the original does not state it.
pub const FULL_CURRENT_A: f64 = 3.0;

/// External inputs and load of a servo module.
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
    /// Whether something blocks the motor.
    pub is_blocked: bool,
    /// Whether the encoder is silent: its cable is broken, and its counts are lost.
    pub encoder_is_silent: bool,
}

/// A network of modules behind one host.
///
/// Every byte takes time on the line, in both directions: ten bits at the rate of its sender. Each
/// module has its own rate, which Set Baud changes. At different rates host and module receive each
/// other as noise. ADDR_IN determines whether a module receives. A byte that a module receives ends
/// its reply. Two modules that answer at the same time corrupt each other's bytes.
///
/// # Examples
/// ```
/// use husillo_sim::{DcMotorModel, ServoNetwork};
///
/// let mut network = ServoNetwork::new(&[4, 4], DcMotorModel::PROTOTYPE);
/// for byte in [0xaa, 0x00, 0x21, 0x01, 0xff, 0x21] {
///     network.send(byte);
/// }
/// let reply: Vec<u8> = (0..20).flat_map(|_| network.tick()).collect();
/// assert_eq!(reply, [0x19, 0x19]);
/// ```
#[derive(Clone, Debug)]
pub struct ServoNetwork {
    nodes: Vec<Node>,
    now_ns: u64,
    /// Rate of the host in bits/s.
    host_rate: Option<u32>,
    /// The last rate that was set, for a host without a rate of its own.
    baud: Baud,
    /// Bytes that the modules have not received yet, with the rate of the host when it sent them.
    to_modules: VecDeque<(Byte, Option<u32>)>,
    /// Whether the transfer of a byte takes no time.
    is_fast: bool,
    /// Time after a reset in which a module receives nothing.
    reset_ns: u64,
    /// The pair of wires to the modules, and the pair from them.
    there: Pair,
    back: Pair,
    /// The host's receiver, for bytes that arrive at another rate.
    ear: Ear,
    account: Account,
}

impl ServoNetwork {
    /// Creates servo modules of these versions, all with the same motor. The first module is at the
    /// far end and is addressed first.
    pub fn new(versions: &[u8], motor: DcMotorModel) -> ServoNetwork {
        let servo = |&version| NetworkModule::Servo { version, motor };
        let modules: Vec<NetworkModule> = versions.iter().map(servo).collect();
        ServoNetwork::of_modules(&modules)
    }

    /// Creates modules of any kind. The first is at the far end and is addressed first.
    pub fn of_modules(modules: &[NetworkModule]) -> ServoNetwork {
        ServoNetwork {
            nodes: modules.iter().copied().map(Node::new).collect(),
            now_ns: 0,
            host_rate: None,
            baud: Baud::default(),
            to_modules: VecDeque::new(),
            is_fast: false,
            reset_ns: 0,
            there: Pair::new(Noise::default(), 1),
            back: Pair::new(Noise::default(), 2),
            ear: Ear::default(),
            account: Account::new(),
        }
    }

    /// Adds noise to both pairs of wires. The same seed gives the same noise.
    pub fn with_noise(mut self, noise: Noise, seed: u64) -> ServoNetwork {
        let seed = seed.wrapping_mul(2);
        self.there = Pair::new(noise, seed);
        self.back = Pair::new(noise, seed.wrapping_add(1));
        self
    }

    /// Sets the time for which a module receives nothing after a reset, or after its supply
    /// returns.
    pub fn with_reset_ms(mut self, reset_ms: u32) -> ServoNetwork {
        self.reset_ns = u64::from(reset_ms) * 1_000_000;
        self
    }

    /// Lets the transfer of a byte take no time. A packet and its reply then arrive within one
    /// period.
    pub fn without_byte_times(mut self) -> ServoNetwork {
        self.is_fast = true;
        self
    }

    /// Sets the rate at which the host sends and receives from now on, bits/s. With `None`, the
    /// initial state, the host has the rate that Set Baud last gave to any module, and every module
    /// understands it.
    pub fn set_host_rate(&mut self, bits_per_s: Option<u32>) {
        self.host_rate = bits_per_s;
    }

    /// Effects of the noise so far.
    pub fn damage(&self) -> Damage {
        Damage {
            wrong_bits: self.there.wrong_bits() + self.back.wrong_bits(),
            ..self.account.damage
        }
    }

    /// Switches the supply of a module off or on. The module is then in the state of power-up,
    /// without an address. The modules beyond it are disabled until it gets one. Modules count from
    /// 0; other numbers have no effect.
    pub fn set_dead(&mut self, module: usize, is_dead: bool) {
        let deaf_until_ns = self.now_ns + self.reset_ns;
        if let Some(node) = self.nodes.get_mut(module) {
            node.set_dead(is_dead, deaf_until_ns);
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
        let free_ns = self.to_modules.back().map_or(0, |(last, _)| last.end_ns);
        let start_ns = free_ns.max(self.now_ns);
        let byte = Byte {
            value: byte,
            start_ns,
            end_ns: start_ns + 10 * self.host_bit_ns(),
        };
        self.to_modules.push_back((byte, self.host_rate));
    }

    /// Number of bytes that have not arrived at the modules yet.
    pub fn waiting(&self) -> usize {
        self.to_modules.len()
    }

    /// Changes the inputs of a servo module, counted from 0; other numbers have no effect.
    pub fn surround(&mut self, module: usize, around: Surroundings) {
        if let Some(Device::Servo(servo)) = self.device_mut(module) {
            servo.around = around;
        }
    }

    /// Changes the inputs of an input and output module, counted from 0; other numbers have no
    /// effect.
    pub fn connect(&mut self, module: usize, inputs: IoInputs) {
        if let Some(Device::Io(_, old)) = self.device_mut(module) {
            *old = inputs;
        }
    }

    /// Levels of the outputs of an input and output module, and the duties of its PWM outputs.
    /// `None` for other modules.
    pub fn outputs(&self, module: usize) -> Option<(u16, [u8; 2])> {
        match self.device(module)? {
            Device::Io(module, _) => Some((module.outputs(), module.duties())),
            Device::Servo(_) => None,
        }
    }

    /// The axis of a servo module, from 0 on.
    pub fn axis(&self, module: usize) -> Option<&ServoAxis> {
        match self.device(module)? {
            Device::Servo(servo) => Some(servo.module.axis()),
            Device::Io(..) => None,
        }
    }

    /// The motor of a servo module, from 0 on.
    pub fn motor(&self, module: usize) -> Option<&DcMotor> {
        match self.device(module)? {
            Device::Servo(servo) => Some(&servo.motor),
            Device::Io(..) => None,
        }
    }

    /// Rate of a module, from 0 on.
    pub fn baud(&self, module: usize) -> Option<Baud> {
        self.nodes.get(module).map(|node| node.baud)
    }

    fn device(&self, module: usize) -> Option<&Device> {
        self.nodes.get(module).map(|node| &node.device)
    }

    fn device_mut(&mut self, module: usize) -> Option<&mut Device> {
        self.nodes.get_mut(module).map(|node| &mut node.device)
    }

    fn bits_per_s(&self) -> u32 {
        self.host_rate.unwrap_or(self.baud.bits_per_s()).max(1)
    }

    /// Time of a bit of the host, ns.
    fn host_bit_ns(&self) -> u64 {
        1_000_000_000 / u64::from(self.bits_per_s())
    }

    /// Runs one servo period: bytes arrive, motors turn, modules act. Returns the bytes that the
    /// host has received in it.
    pub fn tick(&mut self) -> Vec<u8> {
        let end_ns = self.now_ns + PERIOD_NS;
        let mut heard = if self.is_fast {
            self.carry_packet(end_ns);
            Vec::new()
        } else {
            self.carry(end_ns)
        };
        self.now_ns = end_ns;
        let bits = f64::from(self.bits_per_s()) * SERVO_PERIOD_S;
        let (noise, _) = self.there.pass(bits);
        noise.into_iter().for_each(|byte| self.deliver(byte));
        // Not beyond the start of a byte that is on the line.
        let next = self.to_modules.front();
        let silent_ns = next.map_or(end_ns, |(byte, _)| byte.start_ns.min(end_ns));
        for node in &mut self.nodes {
            node.overhear_silence(silent_ns);
            if let Some(baud) = node.tick(end_ns, self.reset_ns) {
                self.baud = baud;
            }
            if !self.is_fast && node.saying.is_none() {
                node.say(end_ns);
            }
        }
        self.enable();
        if self.is_fast {
            heard.extend(self.whole_replies());
        }
        let said = self.nodes.iter().filter_map(|node| node.saying);
        let silent_ns = said.map(|byte| byte.start_ns).min();
        let silent_ns = silent_ns.unwrap_or(end_ns).min(end_ns);
        heard.extend(self.ear.rest(silent_ns, self.host_bit_ns()));
        let (noise, silence) = self.back.pass(bits);
        self.account.note_silence(silence, &noise);
        heard.extend(noise);
        heard
    }

    /// Connects ADDR_OUT of each module to ADDR_IN of the next.
    fn enable(&mut self) {
        let mut enabled = true;
        for node in &mut self.nodes {
            node.set_enabled(enabled);
            enabled = enabled && node.enables_next();
        }
    }
}
