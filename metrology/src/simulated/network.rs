//! A simulated network of modules with a work piece before its probe.

use super::contact::Contact;
use super::piece::Mounted;
#[cfg(test)]
use crate::heads::operator::StopButton;
use crate::heads::{End, Machine, Switches, Wiring};
use husillo_sim::{
    DcMotor, DcMotorModel, IoInputs, NetworkModule, Noise, ServoNetwork, Surroundings,
};
use std::collections::{BTreeMap, BTreeSet};

/// Servo period, ns.
pub const PERIOD_NS: u64 = 512_000;

/// Seed of the noise, the same in every run.
const NOISE_SEED: u64 = 2026;

/// Modules, their motors, and the faces and the work piece that the probe touches. Modules are
/// counted from 1, as their addresses are.
#[derive(Clone, Debug)]
pub struct SimulatedNetwork {
    network: ServoNetwork,
    /// External levels and readings of each input and output module. They are not used for other
    /// modules.
    inputs: Vec<IoInputs>,
    contacts: Vec<Contact>,
    piece: Option<Mounted>,
    switches: Switches,
    /// End switches. Each has the number of its limit input, 0 or 1.
    ends: Vec<(Contact, usize)>,
    /// The wiring of the limit inputs of each module with an axis.
    wiring: Vec<(u8, [Wiring; 2])>,
    /// Whether the contact of the probe is held closed or open by hand. `None`: it is not held.
    held: Option<bool>,
    /// Modules whose end switches are held closed or open by hand.
    held_ends: BTreeMap<usize, bool>,
    /// Modules whose motors are blocked, and those whose encoders are silent.
    blocked: BTreeSet<usize>,
    silent: BTreeSet<usize>,
    #[cfg(test)]
    interruption: Option<(usize, u64)>,
    #[cfg(test)]
    question: Option<(u64, StopButton)>,
}

/// Adds a number to a set, or removes it.
fn set(numbers: &mut BTreeSet<usize>, number: usize, is_in: bool) {
    if is_in {
        numbers.insert(number);
    } else {
        numbers.remove(&number);
    }
}

impl SimulatedNetwork {
    /// Servo modules of these versions with the motors of the prototype. The first is at the far
    /// end.
    ///
    /// # Errors
    ///
    /// A contact of a module that does not exist.
    pub fn new(
        versions: &[u8],
        contacts: &[Contact],
        piece: Option<Mounted>,
    ) -> Result<Self, String> {
        let motor = DcMotorModel::PROTOTYPE;
        let servo = |&version| NetworkModule::Servo { version, motor };
        let modules: Vec<_> = versions.iter().map(servo).collect();
        Self::of_modules(&modules, contacts, piece)
    }

    /// The servo modules of a machine, of version 4, with its motors and the contacts of its probe.
    ///
    /// # Errors
    ///
    /// A contact of a module that does not exist.
    pub fn of_machine(
        machine: &Machine,
        contacts: &[Contact],
        piece: Option<Mounted>,
    ) -> Result<Self, String> {
        let servo = |module| NetworkModule::Servo {
            version: 4,
            motor: machine.motor(module),
        };
        let modules: Vec<_> = (1..=machine.modules()).map(servo).collect();
        let network = Self::of_modules(&modules, contacts, piece)?;
        let axes = machine.axes.iter();
        Ok(Self {
            wiring: axes.map(|axis| (axis.module, axis.limits)).collect(),
            ..network.with_switches(machine.probe.switches)
        })
    }

    /// Modules of any kind. The first is at the far end.
    ///
    /// # Errors
    ///
    /// The module of a contact does not exist, or has no motor.
    pub fn of_modules(
        modules: &[NetworkModule],
        contacts: &[Contact],
        piece: Option<Mounted>,
    ) -> Result<Self, String> {
        for Contact { module, .. } in contacts {
            match modules.get(usize::from(*module) - 1) {
                Some(NetworkModule::Servo { .. }) => {}
                Some(NetworkModule::Io { .. }) => {
                    return Err(format!("a contact at module {module}, which has no motor"));
                }
                None => {
                    let count = modules.len();
                    return Err(format!(
                        "a contact at module {module}, of {count} on the line"
                    ));
                }
            }
        }
        Ok(Self {
            network: ServoNetwork::of_modules(modules),
            inputs: vec![IoInputs::default(); modules.len()],
            contacts: contacts.to_vec(),
            piece,
            switches: Switches::One,
            ends: Vec::new(),
            wiring: Vec::new(),
            held: None,
            held_ends: BTreeMap::new(),
            blocked: BTreeSet::new(),
            silent: BTreeSet::new(),
            #[cfg(test)]
            interruption: None,
            #[cfg(test)]
            question: None,
        })
    }

