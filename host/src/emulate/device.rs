//! A machine that is emulated: its line, its controller, its mechanics, and a panel.

use crate::emulate::step_rows::StepRows;
use crate::link::emulation::Emulation;
use crate::link::serial_line::Line;
use husillo_controllers::{Controller, Timed};
use husillo_sim::{Emulated, Plant};

/// Microseconds, and ticks of the timer, of a period.
const PERIOD_US: u64 = 1000;
/// What may be typed at the panel of every machine.
const PANEL: &str = "where, reset, power off|on, unplug, plug";

/// What is particular to a machine: all that a new one has to say to be emulated.
pub trait Machine {
    /// Its controller.
    type Controller: Controller;
    /// Its mechanics.
    type Plant: Plant<
            Inputs = <Self::Controller as Controller>::Inputs,
            Event = <Self::Controller as Controller>::Event,
        >;

    /// Columns of the file of what it makes: the directions of its motors, then states.
    const COLUMNS: &'static str;
    /// What may be typed at its panel beside the lines that all have.
    const PANEL: &'static str;

    /// What the reset button does to its outputs.
    const AT_RESET: Event<Self>;

    /// Where a machine of the controller is.
    fn place(&self, emulated: &Pair<Self>, machine: u8) -> String;

    /// A line of its own panel; `None` where there is no such line.
    fn control(&self, plant: &mut Self::Plant, words: &[&str]) -> Option<String>;

    /// What an event has to report on the panel.
    fn report(event: &Event<Self>) -> Option<String>;

    /// The row of an event: its steps by motor, and the states after it. `None`: nothing is to be
    /// seen at the motors.
    fn row(event: &Event<Self>, plant: &Self::Plant) -> Option<(Vec<i8>, Vec<u8>)>;

    /// A byte was heard: what the panel reports of it.
    fn heard(&mut self, controller: &Self::Controller) -> Option<String> {
        let _ = controller;
        None
    }
}

/// An event of a machine's controller.
pub type Event<M> = <<M as Machine>::Controller as Controller>::Event;

/// A controller with its mechanics.
pub type Pair<M> = Emulated<<M as Machine>::Controller, <M as Machine>::Plant>;

/// A machine behind its line.
pub struct Device<M: Machine> {
    machine: M,
    line: Line,
    emulated: Pair<M>,
    has_power: bool,
    reported: Vec<String>,
    /// What is made, where that is kept.
    rows: Option<StepRows>,
}

impl<M: Machine> Device<M> {
    /// Switched on, at so many bits a second.
    pub fn of(machine: M, emulated: Pair<M>, bits_per_s: u32) -> Self {
        Self {
            machine,
            line: Line::new(bits_per_s),
            emulated,
            has_power: true,
            reported: Vec::new(),
            rows: None,
        }
    }

    /// The same; what it makes is kept.
    pub fn with_rows(mut self) -> Self {
        self.rows = Some(StepRows::new(M::COLUMNS));
        self
    }

    /// All that may be typed at the panel.
    pub fn panel() -> String {
        format!("{PANEL}, {}", M::PANEL)
    }

    /// The line.
    #[cfg(test)]
    pub fn line(&mut self) -> &mut Line {
        &mut self.line
    }

    /// The mechanics of a machine.
    #[cfg(test)]
    pub fn rig_of(&self, machine: u8) -> &M::Plant {
        self.emulated.plant(machine).unwrap()
    }

    /// The mechanics of the first machine.
    #[cfg(test)]
    pub fn rig(&self) -> &M::Plant {
        self.rig_of(0)
    }

    /// The machines that there are.
    fn machines(&self) -> impl Iterator<Item = u8> + use<M> {
        0..self.emulated.plants()
    }

    /// The button at the panel, or power that comes back.
    fn reset(&mut self) {
        self.emulated.reset();
        let now_us = self.emulated.now_us();
        for machine in self.machines() {
            if let Some(plant) = self.emulated.plant_mut(machine) {
                plant.apply(&M::AT_RESET);
                keep::<M>(&mut self.rows, machine, now_us, &M::AT_RESET, plant);
            }
        }
    }

    /// Time passes: events happen.
    fn pass(&mut self, us: u64) {
        if !self.has_power {
            return self.emulated.pass_without_power(us);
        }
        let (rows, reported) = (&mut self.rows, &mut self.reported);
        let machines = self.emulated.plants();
        self.emulated.pass(us, |machine, at_us, event, plant| {
            keep::<M>(rows, machine, at_us, event, plant);
            let report = M::report(event);
            reported.extend(report.map(|text| numbered(machines, machine, text)));
        });
    }

    /// The bytes that have arrived.
    fn receive(&mut self, now_us: u64) {
        while let Some(byte) = self.line.received(now_us) {
            if self.has_power {
                self.emulated.receive(byte);
                let heard = self.machine.heard(self.emulated.controller());
                self.reported.extend(heard);
            }
        }
    }

