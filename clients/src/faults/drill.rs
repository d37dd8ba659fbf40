//! The drill with its faults.

use super::{Bench, Fault, State, Subject};
use crate::drill::{
    Action, Axis, Client, ClientError, End, Hand, Operator, Part, Sender, sentence,
};
use crate::{StopRequests, Wire};
use husillo_gcode::Nm;
use husillo_sim::DrilledHole;
use husillo_sim::device::Emulation as _;
use husillo_sim::device::drill::{Device, STROKE_STEPS};
use husillo_transports::drill::{Failure, Record};
use std::time::Duration;

/// Rate of the line, bits/s.
const BAUD: u32 = 2400;
/// Longest motion after the host is silent, ms: a lease, and the motion up from the deepest point
/// of a hole.
const UP_MS: u64 = 20_000;
/// The steps of a short move.
const SHORT: i32 = 40;
/// The longest search for a switch, with a margin.
const LONGEST: Duration = Duration::from_secs(220);
/// Depth of the bit in the board where the power was lost, in steps below the upper sensor.
const DEEP: i32 = 3500;
/// The holes of the board.
const HOLES: [[u16; 2]; 2] = [[300, 100], [350, 100]];

pub struct Drill {
    /// `None`: a program runs, or has run.
    hand: Option<Hand>,
    client: Option<Client>,
    /// Whether the program is reported as drilled.
    is_drilled: bool,
}

/// An operator who only watches.
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

    /// Waits until the drill has homed. A drill does not answer while it homes.
    fn wait_until_homed(&mut self) -> Result<String, String> {
        let client = self.client();
        let end = client.elapsed() + LONGEST;
        loop {
            match client.reach() {
                Ok(()) => return Ok("homed".into()),
                Err(ClientError::Link(Failure::Silent)) if client.elapsed() < end => {}
                Err(error) => return Err(error.text()),
            }
        }
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
            End::Drilled => {
                self.is_drilled = true;
                Ok("drilled".into())
            }
            end => Err(sentence(&end, "send BOARD", HOLES.len())),
        }
    }
}

impl Subject for Drill {
    const MACHINE: &'static str = "Drill";
    const STATES: &'static [(State, u64)] = &[
        (State::Idle, 0),
        (State::FirstHoming, 5000),
        (State::Homing, 1000),
        (State::Jog, 3000),
        (State::Program, 30_000),
    ];
    const FAULTS: &'static [Fault] = &[
        Fault::new("host killed, cable pulled", "unplug", &["plug"]).ends_within(UP_MS),
        // After a reset it homes.
        Fault::new("controller reset", "reset", &["where"]),
        Fault::new("power lost", "power off", &["power on"]).ends_within(0),
        Fault::new("home switch stuck open", "open x", &["free x", "reset"]),
        Fault::new("home switch stuck closed", "close x", &["free x", "reset"]),
        Fault::new("upper sensor stuck open", "open up", &["free up", "reset"]),
        Fault::new(
            "lower sensor stuck open",
            "open down",
            &["free down", "reset"],
        ),
        Fault::new(
            "upper sensor stuck closed",
            "close up",
            &["free up", "reset"],
        ),
        Fault::new(
            "lower sensor stuck closed",
            "close down",
            &["free down", "reset"],
        ),
        Fault::new("motor X stalled", "block x", &["unblock x", "reset"]).unnoticed(),
        Fault::new("motor Z stalled", "block z", &["unblock z", "reset"]),
    ];

    fn new(state: State) -> Self {
        let mut client = connected(Device::new(BAUD, false).with_rows());
        client.reach().unwrap();
        let mut machine = Self {
            hand: None,
            client: None,
            is_drilled: false,
        };
        let mut hand = Hand::new(client, |_, _| Ok(()));
        hand.carry_out(&Action::Home).unwrap();
        if state == State::FirstHoming {
            // The power was lost with the bit in the board, and it has returned.
            let [x, y] = HOLES[0].map(i32::from);
            for (axis, steps) in [(Axis::X, x), (Axis::Y, y), (Axis::Z, DEEP)] {
                hand.carry_out(&Action::Steps(axis, steps)).unwrap();
            }
            let device = hand.client().device().unwrap();
            device.control("power off");
            device.control("power on");
            drop(device.made());
        }
        if state == State::Program {
            let device = std::mem::replace(hand.client().device().unwrap(), Device::quick(false));
            machine.client = Some(connected(device));
        } else {
            machine.hand = Some(hand);
        }
        machine
    }

    fn bench(&mut self) -> &mut dyn Bench {
        self.device()
    }

    fn act(&mut self, state: State) -> Result<String, String> {
        let action = match state {
            State::FirstHoming => return self.wait_until_homed(),
            State::Homing => Action::Home,
            State::Jog => Action::Jog(Axis::X, true, Duration::from_secs(8)),
            State::Idle | State::Program | State::Guarded | State::Probing => {
                Action::Steps(Axis::X, SHORT)
            }
        };
        match &mut self.hand {
            Some(hand) => hand.carry_out(&action),
            None => self.board(),
        }
    }

    fn is_true(&mut self) -> bool {
        let is_drilled = self.is_drilled;
        let rig = self.device().rig(0).unwrap();
        let [x, y, _] = rig.place();
        if rig.dragged_steps() > 0 {
            return false;
        }
        let whole = HOLES.map(|at| DrilledHole {
            at: at.map(i32::from),
            depth: STROKE_STEPS.into(),
            is_clean: true,
        });
        // Work that has ended early leaves only some of the holes.
        let is_place = |at: [i32; 2]| whole.iter().any(|hole| hole.at == at);
        let holes_are_right = if is_drilled {
            rig.holes() == whole
        } else {
            rig.holes().iter().all(|hole| is_place(hole.at))
        };
        let Some(hand) = &mut self.hand else {
            return holes_are_right;
        };
        let Ok(place) = hand.carry_out(&Action::Where) else {
            return true; // it reports that it does not know
        };
        place.contains("unknown")
            || (place.contains(&format!("x        {x} steps"))
                && place.contains(&format!("y        {y} steps")))
    }

    fn begin_again(mut self) -> Result<(Self, String), String> {
        let device = std::mem::replace(self.device(), Device::quick(false));
        let mut client = connected(device);
        client.reach().map_err(|error| error.text())?;
        let mut hand = Hand::new(client, |_, _| Ok(()));
        let homed = hand.carry_out(&Action::Home)?;
        hand.carry_out(&Action::Steps(Axis::X, SHORT))?;
        self.hand = Some(hand);
        Ok((self, homed))
    }
}
