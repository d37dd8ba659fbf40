//! The microfactory with its faults.

use super::{Fault, State, Subject, last_step_ms};
use crate::microfactory::{Action, Client, Settings};
use crate::{StopRequests, Wire};
use husillo_sim::device::microfactory::Device;
use husillo_sim::device::{Emulation, LineFault};
use std::time::Duration;

/// A lease, the next question, and the time of a byte.
const SILENT_MS: u64 = 260;
/// The steps of a short move.
const SHORT: i32 = 40;

pub struct Microfactory {
    client: Client,
    last_step_ms: u64,
    /// Position of the simulated tool at zero.
    zero: [i32; 4],
}

fn connected(wire: Wire<Device>) -> Client {
    Client::new(
        wire,
        Settings::ORIGINAL.table,
        true,
        StopRequests::default(),
    )
}

impl Microfactory {
    fn device(&mut self) -> &mut Device {
        self.client.device()
    }

    fn short_move(&mut self) -> Result<String, String> {
        self.client.carry_out(&Action::Steps {
            motor: 0,
            steps: SHORT,
        })
    }
}

impl Subject for Microfactory {
    const MACHINE: &'static str = "Microfactory";
    const STATES: &'static [(State, u64)] = &[
        (State::Idle, 0),
        (State::Homing, 700),
        (State::Jog, 900),
        (State::Program, 4500),
        (State::Probing, 1500),
    ];
    const FAULTS: &'static [Fault] = &[
        Fault {
            name: "host killed, cable pulled",
            begins: "unplug",
            ends: &["plug"],
            most_ms: Some(SILENT_MS),
            is_hidden: false,
        },
        Fault {
            name: "controller reset",
            begins: "reset",
            ends: &["where"],
            most_ms: Some(0),
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
            ends: &["free x"],
            most_ms: None,
            is_hidden: false,
        },
        Fault {
            name: "home switch stuck closed",
            begins: "close x",
            ends: &["free x"],
            most_ms: None,
            is_hidden: false,
        },
        Fault {
            name: "contact stuck open",
            begins: "open contact",
            ends: &["free contact"],
            most_ms: None,
            is_hidden: false,
        },
        Fault {
            name: "contact stuck closed",
            begins: "close contact",
            ends: &["free contact"],
            most_ms: None,
            is_hidden: true,
        },
        Fault {
            name: "motor stalled",
            begins: "block x",
            ends: &["unblock x"],
            most_ms: None,
            is_hidden: true,
        },
    ];

    fn new(_: State) -> Self {
        let Settings { config, table, .. } = Settings::ORIGINAL;
        let figure = &[[500, 0], [0, 500], [-500, -500]];
        let device = Device::new(config, table, 0, figure, true, 9600, 1).unwrap();
        let mut client = connected(Wire::simulated(device.with_rows()));
        client.carry_out(&Action::Home).unwrap();
        let zero = client.device().rig(0).unwrap().tool();
        let mut machine = Self {
            client,
            last_step_ms: 0,
            zero,
        };
        machine.short_move().unwrap();
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
            State::Idle => return self.short_move(),
            State::Homing => Action::Home,
            State::Jog => Action::Jog {
                motor: 0,
                forward: true,
                time: Duration::from_secs(2),
            },
            State::Program | State::Probing => Action::Figure,
        };
        self.client.carry_out(&action)
    }

    fn pass(&mut self, ms: u64) {
        (0..ms).for_each(|_| drop(self.device().tick()));
    }

    fn now_ms(&mut self) -> u64 {
        self.device().now_us() / 1000
    }

    fn last_step_ms(&mut self) -> u64 {
        let rows = self.device().made();
        self.last_step_ms = last_step_ms(&rows, 4).unwrap_or(self.last_step_ms);
        self.last_step_ms
    }

    fn is_true(&mut self) -> bool {
        let Ok(place) = self.client.carry_out(&Action::Where) else {
            return true; // it says that it does not know
        };
        let [x, y, z, _] = self.device().rig(0).unwrap().tool();
        let [zero_x, zero_y, zero_z, _] = self.zero;
        let real = format!("x {} y {} z {} ", x - zero_x, y - zero_y, z - zero_z);
        !place.contains("from home") || place.starts_with(&real)
    }

    fn begin_again(self) -> Result<Self, String> {
        let mut machine = Self {
            client: connected(self.client.into_wire()),
            ..self
        };
        machine.client.carry_out(&Action::Home)?;
        machine.short_move()?;
        Ok(machine)
    }
}