    /// A byte, where the transmitter is free: bytes that wait make a controller wait.
    fn transmit(&mut self, now_us: u64) {
        while self.has_power && self.line.is_free(now_us) {
            let Some(byte) = self.emulated.transmit() else {
                return;
            };
            if self.line.answer(byte, now_us) {
                self.reset();
            }
        }
    }

    /// A line for one machine.
    fn control_of(&mut self, machine: u8, words: &[&str]) -> String {
        if self.emulated.plant(machine).is_none() {
            return format!("there is no machine {}", machine + 1);
        }
        if words == ["where"] {
            return self.machine.place(&self.emulated, machine);
        }
        let plant = self.emulated.plant_mut(machine);
        plant
            .and_then(|plant| self.machine.control(plant, words))
            .unwrap_or_else(|| format!("there are {}", Self::panel()))
    }
}

/// Adds what is to be seen of an event to the rows.
fn keep<M: Machine>(
    rows: &mut Option<StepRows>,
    machine: u8,
    at_us: u64,
    event: &Event<M>,
    plant: &M::Plant,
) {
    if let (Some(rows), Some((delta, mut states))) = (rows, M::row(event, plant)) {
        if M::COLUMNS.ends_with("machine") {
            states.push(machine + 1);
        }
        rows.push(at_us, event.wait_ticks().unwrap_or(0), &delta, &states);
    }
}

/// With the number of the machine, where there are two.
pub fn numbered(machines: u8, machine: u8, text: String) -> String {
    if machines > 1 {
        format!("{}: {text}", machine + 1)
    } else {
        text
    }
}

impl<M: Machine> Emulation for Device<M> {
    const PERIOD_NS: u64 = PERIOD_US * 1000;

    fn send(&mut self, byte: u8) {
        if self.line.send(byte, self.emulated.now_us()) {
            self.reset();
        }
    }

    fn tick(&mut self) -> Vec<u8> {
        let end_us = self.emulated.now_us() + PERIOD_US;
        while self.emulated.now_us() < end_us {
            let now_us = self.line.next_us(self.emulated.now_us()).min(end_us);
            self.pass(now_us - self.emulated.now_us());
            self.receive(now_us);
            self.transmit(now_us);
        }
        std::iter::from_fn(|| self.line.answered(end_us)).collect()
    }

    fn control(&mut self, line: &str) -> String {
        let words: Vec<_> = line.split_whitespace().collect();
        let (machine, words) = match words[..] {
            ["2:", ..] => (1, &words[1..]),
            ["1:", ..] => (0, &words[1..]),
            _ => (0, &words[..]),
        };
        match *words {
            ["reset"] => {
                self.reset();
                "reset".into()
            }
            ["power", "off"] => {
                self.has_power = false;
                self.reset();
                "power is off".into()
            }
            ["power", "on"] => {
                self.has_power = true;
                "power is on".into()
            }
            ["unplug"] => {
                self.line.plug(false);
                "unplugged".into()
            }
            ["plug"] => {
                self.line.plug(true);
                "plugged in".into()
            }
            _ => self.control_of(machine, words),
        }
    }

    fn tell(&mut self) -> Vec<String> {
        std::mem::take(&mut self.reported)
    }

    fn made(&mut self) -> String {
        self.rows.as_mut().map(StepRows::take).unwrap_or_default()
    }
}

/// Holds a switch of this name closed or open, or lets go of it: what the panel reports.
pub fn hold(
    words: &[&str],
    names: &[&str],
    hold: impl FnOnce(usize, Option<bool>),
) -> Option<String> {
    let [held @ ("close" | "open" | "free"), switch] = *words else {
        return None;
    };
    let Some(number) = names.iter().position(|name| *name == switch) else {
        let list = names.join(", ");
        return Some(format!("no switch `{switch}`: there are {list}"));
    };
    let (closed, is) = match held {
        "close" => (Some(true), "held closed"),
        "open" => (Some(false), "held open"),
        _ => (None, "free"),
    };
    hold(number, closed);
    Some(format!("{switch} is {is}"))
}

/// Pushes the rotor of an axis of this name: what the panel reports.
pub fn push(
    words: &[&str],
    names: &[&str],
    push: impl FnOnce(usize, i32) -> i32,
) -> Option<String> {
    let ["push", axis, steps] = *words else {
        return None;
    };
    let axis = names.iter().position(|name| *name == axis);
    Some(match (axis, steps.parse()) {
        (Some(axis), Ok(steps)) => format!("pushed by {} steps", push(axis, steps)),
        _ => format!(
            "push {} by how many steps? As in `push x -40`",
            names.join("|")
        ),
    })
}
