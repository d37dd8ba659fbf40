//! The desktop microfactory: `husillo jog`, `husillo send` and `husillo emulate microfactory`.
//!
//! ```text
//! actions, figures ─► crew ─┬► client ─► wire ─┬─► device           simulated time
//!                           ├► client ...      └─► serial, socket   real time
//!                           └► client ...              └─► device ◄─ terminal
//! ```

mod action;
mod client;
mod crew;
mod device;
mod figure;
mod settings;
#[cfg(test)]
mod tests;

pub use figure::{is_list, program};
pub use settings::Settings;

use crate::cli::Jog;
use crate::link::wire::Wire;
use action::Action;
use client::Client;
use crew::Worker;
use device::Device;
use figure::Figure;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Bits a second of the link.
const BAUD: u32 = 9600;
/// The figure of a device without another one: the original's square with its diagonal, 1000 steps
/// wide.
const FIGURE: [[i16; 2]; 5] = [[1000, 0], [0, 1000], [-1000, 0], [0, -1000], [1000, 1000]];

/// How machines are reached.
struct Links<'a> {
    settings: &'a Settings,
    baud: u32,
    answers: bool,
    /// The figure of simulated devices.
    figure: Option<&'a str>,
    stop: Arc<AtomicBool>,
}

impl Links<'_> {
    /// A client of a machine of the controller at a port.
    fn open(&self, place: &Place<'_>) -> Result<Client, String> {
        let port = place.port;
        let wire = if place.is_simulated() {
            let figure = figure_of(self.figure, self.settings)?;
            let machines = if place.machine.is_some() { 2 } else { 1 };
            let device = Device::new(self.settings, &figure, self.answers, self.baud, machines)?;
            Wire::simulated(device)
        } else {
            Wire::open(port, self.baud).map_err(|error| format!("{port}: {error}"))?
        };
        let client = Client::new(
            wire,
            self.settings.table,
            self.answers,
            Arc::clone(&self.stop),
        );
        Ok(client.of_machine(place.number()))
    }

    /// A machine per port, with its share of the actions. Two machines of one controller share its
    /// link.
    fn crew(&self, ports: &[String], shares: Vec<Vec<Action>>) -> Result<Vec<Worker>, String> {
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

/// A machine: a port, or a number behind it as in `/dev/ttyUSB0#2`.
struct Place<'a> {
    port: &'a str,
    /// Of a controller of two: 0 or 1.
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

    /// Each of these is a device of its own.
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

/// `husillo jog`: carries out the actions one after the other, on every machine at once.
///
/// # Errors
///
/// A sentence about the actions, before anything moves.
pub fn jog(args: &Jog, settings: &Settings, out: &mut dyn Write) -> Result<bool, String> {
    let load = |file: &str| Figure::load(file, settings);
    let shares = action::shares(&args.actions, args.port.len(), load)?;
    let links = Links {
        settings,
        baud: args.baud.unwrap_or(BAUD),
        answers: !args.without_answers,
        figure: args.figure.as_deref(),
        stop: crate::link::stop::stop_flag()?,
    };
    let shares = crew::work(links.crew(&args.port, shares)?, out)?;
    if shares.len() > 1 {
        crew::report(&shares, out).map_err(|error| error.to_string())?;
    }
    Ok(crew::is_well(&shares))
}

/// `husillo send`: stores a figure in every machine and cuts it, all at once.
///
/// # Errors
///
/// A sentence about the figures or the ports, before anything moves.
pub fn send(
    args: &crate::cli::Send,
    settings: &Settings,
    out: &mut dyn Write,
) -> Result<bool, String> {
    let (files, ports) = (&args.files, &args.port);
    if files.len() != 1 && files.len() != ports.len() {
        return Err(format!(
            "{} figures for {} machines: one for all, or one for each --port",
            files.len(),
            ports.len()
        ));
    }
    let share = |file: &String| {
        let home = (!args.no_home).then_some(Action::Home);
        let figure = Figure::load(file, settings)?;
        Ok(home
            .into_iter()
            .chain([Action::Load(figure), Action::Figure])
            .collect::<Vec<_>>())
    };
    let mut shares = files
        .iter()
        .map(share)
        .collect::<Result<Vec<_>, String>>()?;
    if let [one] = &shares[..] {
        shares = vec![one.clone(); ports.len()];
    }
    let links = Links {
        settings,
        baud: args.baud.unwrap_or(BAUD),
        answers: !args.without_answers,
        figure: None,
        stop: crate::link::stop::stop_flag()?,
    };
    let shares = crew::work(links.crew(ports, shares)?, out)?;
    crew::report(&shares, out).map_err(|error| error.to_string())?;
    Ok(crew::is_well(&shares))
}

/// `husillo compile -m microfactory`: a figure as a list, which can be edited.
///
/// # Errors
///
/// A sentence about the figure.
pub fn list(file: &str, settings: &Settings) -> Result<String, String> {
    Ok(Figure::load(file, settings)?.text())
}

fn figure_of(file: Option<&str>, settings: &Settings) -> Result<Vec<[i16; 2]>, String> {
    file.map_or_else(
        || Ok(FIGURE.to_vec()),
        |file| Ok(Figure::load(file, settings)?.moves),
    )
}

/// `husillo emulate microfactory`; what it makes goes to `steps`, where there is that.
///
/// # Errors
///
/// The figure, the port, the file of steps or `out`, named in the error.
#[cfg(unix)]
pub fn emulate(
    args: &crate::cli::Emulate,
    settings: &Settings,
    steps: Option<Box<dyn Write>>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let figure = figure_of(args.figure.as_deref(), settings).map_err(io::Error::other)?;
    let baud = args.baud.unwrap_or(BAUD);
    let device = Device::new(settings, &figure, !args.faithful, baud, args.machines);
    let mut device = device.map_err(io::Error::other)?;
    if steps.is_some() {
        device = device.with_rows();
    }
    let hint = "husillo jog --port {port} home";
    crate::emulate::terminal::serve(
        &mut device,
        args,
        steps,
        out,
        ["Microfactory", hint, &Device::panel()],
    )
}
