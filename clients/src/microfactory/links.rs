//! The machines that a command names, each behind its port.

use super::action::Action;
use super::client::Client;
use super::crew::Worker;
use super::settings::Settings;
use crate::{StopRequests, Wire};
use husillo_sim::device::microfactory::Device;

/// How machines are reached.
#[derive(Debug)]
pub struct Links<'a> {
    /// The machines, which are all alike.
    pub settings: &'a Settings,
    /// Rate of the serial lines, bits/s.
    pub bits_per_s: u32,
    /// Whether the machines answer. The original does not.
    pub answers: bool,
    /// The figure that simulated machines start with.
    pub figure: &'a [[i16; 2]],
    /// A motion ends this long after the last byte of this program, in units of 10 ms. With 0 a
    /// motion needs no host.
    pub lease: u8,
    /// Requests to stop all machines.
    pub stop: StopRequests,
}

impl Links<'_> {
    /// A client of a machine of the controller at a port.
    fn open(&self, place: &Place<'_>) -> Result<Client, String> {
        let port = place.port;
        let wire = if place.is_simulated() {
            let machines = if place.machine.is_some() { 2 } else { 1 };
            let device = Device::new(
                self.settings.config,
                self.settings.table,
                self.settings.pull_out_ticks,
                self.figure,
                self.answers,
                self.bits_per_s,
                machines,
            )?;
            Wire::simulated(device)
        } else {
            Wire::open(port, self.bits_per_s).map_err(|error| format!("{port}: {error}"))?
        };
        let client = Client::new(wire, self.settings.table, self.answers, self.stop.clone());
        let client = client
            .with_lease(self.lease)
            .with_steps(self.settings.steps);
        Ok(client.of_machine(place.number()))
    }

    /// Opens a machine for each port, each with its share of the actions. A port is `sim`, a serial
    /// device or `tcp:HOST:PORT`. After it, `#1` or `#2` names a machine of a controller of two.
    /// Two machines of one controller share its link.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the port that cannot be opened, or is named twice.
    pub fn crew(&self, ports: &[String], shares: Vec<Vec<Action>>) -> Result<Vec<Worker>, String> {
        let places = ports.iter().map(|port| Place::parse(port));
        let places = places.collect::<Result<Vec<_>, _>>()?;
        let mut crew: Vec<Worker> = Vec::new();
        for ((place, port), actions) in places.iter().zip(ports).zip(shares) {
            let before = &places[..crew.len()];
            if before.iter().any(|other| other.is_same_machine(place)) {
                return Err(format!("{port}: this machine is named twice"));
            }
            let shared = before.iter().position(|other| other.is_same_link(place));
            let client = match shared.and_then(|number| crew.get_mut(number)) {
                Some(Worker { client, .. }) => client
                    .beside(place.number())
                    .map_err(|error| format!("{port}: {error}"))?,
                None => self.open(place)?,
            };
            crew.push(Worker {
                port: port.clone(),
                client,
                actions,
            });
        }
        Ok(crew)
    }
}

/// A machine: a port, or a port with a number as in `/dev/ttyUSB0#2`.
struct Place<'a> {
    port: &'a str,
    /// The machine of a controller of two: 0 or 1.
    machine: Option<u8>,
}

impl<'a> Place<'a> {
    fn parse(text: &'a str) -> Result<Self, String> {
        let (port, machine) = match text.rsplit_once('#') {
            Some((port, "1")) => (port, Some(0)),
            Some((port, "2")) => (port, Some(1)),
            Some((port, number)) => {
                return Err(format!(
                    "{port}: machine {number}: a controller drives one or two, as in PORT#2"
                ));
            }
            None => (text, None),
        };
        Ok(Self { port, machine })
    }

    fn number(&self) -> u8 {
        self.machine.unwrap_or(0)
    }

    /// Whether the machine is simulated. Each simulated machine is a device of its own.
    fn is_simulated(&self) -> bool {
        self.port == "sim"
    }

    fn is_same_link(&self, other: &Self) -> bool {
        self.port == other.port && !self.is_simulated()
    }

    fn is_same_machine(&self, other: &Self) -> bool {
        self.is_same_link(other) && self.number() == other.number()
    }
}
