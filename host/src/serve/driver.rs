//! The driver of a machine: a thread that owns the link to its controller.
//!
//! Each turn it carries out requests, receives for 20 ms at most, and publishes the state if it has
//! changed. Each [`Family`] has its own [`Drive`]. This module keeps it going: a lost controller is
//! tried again.

mod course;
mod drill;
mod grbl;
mod measuring;
mod microfactory;
mod micromill;
mod phase;

use super::console_lines::From;
use super::family::{Family, MeasuringMachine};
use super::machine::{Asked, EMERGENCY_WAITS, Machine};
use super::machine_state::{Link, MachineState};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// Shortest interval between two published states, so that none of 60 a second is left out.
const PUBLISH: Duration = Duration::from_millis(12);
/// A lost controller is tried again after this time.
const RETRY: Duration = Duration::from_secs(1);
/// Interval of the states of a lost controller.
const LOOK: Duration = Duration::from_millis(100);
/// Lines that wait for the controller.
const WAITING: usize = 64;

/// Where a controller is.
#[derive(Debug)]
pub struct Port {
    /// `sim`, a serial device, or `tcp:HOST:PORT`.
    pub name: String,
    /// Bits per second of a serial device.
    pub baud: u32,
    /// The speed of a simulated controller, in real time.
    pub speed: f64,
}

/// What a driver works with.
struct Desk<'a> {
    machine: &'a Machine,
    state: &'a mut MachineState,
    requests: &'a Receiver<Asked>,
}

/// Drives the controllers of a family. It keeps what outlasts the loss of a controller.
trait Drive {
    /// Connects, and drives until the program ends.
    ///
    /// # Errors
    ///
    /// The controller cannot be reached, or is lost: a sentence.
    fn drive(&mut self, port: &Port, desk: Desk<'_>) -> Result<(), String>;
}

/// Starts the driver of a machine. It runs until [`Machine::end`].
pub fn start(machine: Arc<Machine>, family: Family, port: Port, requests: Receiver<Asked>) {
    std::thread::spawn(move || match family {
        Family::Grbl(settings) => keep(&machine, &port, &requests, grbl::Grbl::new(*settings)),
        Family::Measuring(measuring) => {
            let MeasuringMachine {
                name,
                machine: file,
                network,
            } = *measuring;
            let drive = measuring::Measuring::new(name, file, network);
            keep(&machine, &port, &requests, drive);
        }
        Family::Drill => keep(&machine, &port, &requests, drill::Drill::default()),
        Family::Microfactory(factory) => {
            let drive = microfactory::Microfactory::new(factory);
            keep(&machine, &port, &requests, drive);
        }
        Family::Micromill { file, config } => {
            keep(
                &machine,
                &port,
                &requests,
                micromill::Mill::new(file, *config),
            );
        }
    });
}

/// Drives a machine, and tries again when its controller is lost.
fn keep(machine: &Machine, port: &Port, requests: &Receiver<Asked>, mut drive: impl Drive) {
    let mut state = MachineState::default();
    publish(machine, &state);
    while !machine.is_ending() {
        let desk = Desk {
            machine,
            state: &mut state,
            requests,
        };
        let Err(why) = drive.drive(port, desk) else {
            break;
        };
        if state.why.as_deref() != Some(&why) {
            machine.tell(From::Server, why.as_str());
        }
        state.lost(&why);
        wait(machine, &mut state, requests);
    }
    machine.set_ended();
}

/// Publishes that the controller is lost, and refuses requests until the next try.
fn wait(machine: &Machine, state: &mut MachineState, requests: &Receiver<Asked>) {
    let end = Instant::now() + RETRY;
    while let Some(left) = end.checked_duration_since(Instant::now()) {
        shared(machine, state);
        publish(machine, state);
        machine.emergency_waits(EMERGENCY_WAITS);
        if machine.is_ending() {
            return;
        }
        if let Ok(asked) = requests.recv_timeout(left.min(LOOK)) {
            asked.reply.error("the controller is lost");
        }
    }
}

/// What pages have changed.
fn shared(machine: &Machine, state: &mut MachineState) {
    state.operator = machine.control.operator();
    state.clients = machine.clients();
    state.emergency_waits = machine.is_emergency_asked();
}

fn publish(machine: &Machine, state: &MachineState) {
    machine.set_up(state.link == Link::Up);
    machine.publish(|number| state.frame(machine.number, machine.family, number));
}

/// The states that a driver has published.
#[derive(Debug)]
struct Published {
    last: Option<MachineState>,
    at: Instant,
}

impl Published {
    fn new() -> Self {
        Self {
            last: None,
            at: Instant::now(),
        }
    }

    /// Publishes a state if it has changed, and not too often.
    fn update(&mut self, machine: &Machine, state: &mut MachineState) {
        shared(machine, state);
        if self.at.elapsed() >= PUBLISH && self.last.as_ref() != Some(state) {
            self.at = Instant::now();
            self.last = Some(state.clone());
            publish(machine, state);
        }
    }
}
