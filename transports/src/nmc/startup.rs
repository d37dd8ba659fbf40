//! From power-up to a network whose modules have addresses.

use super::{
    Baud, Command, EVERY_GROUP, Failure, Group, Items, LAST_ADDRESS, Outcome, Reply, Step,
};

/// How often the line is reset and addressed again if an address is in doubt.
const RESTARTS: u8 = 3;

/// The modules that a start-up has found on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Network {
    /// Number of modules. They have the addresses from 1 on. Address 1 is the far end.
    pub modules: u8,
    /// Kind and version of each module, the first at index 0. (0, 0) if it did not report them.
    pub devices: [(u8, u8); LAST_ADDRESS as usize],
    /// Bit i is set if address i + 1 did not answer at the end, because it missed the change of the
    /// rate or is dead.
    pub silent: u32,
    /// Whether the line was silent after the last module. If not, an address is in doubt because of
    /// noise, or because two modules answer.
    pub is_complete: bool,
}

impl Network {
    const EMPTY: Network = Network {
        modules: 0,
        devices: [(0, 0); LAST_ADDRESS as usize],
        silent: 0,
        is_complete: true,
    };
}

/// The next action of a [`Startup`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Next {
    /// The [`Host`](super::Host) carries out this step. Its outcome is the argument of the next
    /// call.
    Step(Step),
    /// The start-up has ended.
    Done(Network),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Flush,
    Reset,
    ResetEach(u8),
    Settle,
    Address(u8),
    Identify(u8),
    SetBaud,
    Switch,
    Greet(u8),
    Done,
    /// No module answered. Every other rate is set in turn, with a flush and a reset.
    Search(u8, Sweep),
    Return,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sweep {
    Switch,
    Flush,
    Reset,
}

/// The order in which every client starts the line: flush; hard reset; addresses from the far end
/// until no module answers; kind and version of each module; the rate; a greeting of each module.
///
/// If no module answers, the modules may still have another rate from an earlier session. The
/// start-up then tries all rates once.
///
/// # Examples
/// ```
/// use husillo_transports::nmc::{Baud, Next, Startup, Step};
///
/// let mut startup = Startup::new(Baud::B115200);
/// assert_eq!(startup.next(None), Next::Step(Step::Flush));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Startup {
    baud: Baud,
    phase: Phase,
    resets_each: bool,
    has_searched: bool,
    restarts: u8,
    network: Network,
}

impl Startup {
    /// Creates a start-up of a line that ends at this rate.
    pub const fn new(baud: Baud) -> Startup {
        Startup {
            baud,
            phase: Phase::Flush,
            resets_each: false,
            has_searched: false,
            restarts: RESTARTS,
            network: Network::EMPTY,
        }
    }

    /// Also resets every individual address, the last one first. This takes 32 times
    /// [`Timing::reset_us`](super::Timing::reset_us) more. After a reset, all modules behind the
    /// reset one receive nothing. A module that an earlier session left in a group other than 0xFF
    /// does not receive the reset of all modules. It keeps its address, and another module may get
    /// the same one.
    #[must_use]
    pub const fn resetting_each(mut self) -> Startup {
        self.resets_each = true;
        self
    }

    /// Returns the next action after the outcome of the previous one. `None` is for the first call,
    /// and for a step that the host refused.
    pub fn next(&mut self, outcome: Option<&Outcome>) -> Next {
        self.phase = self.after(outcome);
        match self.phase {
            Phase::Done => Next::Done(self.network),
            phase => Next::Step(self.step(phase)),
        }
    }