    /// Sets the contacts of the probe. With one contact for each direction, a work piece and
    /// [`hold_probe`](Self::hold_probe) close the contact for the positive direction.
    #[must_use]
    pub fn with_switches(self, switches: Switches) -> Self {
        Self { switches, ..self }
    }

    /// Adds end switches. Each is described like a face: the high switch is closed from a count on,
    /// the low switch up to a count.
    ///
    /// # Errors
    ///
    /// The machine has no such end switch at this module.
    pub fn with_ends(mut self, ends: &[Contact]) -> Result<Self, String> {
        for switch in ends {
            let end = match switch.is_touched_upwards() {
                true => End::High,
                false => End::Low,
            };
            let mut axes = self.wiring.iter();
            let wired = axes.find(|(module, _)| *module == switch.module);
            let input = wired.and_then(|(_, limits)| {
                let mut inputs = limits.iter();
                inputs.position(|wiring| {
                    matches!(*wiring, Wiring::End(is) if is == end) || *wiring == Wiring::Ends
                })
            });
            let Some(input) = input else {
                let module = switch.module;
                return Err(format!(
                    "an end switch at module {module}: no axis of the machine has a {end} end \
                     switch there"
                ));
            };
            self.ends.push((*switch, input));
        }
        Ok(self)
    }

    /// Sets the time after a reset in which the modules receive nothing.
    #[must_use]
    pub fn with_reset_ms(self, reset_ms: u32) -> Self {
        Self {
            network: self.network.with_reset_ms(reset_ms),
            ..self
        }
    }

    /// Lets the transfer of a byte on the line take no time.
    #[must_use]
    pub fn without_byte_times(self) -> Self {
        Self {
            network: self.network.without_byte_times(),
            ..self
        }
    }

    /// Sets the rate of the host in bits/s. With `None` every module understands the host.
    pub fn set_host_rate(&mut self, bits_per_s: Option<u32>) {
        self.network.set_host_rate(bits_per_s);
    }

    /// Changes the external levels and readings of an input and output module. Returns `false` if
    /// there is no such module.
    pub fn connect(&mut self, module: usize, change: impl FnOnce(&mut IoInputs)) -> bool {
        let Some(place) = module.checked_sub(1) else {
            return false;
        };
        if self.network.outputs(place).is_none() {
            return false;
        }
        change(&mut self.inputs[place]);
        self.network.connect(place, self.inputs[place]);
        true
    }

    /// Levels of the outputs of an input and output module, and the duties of its PWM outputs.
    #[must_use]
    pub fn outputs(&self, module: usize) -> Option<(u16, [u8; 2])> {
        self.network.outputs(module.checked_sub(1)?)
    }

    /// Adds noise to the line. `bit_errors` is the share of wrong bits.
    #[must_use]
    pub fn with_noise(self, bit_errors: f64) -> Self {
        Self {
            network: self
                .network
                .with_noise(Noise::of_bits(bit_errors), NOISE_SEED),
            ..self
        }
    }

    /// Adds noise of any kind, with any seed.
    #[cfg(test)]
    pub fn with_faults(self, noise: Noise, seed: u64) -> Self {
        Self {
            network: self.network.with_noise(noise, seed),
            ..self
        }
    }

    /// The simulated modules.
    #[cfg(test)]
    pub fn servo_network(&mut self) -> &mut ServoNetwork {
        &mut self.network
    }

    /// Interrupts the supply of a module for half a second. The supply returns after `periods`,
    /// which is at least 1000.
    #[cfg(test)]
    pub fn interrupt(&mut self, module: usize, periods: u64) {
        self.interruption = Some((module, periods));
    }

    /// Presses the stop button after this number of periods.
    #[cfg(test)]
    pub fn ask_after(&mut self, periods: u64, button: StopButton) {
        self.question = Some((periods, button));
    }

