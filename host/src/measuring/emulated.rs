//! A simulated chain of modules with a work piece before their probes.

use super::contact::Contact;
use super::piece::Mounted;
use crate::emulate::emulation::Emulation;
use husillo_sim::{DcMotor, DcMotorModel, Noise, ServoChain, Surroundings};

/// A servo period in ns.
pub const PERIOD_NS: u64 = 512_000;

/// The same noise in every run.
const NOISE_SEED: u64 = 2026;

/// Modules, their motors and what they touch.
#[derive(Clone, Debug)]
pub struct Emulated {
    chain: ServoChain,
    contacts: Vec<Contact>,
    piece: Option<Mounted>,
    /// The probe held closed, or open, by hand.
    held: Option<bool>,
    #[cfg(test)]
    interruption: Option<(usize, u64)>,
    #[cfg(test)]
    question: Option<(u64, super::interrupt::Interrupt)>,
}

/// What may be typed at the panel.
#[cfg(unix)]
pub const PANEL: &str = "close probe, open probe, free probe, power off|on, unplug, plug";

impl Emulated {
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

    /// Gives the supply of a module back after so many periods, 1000 at least; it goes away half a second before.
    #[cfg(test)]
    pub fn interrupt(&mut self, module: usize, periods: u64) {
        self.interruption = Some((module, periods));
    }

    /// Ctrl-C after so many periods.
    #[cfg(test)]
    pub fn ask_after(&mut self, periods: u64, interrupt: super::interrupt::Interrupt) {
        self.question = Some((periods, interrupt));
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
            Some((0, interrupt)) => {
                interrupt.ask();
                None
            }
            other => other.map(|(left, interrupt)| (left - 1, interrupt)),
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

impl Emulation for Emulated {
    const PERIOD_NS: u64 = PERIOD_NS;

    fn send(&mut self, byte: u8) {
        Emulated::send(self, byte);
    }

    fn tick(&mut self) -> Vec<u8> {
        Emulated::tick(self)
    }

    #[cfg(unix)]
    fn control(&mut self, line: &str) -> String {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            [held @ ("close" | "open" | "free"), "probe"] => {
                self.held = match held {
                    "close" => Some(true),
                    "open" => Some(false),
                    _ => None,
                };
                format!("probe: {held}")
            }
            ["power", power @ ("off" | "on")] => {
                for module in 0..self.chain.len() {
                    self.chain.set_dead(module, power == "off");
                }
                format!("power is {power}")
            }
            _ => format!("there are {PANEL}"),
        }
    }
}

/// Versions of a list such as `servo:4,servo:4`, from the far end.
///
/// # Errors
///
/// A sentence about the list.
pub fn versions(list: &str) -> Result<Vec<u8>, String> {
    let version = |module: &str| match module {
        "servo" | "servo:4" => Some(4),
        "servo:5" => Some(5),
        "servo:10" => Some(10),
        _ => None,
    };
    let versions: Option<Vec<u8>> = list.split(',').map(version).collect();
    let versions = versions.ok_or_else(|| {
        format!("`{list}`: expected servo:4, servo:5 or servo:10, with commas between")
    })?;
    if versions.len() > usize::from(husillo_transports::nmc::LAST_ADDRESS) {
        return Err(format!("{} modules: a line has 32 at most", versions.len()));
    }
    Ok(versions)
}
