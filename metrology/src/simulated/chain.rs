//! A simulated chain of modules with a work piece before their probes.

use super::contact::Contact;
use super::piece::Mounted;
#[cfg(test)]
use crate::heads::operator::StopButton;
use husillo_sim::{DcMotor, DcMotorModel, Noise, ServoChain, Surroundings};

/// A servo period in ns.
pub const PERIOD_NS: u64 = 512_000;

/// The same noise in every run.
const NOISE_SEED: u64 = 2026;

/// Modules, their motors and what they touch.
#[derive(Clone, Debug)]
pub struct SimulatedChain {
    chain: ServoChain,
    contacts: Vec<Contact>,
    piece: Option<Mounted>,
    /// The probe held closed, or open, by hand.
    held: Option<bool>,
    #[cfg(test)]
    interruption: Option<(usize, u64)>,
    #[cfg(test)]
    question: Option<(u64, StopButton)>,
}

impl SimulatedChain {
    /// Modules of these versions with the prototype's motors, the first at the far end.
    ///
    /// # Errors
    ///
    /// A contact of a module that there is not.
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

    /// With wrong bits on the line, this share of all.
    #[must_use]
    pub fn with_noise(self, bit_errors: f64) -> Self {
        Self {
            chain: self
                .chain
                .with_noise(Noise::of_bits(bit_errors), NOISE_SEED),
            ..self
        }
    }

    /// As [`with_noise`](Self::with_noise), of any kind and seed.
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

    /// Gives the supply of a module back after so many periods, 1000 at least; it goes away half a
    /// second before.
    #[cfg(test)]
    pub fn interrupt(&mut self, module: usize, periods: u64) {
        self.interruption = Some((module, periods));
    }

    /// Asks for a stop after so many periods.
    #[cfg(test)]
    pub fn ask_after(&mut self, periods: u64, button: StopButton) {
        self.question = Some((periods, button));
    }

    /// Holds the contact of the probe closed or open, whatever it touches; `None` lets go.
    pub const fn hold_probe(&mut self, is_closed: Option<bool>) {
        self.held = is_closed;
    }

    /// Switches the supply of all modules.
    pub fn set_power(&mut self, is_on: bool) {
        for module in 0..self.chain.len() {
            self.chain.set_dead(module, !is_on);
        }
    }

    /// Puts a byte on the command line.
    pub fn send(&mut self, byte: u8) {
        self.chain.send(byte);
    }

    /// A servo period: the bytes that the modules send in it.
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
