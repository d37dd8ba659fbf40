//! A line of modules behind a port. It carries out the steps of the protocol one after another.

mod halt;

use super::machine::Machine;
use super::memory::MARK;
use super::operator::Operator;
use super::port::Port;
use crate::error::Error;
use husillo_transports::nmc::{
    Baud, Command, EVERY_GROUP, Group, Host, Items, Network, Next, Outcome, Progress, Reply,
    Startup, Step,
};
use std::fmt;

/// Addresses from here on are those of groups.
const FIRST_GROUP: u8 = 0x80;

/// The host's end of the line.
pub struct Line<P> {
    port: P,
    host: Host,
    /// Rate of the line.
    baud: Baud,
    operator: Box<dyn Operator>,
    /// Module and letter of each axis, for messages.
    letters: Vec<(u8, char)>,
}

impl<P: fmt::Debug> fmt::Debug for Line<P> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { port, host, .. } = self;
        let mut text = out.debug_struct("Line");
        text.field("port", port).field("host", host);
        text.finish_non_exhaustive()
    }
}

impl<P: Port> Line<P> {
    /// A line at a port, without an operator.
    pub fn new(port: P) -> Self {
        let host = Host::new(port.timing(Baud::default()));
        Self {
            port,
            host,
            baud: Baud::default(),
            operator: Box::new(()),
            letters: Vec::new(),
        }
    }

    /// Adds an operator to the line. While a stop that the operator has requested is not carried
    /// out, no step begins.
    #[must_use]
    pub fn with_operator(self, operator: impl Operator + 'static) -> Self {
        Self {
            operator: Box::new(operator),
            ..self
        }
    }

    /// Sets the letters of the axes of the modules, for messages.
    pub(super) fn name_axes(&mut self, machine: &Machine) {
        let axes = machine.axes.iter();
        self.letters = axes.map(|axis| (axis.module, axis.letter)).collect();
    }

    /// Returns the name of a module: `axis x (module 2)`.
    pub(super) fn name(&self, address: u8) -> String {
        if address >= FIRST_GROUP {
            return "the modules".into();
        }
        let mut letters = self.letters.iter();
        match letters.find(|(module, _)| *module == address) {
            Some((_, letter)) => format!("axis {letter} (module {address})"),
            None => format!("module {address}"),
        }
    }

    /// The operator of the machine.
    pub(crate) fn operator(&self) -> &dyn Operator {
        &*self.operator
    }

    #[cfg(test)]
    pub(super) fn port(&mut self) -> &mut P {
        &mut self.port
    }

    #[cfg(test)]
    pub(in crate::heads) fn into_port(self) -> P {
        self.port
    }

    /// Time since the port was opened, us.
    pub fn elapsed_us(&self) -> u64 {
        self.port.elapsed_us()
    }

    /// Starts the line: flush, reset, addresses, versions, baud rate. If no module answers, it
    /// repeats this with a reset of every address.
    ///
    /// # Errors
    ///
    /// The port fails, no module answers, or the answers are damaged.
    pub fn start_up(&mut self, baud: Baud) -> Result<Network, Error> {
        match self.start_by(baud, Startup::new(baud)) {
            // An earlier session may have put the modules into groups that the common reset does
            // not address.
            Err(Error::NoModules) => self.start_by(baud, Startup::new(baud).resetting_each()),
            other => other,
        }
    }

    fn start_by(&mut self, baud: Baud, mut startup: Startup) -> Result<Network, Error> {
        self.host.set_timing(self.port.timing(Baud::default()));
        let mut outcome = None;
        loop {
            match startup.next(outcome.as_ref()) {
                Next::Done(network) if !network.is_complete => return Err(Error::Doubtful),
                Next::Done(network) if network.modules == 0 => return Err(Error::NoModules),
                Next::Done(network) => {
                    self.host.set_timing(self.port.timing_of_known(baud));
                    return Ok(network);
                }
                Next::Step(step) => {
                    outcome = match self.step(step) {
                        Ok(outcome) => Some(outcome),
                        // A module does not have this rate: the start-up keeps the old one.
                        Err(Error::Refused(_)) => None,
                        Err(error) => return Err(error),
                    }
                }
            }
        }
    }

    /// The rate of the line.
    pub(super) const fn baud(&self) -> Baud {
        self.baud
    }

    /// Joins modules that an earlier session has set up, without a reset. The first of several
    /// modules leads their group. Nothing is sent to the modules.
    ///
    /// # Errors
    ///
    /// The port fails.
    pub(super) fn rejoin(&mut self, baud: Baud, modules: &[u8]) -> Result<(), Error> {
        self.step(Step::Switch(baud))?;
        self.step(Step::Flush)?;
        self.host.set_timing(self.port.timing_of_known(baud));
        for (place, address) in modules.iter().enumerate() {
            let group = Group {
                address: EVERY_GROUP,
                is_leader: place == 0 && modules.len() > 1,
            };
            self.host.adopt(*address, MARK, group);
        }
        Ok(())
    }

