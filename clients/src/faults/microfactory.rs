//! The microfactory with its faults.

use super::{Bench, Fault, State, Subject};
use crate::microfactory::{Action, Client, Settings};
use crate::{StopRequests, Wire};
use husillo_sim::device::microfactory::Device;
use std::time::Duration;

/// Longest motion after the host is silent, ms: a lease, the next question, and the time of a byte.
const SILENT_MS: u64 = 260;
/// The steps of a short move.
const SHORT: i32 = 40;

pub struct Microfactory {
    client: Client,
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
        (State::FirstHoming, 700),
        (State::Homing, 700),
        (State::Jog, 900),
        (State::Program, 4500),
        (State::Probing, 1500),
    ];
    const FAULTS: &'static [Fault] = &[
        Fault::new("host killed, cable pulled", "unplug", &["plug"]).ends_within(SILENT_MS),
        Fault::new("controller reset", "reset", &["where"]).ends_within(0),
        Fault::new("power lost", "power off", &["power on"]).ends_within(0),
        Fault::new("home switch stuck open", "open x", &["free x"]),
        Fault::new("home switch stuck closed", "close x", &["free x"]),
        Fault::new("contact stuck open", "open contact", &["free contact"]),
        Fault::new("contact stuck closed", "close contact", &["free contact"]).unnoticed(),
        Fault::new("motor stalled", "block x", &["unblock x"]).unnoticed(),
    ];

    fn new(state: State) -> Self {
        let Settings { config, table, .. } = Settings::ORIGINAL;
        let figure = &[[500, 0], [0, 500], [-500, -500]];
        let switched_on = || {
            let device = Device::new(config, table, 0, figure, true, 9600, 1).unwrap();
            connected(Wire::simulated(device.with_rows()))
        };
        let mut client = switched_on();
        client.carry_out(&Action::Home).unwrap();
        let zero = client.device().rig(0).unwrap().tool();
        let mut machine = Self { client, zero };
        match state {
            State::FirstHoming => machine.client = switched_on(),
            _ => drop(machine.short_move().unwrap()),
        }
        machine
    }

    fn bench(&mut self) -> &mut dyn Bench {
        self.device()
    }

    fn act(&mut self, state: State) -> Result<String, String> {
        let action = match state {
            State::Idle => return self.short_move(),
            State::FirstHoming | State::Homing => Action::Home,
            State::Jog => Action::Jog {
                motor: 0,
                forward: true,
                time: Duration::from_secs(2),
            },
            State::Program | State::Guarded | State::Probing => Action::Figure,
        };
        self.client.carry_out(&action)
    }

    fn is_true(&mut self) -> bool {
        let Ok(place) = self.client.carry_out(&Action::Where) else {
            return true; // it reports that it does not know
        };
        let [x, y, z, _] = self.device().rig(0).unwrap().tool();
        let [zero_x, zero_y, zero_z, _] = self.zero;
        let real = format!("x {} y {} z {} ", x - zero_x, y - zero_y, z - zero_z);
        !place.contains("from home") || place.starts_with(&real)
    }

    fn begin_again(self) -> Result<(Self, String), String> {
        let mut machine = Self {
            client: connected(self.client.into_wire()),
            ..self
        };
        let homed = machine.client.carry_out(&Action::Home)?;
        machine.short_move()?;
        Ok((machine, homed))
    }
}
