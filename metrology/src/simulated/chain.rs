//! A simulated chain of modules with a work piece before its probe.

use super::contact::Contact;
use super::piece::Mounted;
#[cfg(test)]
use crate::heads::operator::StopButton;
use husillo_sim::{DcMotor, DcMotorModel, Noise, ServoChain, Surroundings};

/// Servo period, ns.
pub const PERIOD_NS: u64 = 512_000;

/// Seed of the noise, the same in every run.
const NOISE_SEED: u64 = 2026;

/// Modules, their motors, and the faces and the work piece before the probe.
#[derive(Clone, Debug)]
pub struct SimulatedChain {
    chain: ServoChain,
    contacts: Vec<Contact>,
    piece: Option<Mounted>,
    /// The contact of the probe is held closed or open by hand.
    held: Option<bool>,
    #[cfg(test)]
    interruption: Option<(usize, u64)>,
    #[cfg(test)]
    question: Option<(u64, StopButton)>,
}

impl SimulatedChain {
    /// Modules of these versions with the motors of the prototype. The first is at the far end.
    ///
    /// # Errors
    ///
    /// A contact of a module that does not exist.
    pub fn new(
        versions: &[u8],
        contacts: &[Contact],
        piece: Option<Mounted>,
    ) -> Result<Self, String> {
        if let Some(contact) = contacts
            .iter()
            .find(|contact| usize::from(contact.module) > versions.len())
        {
            return Err(format!(
                "a contact at module {}, of {} on the line",
                contact.module,
                versions.len()
            ));
        }
        Ok(Self {
            chain: ServoChain::new(versions, DcMotorModel::PROTOTYPE),
            contacts: contacts.to_vec(),
            piece,
            held: None,
            #[cfg(test)]
            interruption: None,
            #[cfg(test)]
            question: None,
        })
    }

    /// The same chain with noise: `bit_errors` is the share of wrong bits on the line.
    #[must_use]
    pub fn with_noise(self, bit_errors: f64) -> Self {
        Self {
            chain: self
                .chain
                .with_noise(Noise::of_bits(bit_errors), NOISE_SEED),
            ..self
        }
    }

    /// As [`with_noise`](Self::with_noise), with noise of any kind and any seed.
    #[cfg(test)]
    pub fn with_faults(self, noise: Noise, seed: u64) -> Self {
        Self {
            chain: self.chain.with_noise(noise, seed),
            ..self
        }
    }

    /// The simulated modules.
    #[cfg(test)]
    pub fn chain(&mut self) -> &mut ServoChain {
        &mut self.chain
    }

    /// Interrupts the supply of a module for half a second. The supply returns after `periods`,
    /// which is at least 1000.
    #[cfg(test)]
    pub fn interrupt(&mut self, module: usize, periods: u64) {
        self.interruption = Some((module, periods));
    }

    /// Presses the button after this number of periods.
    #[cfg(test)]
    pub fn ask_after(&mut self, periods: u64, button: StopButton) {
        self.question = Some((periods, button));
    }

    /// Holds the contact of the probe closed or open, whatever it touches. `None` releases it.
    pub const fn hold_probe(&mut self, is_closed: Option<bool>) {
        self.held = is_closed;
    }

    /// Switches the supply of all modules.
    pub fn set_power(&mut self, is_on: bool) {
        for module in 0..self.chain.len() {
            self.chain.set_dead(module, !is_on);
        }
    }

    /// Sends a byte to the modules.
    pub fn send(&mut self, byte: u8) {
        self.chain.send(byte);
    }

    /// Simulates a servo period and returns the bytes that the modules send in it.
    pub fn tick(&mut self) -> Vec<u8> {
        #[cfg(test)]
        self.fail();
        let is_closed = self.contacts.iter().any(|contact| {
            let motor = self.chain.motor(usize::from(contact.module - 1));
            contact.is_closed(motor.map_or(0, DcMotor::counts))
        });
        let chain = &self.chain;
        let is_closed = is_closed
            || self
                .piece
                .as_mut()
                .is_some_and(|piece| piece.is_closed(chain));
        // The probe is wired to limit 1 of every module.
        let around = Surroundings {
            limit_1: self.held.unwrap_or(is_closed),
            ..Surroundings::default()
        };
        for module in 0..self.chain.len() {
            self.chain.surround(module, around);
        }
        self.chain.tick()
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
                self.chain.set_dead(module, false);
                None
            }
            Some((module, left)) => {
                if left == OUTAGE {
                    self.chain.set_dead(module, true);
                }
                Some((module, left - 1))
            }
            None => None,
        };
    }
}
