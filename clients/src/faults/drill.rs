//! The drill with its faults.

use super::{Fault, State, Subject, last_step_ms};
use crate::drill::{Action, Axis, Client, End, Hand, Operator, Part, Sender, sentence};
use crate::{StopRequests, Wire};
use husillo_gcode::Nm;
use husillo_sim::device::drill::Device;
use husillo_sim::device::{Emulation, LineFault};
use husillo_transports::drill::Record;
use std::time::Duration;

/// Rate of the line, bits/s.
const BAUD: u32 = 2400;
/// A lease, and the way up from the deepest point of a hole.
const UP_MS: u64 = 20_000;
/// The steps of a short move.
const SHORT: i32 = 40;
/// The holes of the board.
const HOLES: [[u16; 2]; 2] = [[300, 100], [350, 100]];

pub struct Drill {
    /// `None`: a program runs, or has run.
    hand: Option<Hand>,
    client: Option<Client>,
    last_step_ms: u64,
}

/// An operator who looks on.
struct Silent;

impl Operator for Silent {
    fn show(&mut self, _: &str) {}

    fn change(&mut self, _: &str, _: Option<Nm>) -> Option<String> {
        None
    }

    fn progress(&mut self, _: f64, _: f64) {}
}

fn connected(device: Device) -> Client {
    Client::new(Wire::simulated(device), BAUD, StopRequests::default())
}

impl Drill {
    fn client(&mut self) -> &mut Client {
        match &mut self.hand {
            Some(hand) => hand.client(),
            None => self.client.as_mut().unwrap(),
        }
    }

    fn device(&mut self) -> &mut Device {
        self.client().device().unwrap()
    }

    fn board(&mut self) -> Result<String, String> {
        let hole = |[x, y]: [u16; 2]| [Record::X(x), Record::Y(y), Record::Drill(0)];
        let parts = [Part {
            tool: 1,
            diameter: Some(Nm(800_000)),
            records: HOLES.into_iter().flat_map(hole).collect(),
        }];
        let mut sender = Sender {
            client: self.client.take().unwrap(),
            operator: &mut Silent,
            parts: &parts,
            from: 0,
            byte_s: 0.0085,
            is_homed: false,
            is_sure: true,
            diameter: |_| None,
        };
        let end = sender.send(false);
        self.client = Some(sender.client);
        match end? {
            End::Drilled => Ok("drilled".into()),
            end => Err(sentence(&end, "send BOARD", HOLES.len())),
        }
    }
}

impl Subject for Drill {
    const MACHINE: &'static str = "Drill";
    const STATES: &'static [(State, u64)] = &[
        (State::Idle, 0),
        (State::Homing, 1000),
        (State::Jog, 3000),
        (State::Program, 30_000),
    ];
    const FAULTS: &'static [Fault] = &[
        Fault {
            name: "host killed, cable pulled",
            begins: "unplug",
            ends: &["plug"],
            most_ms: Some(UP_MS),
            is_hidden: false,
        },
        Fault {
            name: "controller reset",
            begins: "reset",
            ends: &["where"],
            most_ms: None, // it homes
            is_hidden: false,
        },
        Fault {
            name: "power lost",
            begins: "power off",
            ends: &["power on"],
            most_ms: Some(0),
            is_hidden: false,
        },
        Fault {
            name: "home switch stuck open",
            begins: "open x",
            ends: &["free x", "reset"],
            most_ms: None,
            is_hidden: false,
        },
        Fault {
            name: "home switch stuck closed",
            begins: "close x",
            ends: &["free x", "reset"],
            most_ms: None,
            is_hidden: false,
        },
        Fault {
            name: "upper sensor stuck open",
            begins: "open up",
            ends: &["free up", "reset"],
            most_ms: None,
            is_hidden: false,
        },
        Fault {
            name: "lower sensor stuck open",
            begins: "open down",
            ends: &["free down", "reset"],
            most_ms: None,
            is_hidden: false,
        },
        Fault {
            name: "motor stalled",
            begins: "block x",
            ends: &["unblock x", "reset"],
            most_ms: None,
            is_hidden: true,
        },
    ];

    fn new(state: State) -> Self {
        let mut client = connected(Device::new(BAUD, false).with_rows());
        client.reach().unwrap();
        let mut machine = Self {
            hand: None,
            client: None,
            last_step_ms: 0,
        };
        let mut hand = Hand::new(client, |_, _| Ok(()));
        hand.carry_out(&Action::Home).unwrap();
        if state == State::Program {
            let device = std::mem::replace(hand.client().device().unwrap(), Device::quick(false));
            machine.client = Some(connected(device));
        } else {
            machine.hand = Some(hand);
        }
        machine
    }

    fn schedule(&mut self, after_ms: u64, line: &str) {
        self.device().schedule(after_ms * 1000, line);
    }

    fn disturb(&mut self, fault: Option<(u64, LineFault)>) {
        let line = self.device().line();
        line.fault = fault.map(|(bytes, fault)| (line.carried + bytes, fault));
    }

    fn act(&mut self, state: State) -> Result<String, String> {
        let action = match state {
            State::Homing => Action::Home,
            State::Jog => Action::Jog(Axis::X, true, Duration::from_secs(8)),
            State::Idle | State::Program | State::Probing => Action::Steps(Axis::X, SHORT),
        };
        match &mut self.hand {
            Some(hand) => hand.carry_out(&action),
            None => self.board(),
        }
    }

    fn pass(&mut self, ms: u64) {
        (0..ms).for_each(|_| drop(self.device().tick()));
    }

    fn now_ms(&mut self) -> u64 {
        self.device().now_us() / 1000
    }

    fn last_step_ms(&mut self) -> u64 {
        let rows = self.device().made();
        self.last_step_ms = last_step_ms(&rows, 3).unwrap_or(self.last_step_ms);
        self.last_step_ms
    }

    fn is_true(&mut self) -> bool {
        let is_right_hole = |at: [i32; 2]| HOLES.iter().any(|hole| hole.map(i32::from) == at);
        let rig = self.device().rig(0).unwrap();
        let [x, y, _] = rig.place();
        let holes_are_right = rig.holes().iter().all(|hole| is_right_hole(hole.at));
        let Some(hand) = &mut self.hand else {
            return holes_are_right;
        };
        let Ok(place) = hand.carry_out(&Action::Where) else {
            return true; // it says that it does not know
        };
        place.contains("unknown")
            || (place.contains(&format!("x        {x} steps"))
                && place.contains(&format!("y        {y} steps")))
    }

    fn begin_again(mut self) -> Result<Self, String> {
        let device = std::mem::replace(self.device(), Device::quick(false));
        let mut client = connected(device);
        client.reach().map_err(|trouble| trouble.text())?;
        let mut hand = Hand::new(client, |_, _| Ok(()));
        hand.carry_out(&Action::Home)?;
        hand.carry_out(&Action::Steps(Axis::X, SHORT))?;
        self.hand = Some(hand);
        Ok(self)
    }
}