    /// Starts the line as [`start_up`](Self::start_up) does, and checks that these modules are
    /// there and drive motors.
    ///
    /// # Errors
    ///
    /// Those of [`start_up`](Self::start_up), fewer modules, or one of another kind.
    pub fn start_servos(
        &mut self,
        baud: Baud,
        modules: impl IntoIterator<Item = u8>,
    ) -> Result<Network, Error> {
        let network = self.start_up(baud)?;
        let wanted: Vec<u8> = modules.into_iter().collect();
        if let Some(last) = wanted.iter().max().filter(|last| **last > network.modules) {
            return Err(Error::NoModule {
                wanted: *last,
                modules: network.modules,
            });
        }
        for module in wanted {
            // Servo modules are of type 0, which also stands for an unknown one.
            let device = network.devices.get(usize::from(module).wrapping_sub(1));
            if let Some((kind @ 1.., _)) = device {
                return Err(Error::NotServo {
                    module,
                    kind: *kind,
                });
            }
        }
        Ok(network)
    }

    /// Sends a command to a module.
    ///
    /// # Errors
    ///
    /// The port or the link fails.
    pub fn command(&mut self, address: u8, command: Command) -> Result<Reply, Error> {
        self.answer(address, Step::Request { address, command })
    }

    /// Reads a standing axis until two readings agree. Positions may differ by `jitter_counts`.
    ///
    /// # Errors
    ///
    /// The port or the link fails.
    pub fn read_twice(
        &mut self,
        address: u8,
        items: Items,
        jitter_counts: u32,
    ) -> Result<Reply, Error> {
        let step = Step::ReadTwice {
            address,
            items,
            jitter_counts,
        };
        self.answer(address, step)
    }

    fn answer(&mut self, address: u8, step: Step) -> Result<Reply, Error> {
        match self.step(step)? {
            Outcome::Answered(reply) | Outcome::Confirmed(reply) => Ok(reply),
            Outcome::Sent => Ok(Reply::default()),
            Outcome::Failed(failure) => Err(Error::Link {
                module: self.name(address),
                failure,
            }),
        }
    }

    fn step(&mut self, step: Step) -> Result<Outcome, Error> {
        if self.operator.is_stop_wanted() {
            return Err(Error::Interrupted);
        }
        if let Step::Switch(baud) = step {
            self.port.set_baud(baud)?;
            self.host.set_timing(self.port.timing(baud));
            self.baud = baud;
        }
        self.host.start(step, self.now_us())?;
        loop {
            let now_us = self.now_us();
            let bytes: Vec<u8> = std::iter::from_fn(|| self.host.transmit(now_us)).collect();
            if !bytes.is_empty() {
                self.operator.sent(&bytes);
                self.port.send(&bytes)?;
            }
            match self.host.poll(self.now_us()) {
                Progress::Done(outcome) => return Ok(outcome),
                Progress::Waiting { us } => {
                    let bytes = self.port.receive(us)?;
                    if !bytes.is_empty() {
                        self.operator.received(&bytes);
                    }
                    let now_us = self.now_us();
                    bytes.iter().for_each(|byte| self.host.push(*byte, now_us));
                }
                Progress::Sending | Progress::Idle => {}
            }
        }
    }

    /// The time of the host, modulo 2^32.
    fn now_us(&self) -> u32 {
        self.port.elapsed_us() as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulated::{DcMotorModel, NetworkModule, SimulatedNetwork, SimulatedPort};

    /// A program may have left the modules with other addresses and in another group.
    #[test]
    fn a_module_of_another_kind_is_no_axis() {
        let servo = NetworkModule::Servo {
            version: 4,
            motor: DcMotorModel::PROTOTYPE,
        };
        let modules = [servo, NetworkModule::Io { version: 2 }];
        let started = |module| {
            let network = SimulatedNetwork::of_modules(&modules, &[], None).unwrap();
            Line::new(SimulatedPort::new(network)).start_servos(Baud::B19200, [module])
        };
        assert_eq!(started(1).unwrap().devices[1], (2, 2));
        let error = started(2).unwrap_err().to_string();
        assert_eq!(error, "module 2 is no servo module: it is of type 2");
        let error = started(3).unwrap_err().to_string();
        assert_eq!(error, "no answer of module 3: 2 on the line");
    }

    #[test]
    fn modules_in_other_groups_are_found() {
        let network = SimulatedNetwork::new(&[4; 2], &[], None).unwrap();
        let mut line = Line::new(SimulatedPort::new(network));
        assert_eq!(line.start_up(Baud::B19200).unwrap().modules, 2);
        let group = Group {
            address: 0x90,
            is_leader: false,
        };
        for (old, address) in [(1, 17), (2, 32)] {
            let moved = Command::SetAddress { address, group };
            let port = &mut line.port;
            port.send(moved.frame(old).bytes()).unwrap();
            port.receive(100_000).unwrap();
        }
        assert_eq!(line.start_up(Baud::B19200).unwrap().modules, 2);
        line.command(2, Command::NoOperation).unwrap();
    }

    #[test]
    fn a_line_without_modules_is_reported() {
        let network = SimulatedNetwork::new(&[], &[], None).unwrap();
        let mut line = Line::new(SimulatedPort::new(network));
        assert!(matches!(line.start_up(Baud::B19200), Err(Error::NoModules)));
    }
}
