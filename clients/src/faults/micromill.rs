//! The micro mill with its faults.

use super::{Bench, Fault, State, Subject};
use crate::micromill::{Action, BAUD, Frame, Hand, LEASE_MS, LengthUnit, Sender, Sending, Session};
use crate::{ByHand as _, StopRequests, Wire};
use husillo_controllers::MicromillConfig;
use husillo_sim::device::micromill::Device;
use husillo_transports::micromill::{Axis, Line, Point};
use std::time::Duration;

/// Longest motion after the host is silent, ms: a lease, and the time of a byte.
const SILENT_MS: u64 = 260;
/// The steps of a short move.
const SHORT: i32 = 40;

/// The client that a state needs.
enum Client {
    Hand(Box<Hand>),
    Sender(Box<Sender>),
}

pub struct Micromill {
    client: Client,
    /// Position of the simulated tool at machine zero.
    zero: [i32; 3],
}

fn hand(device: Device) -> Result<Hand, String> {
    let (wire, stop) = (Wire::simulated(device), StopRequests::default());
    let frame = Frame {
        config: MicromillConfig::MICROMILL.machine,
        unit: LengthUnit::Millimetres,
    };
    Hand::new(wire, BAUD, LEASE_MS, frame, stop)
}

impl Micromill {
    fn session(&mut self) -> &mut Session {
        match &mut self.client {
            Client::Hand(hand) => hand.session(),
            Client::Sender(sender) => sender.session(),
        }
    }

    fn device(&mut self) -> &mut Device {
        self.session().device()
    }

    fn take_device(&mut self) -> Device {
        std::mem::replace(self.device(), Device::new(BAUD))
    }
}

/// Sends a program of one long line.
fn program(sender: &mut Sender) -> Result<String, String> {
    drop(sender.begin()?);
    let to = Point::Xy([Some(200_000), None]);
    let lines = [Line::Rapid(to)];
    for (number, line) in (1..).zip(&lines) {
        sender.send(number, line, |_, _| true)?;
    }
    Ok("done".into())
}

impl Subject for Micromill {
    const MACHINE: &'static str = "Micro mill";
    const STATES: &'static [(State, u64)] = &[
        (State::Idle, 0),
        (State::FirstHoming, 500),
        (State::Homing, 500),
        (State::Jog, 900),
        (State::Program, 3000),
    ];
    const FAULTS: &'static [Fault] = &[
        Fault::new("host killed, cable pulled", "unplug", &["plug"]).ends_within(SILENT_MS),
        Fault::new("controller reset", "reset", &["where"]).ends_within(0),
        Fault::new("power lost", "power off", &["power on"]).ends_within(0),
        Fault::new("home switch stuck open", "open x", &["free x"]),
        Fault::new("home switch stuck closed", "close x", &["free x"]).unnoticed(),
        Fault::new("motor stalled", "block x", &["unblock x"]).unnoticed(),
    ];

    fn new(state: State) -> Self {
        let mut homed = hand(Device::new(BAUD).with_rows()).unwrap();
        homed.carry_out(&Action::Home).unwrap();
        let zero = homed.session().device().rig(0).unwrap().place();
        let hand = match state {
            State::FirstHoming => hand(Device::new(BAUD).with_rows()).unwrap(),
            _ => homed,
        };
        let mut machine = Self {
            client: Client::Hand(Box::new(hand)),
            zero,
        };
        if state == State::Program {
            let wire = Wire::simulated(machine.take_device());
            let sending = Sending {
                bits_per_s: BAUD,
                lease_ms: LEASE_MS,
                streams: false,
                every: 1,
                homes: false,
            };
            let sender = Sender::new(wire, sending, StopRequests::default()).unwrap();
            machine.client = Client::Sender(Box::new(sender));
        }
        machine
    }

    fn bench(&mut self) -> &mut dyn Bench {
        self.device()
    }

    fn act(&mut self, state: State) -> Result<String, String> {
        let action = match state {
            State::FirstHoming | State::Homing => Action::Home,
            State::Jog => Action::Run(Axis::X, 200, Duration::from_secs(2)),
            State::Idle | State::Program | State::Guarded | State::Probing => {
                Action::Steps(Axis::X, SHORT)
            }
        };
        match &mut self.client {
            Client::Hand(hand) => hand.carry_out(&action),
            Client::Sender(sender) => program(sender),
        }
    }

    fn is_true(&mut self) -> bool {
        let state = match &mut self.client {
            Client::Hand(hand) => hand.state(),
            Client::Sender(sender) => sender.session().state().ok().flatten(),
        };
        // Otherwise it reports that it does not know its position.
        state.filter(|state| state.is_homed).is_none_or(|state| {
            let tool = self.device().rig(0).unwrap().place();
            let load = state.axes.map(|axis| axis.load_steps);
            (0..3).all(|axis| tool[axis] - self.zero[axis] == load[axis])
        })
    }

    fn begin_again(mut self) -> Result<(Self, String), String> {
        let mut hand = hand(self.take_device())?;
        let homed = hand.carry_out(&Action::Home)?;
        hand.carry_out(&Action::Steps(Axis::X, SHORT))?;
        self.client = Client::Hand(Box::new(hand));
        Ok((self, homed))
    }
}