    /// Returns the phase that follows the outcome of the present one.
    fn after(&mut self, outcome: Option<&Outcome>) -> Phase {
        let reply = outcome.and_then(Outcome::reply);
        match self.phase {
            Phase::Flush if outcome.is_none() => Phase::Flush,
            Phase::Flush => Phase::Reset,
            Phase::Reset if self.resets_each => Phase::ResetEach(LAST_ADDRESS),
            Phase::ResetEach(address) if address > 1 => Phase::ResetEach(address.saturating_sub(1)),
            Phase::Reset | Phase::ResetEach(_) => Phase::Settle,
            Phase::Settle => Phase::Address(1),
            Phase::Address(address) if reply.is_some() => {
                self.network.modules = address;
                if address < LAST_ADDRESS {
                    Phase::Address(address + 1) // below 32
                } else {
                    Phase::Identify(1)
                }
            }
            // If an address is in doubt, the next module must not get the same one. Therefore the
            // start-up begins again.
            Phase::Address(_) if outcome != Some(&Outcome::Failed(Failure::Silent)) => {
                if self.restarts > 0 {
                    self.restarts = self.restarts.saturating_sub(1);
                    self.network = Network::EMPTY;
                    return Phase::Flush;
                }
                self.network.is_complete = false;
                if self.network.modules > 0 {
                    Phase::Identify(1)
                } else {
                    Phase::Done
                }
            }
            Phase::Address(1) if !self.has_searched => {
                self.has_searched = true;
                Phase::Search(0, Sweep::Switch)
            }
            Phase::Address(1) => Phase::Done,
            Phase::Address(_) => Phase::Identify(1),
            Phase::Identify(address) => {
                if let Some(reply) = reply {
                    self.identify(address, reply);
                }
                if address < self.network.modules {
                    Phase::Identify(address + 1) // below 32
                } else if self.baud == Baud::B19200 {
                    Phase::Greet(1)
                } else {
                    Phase::SetBaud
                }
            }
            Phase::SetBaud if outcome.is_none() => {
                self.baud = Baud::B19200; // some module does not support the rate
                Phase::Greet(1)
            }
            Phase::SetBaud => Phase::Switch,
            Phase::Switch => Phase::Greet(1),
            Phase::Greet(address) => {
                if reply.is_none() {
                    let bit = u32::from(address.saturating_sub(1));
                    self.network.silent |= 1_u32.wrapping_shl(bit); // below 32
                }
                if address < self.network.modules {
                    Phase::Greet(address + 1) // below 32
                } else {
                    Phase::Done
                }
            }
            Phase::Done => Phase::Done,
            Phase::Search(rate, Sweep::Switch) => Phase::Search(rate, Sweep::Flush),
            Phase::Search(rate, Sweep::Flush) => Phase::Search(rate, Sweep::Reset),
            Phase::Search(rate, Sweep::Reset) => {
                let next = rate.saturating_add(1);
                if rate_of(next).is_some() {
                    Phase::Search(next, Sweep::Switch)
                } else {
                    Phase::Return
                }
            }
            Phase::Return => Phase::Flush,
        }
    }

    /// Stores the kind and version that a module has reported.
    fn identify(&mut self, address: u8, reply: &Reply) {
        let devices = self.network.devices.iter_mut();
        if let Some((device, _)) = devices.zip(1_u8..).find(|(_, of)| *of == address) {
            *device = (reply.readings.kind, reply.readings.version);
        }
    }

    fn step(&self, phase: Phase) -> Step {
        let everyone = |command| Step::Request {
            address: EVERY_GROUP,
            command,
        };
        match phase {
            Phase::Flush | Phase::Settle | Phase::Search(_, Sweep::Flush) | Phase::Done => {
                Step::Flush
            }
            Phase::Reset | Phase::Search(_, Sweep::Reset) => everyone(Command::HardReset(None)),
            Phase::ResetEach(address) => Step::Request {
                address,
                command: Command::HardReset(None),
            },
            Phase::Address(address) => Step::Request {
                address: 0,
                command: Command::SetAddress {
                    address,
                    group: Group::NONE,
                },
            },
            Phase::Identify(address) => Step::Request {
                address,
                command: Command::ReadStatus(Items::DEVICE),
            },
            Phase::SetBaud => everyone(Command::SetBaud(self.baud)),
            Phase::Switch => Step::Switch(self.baud),
            Phase::Greet(address) => Step::Request {
                address,
                command: Command::NoOperation,
            },
            Phase::Search(rate, Sweep::Switch) => Step::Switch(rate_of(rate).unwrap_or_default()),
            Phase::Return => Step::Switch(Baud::B19200),
        }
    }
}

/// Returns the rate with this number in the search.
fn rate_of(number: u8) -> Option<Baud> {
    match number {
        0 => Some(Baud::B115200),
        1 => Some(Baud::B57600),
        2 => Some(Baud::B9600),
        3 => Some(Baud::B230400),
        _ => None,
    }
}