    /// Holds the contact of the probe closed or open, whether or not it touches anything. `None`
    /// releases it.
    pub const fn hold_probe(&mut self, is_closed: Option<bool>) {
        self.held = is_closed;
    }

    /// Holds the end switches of a module closed or open, wherever the axis is. `None` releases
    /// them. Returns `false` if the module has none.
    pub fn hold_ends(&mut self, module: usize, is_closed: Option<bool>) -> bool {
        match is_closed {
            Some(is_closed) => self.held_ends.insert(module, is_closed),
            None => self.held_ends.remove(&module),
        };
        let mut ends = self.ends.iter();
        ends.any(|(switch, _)| usize::from(switch.module) == module)
    }

    /// Blocks the motor of a module, or releases it.
    pub fn block(&mut self, module: usize, is_blocked: bool) {
        set(&mut self.blocked, module, is_blocked);
    }

    /// Breaks the cable of the encoder of a module, or repairs it.
    pub fn silence(&mut self, module: usize, is_silent: bool) {
        set(&mut self.silent, module, is_silent);
    }

    /// The motor of a module. `None` if it has none.
    pub fn motor(&self, module: usize) -> Option<&DcMotor> {
        self.network.motor(module.checked_sub(1)?)
    }

    /// Switches the supply of all modules.
    pub fn set_power(&mut self, is_on: bool) {
        for module in 0..self.network.len() {
            self.network.set_dead(module, !is_on);
        }
    }

    /// Sends a byte to the modules.
    pub fn send(&mut self, byte: u8) {
        self.network.send(byte);
    }

    /// Number of bytes that have not arrived at the modules yet.
    pub fn on_the_line(&self) -> usize {
        self.network.waiting()
    }

    /// Simulates a servo period and returns the bytes that the modules send in it.
    pub fn tick(&mut self) -> Vec<u8> {
        #[cfg(test)]
        self.fail();
        // Whether faces that are touched in the positive direction are touched, and whether those
        // in the negative direction are.
        let mut closed = [false; 2];
        for contact in &self.contacts {
            let motor = self.network.motor(usize::from(contact.module - 1));
            let is_closed = contact.is_closed(motor.map_or(0, DcMotor::counts));
            closed[usize::from(!contact.is_touched_upwards())] |= is_closed;
        }
        let network = &self.network;
        closed[0] |= self
            .piece
            .as_mut()
            .is_some_and(|piece| piece.is_closed(network));
        let [positive, negative] = match self.held {
            Some(is_closed) => [is_closed, false],
            None => closed,
        };
        // The probe is wired to every module.
        let around = match self.switches {
            Switches::One => Surroundings {
                limit_1: positive || negative,
                ..Surroundings::default()
            },
            Switches::PerSense => Surroundings {
                limit_1: positive,
                limit_2: negative,
                ..Surroundings::default()
            },
        };
        for module in 0..self.network.len() {
            let mut around = around;
            around.is_blocked = self.blocked.contains(&(module + 1));
            around.encoder_is_silent = self.silent.contains(&(module + 1));
            for (switch, input) in &self.ends {
                if usize::from(switch.module) == module + 1 {
                    let motor = self.network.motor(module);
                    let held = self.held_ends.get(&(module + 1)).copied();
                    let is_closed = || switch.is_closed(motor.map_or(0, DcMotor::counts));
                    let is_closed = held.unwrap_or_else(is_closed);
                    match input {
                        0 => around.limit_1 |= is_closed,
                        _ => around.limit_2 |= is_closed,
                    }
                }
            }
            self.network.surround(module, around);
        }
        self.network.tick()
    }

    #[cfg(test)]
    fn fail(&mut self) {
        const OUTAGE: u64 = 1000;
        self.question = match self.question.take() {
            Some((0, button)) => {
                button.press();
                None
            }
            other => other.map(|(left, button)| (left - 1, button)),
        };
        self.interruption = match self.interruption.take() {
            Some((module, 0)) => {
                self.network.set_dead(module, false);
                None
            }
            Some((module, left)) => {
                if left == OUTAGE {
                    self.network.set_dead(module, true);
                }
                Some((module, left - 1))
            }
            None => None,
        };
    }
}
