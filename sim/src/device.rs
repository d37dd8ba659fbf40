//! An emulated machine behind a serial line: its controller, its mechanics, and a panel.

pub mod drill;
mod emulation;
pub mod grbl;
pub mod microfactory;
pub mod micromill;
mod serial_line;
mod step_rows;

pub use emulation::Emulation;
pub use serial_line::{Line, LineFault};
pub use step_rows::StepRows;

use crate::text::counted;
use crate::{Emulated, Plant};
use husillo_controllers::{Controller, Timed};
use std::fmt;

/// Period of the emulation, us. A tick of the controllers' timers is 1 us.
const PERIOD_US: u64 = 1000;
/// Lines that the panel of every machine takes.
const PANEL: &str = "where, reset, power off|on, unplug, plug";

/// The part of an emulation that belongs to one machine. A new machine implements this trait.
pub trait Machine {
    /// The controller.
    type Controller: Controller;
    /// The mechanics of each machine of the controller.
    type Plant: Plant<
            Inputs = <Self::Controller as Controller>::Inputs,
            Event = <Self::Controller as Controller>::Event,
        >;

    /// Columns of the recorded step events: the directions of the motors, then states.
    const COLUMNS: &'static str;
    /// Commands of its panel, in addition to the common ones.
    const PANEL: &'static str;

    /// The event whose outputs are those after a reset.
    const AT_RESET: Event<Self>;

    /// Describes the position of a machine of the controller.
    fn place(&self, emulated: &Pair<Self>, machine: u8) -> String;

    /// Carries out a command of its own panel that needs the controller. Returns `None` for another
    /// command.
    fn shown(&self, emulated: &Pair<Self>, words: &[&str]) -> Option<String> {
        let _ = (emulated, words);
        None
    }

    /// Carries out a command of its own panel. Returns `None` for another command.
    fn control(&self, plant: &mut Self::Plant, words: &[&str]) -> Option<String>;

    /// Returns the text of an event that the panel shows.
    fn report(event: &Event<Self>) -> Option<String>;

    /// Returns the row of an event: the steps of each motor, and the states after the event.
    /// Returns `None` if the event does not change the motors.
    fn row(event: &Event<Self>, plant: &Self::Plant) -> Option<(Vec<i8>, Vec<u8>)>;

    /// Returns the text that the panel shows after the controller has received a byte.
    fn heard(&mut self, controller: &Self::Controller) -> Option<String> {
        let _ = controller;
        None
    }
}

/// An event of a machine's controller.
pub type Event<M> = <<M as Machine>::Controller as Controller>::Event;

/// A controller with its mechanics.
pub type Pair<M> = Emulated<<M as Machine>::Controller, <M as Machine>::Plant>;

/// A machine behind its serial line.
pub struct Device<M: Machine> {
    machine: M,
    line: Line,
    emulated: Pair<M>,
    has_power: bool,
    reported: Vec<String>,
    /// Recorded step events.
    rows: Option<StepRows>,
    /// Scheduled commands of the panel, each with its time in us.
    due: Vec<(u64, String)>,
}

impl<M: Machine> fmt::Debug for Device<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Device")
            .field("line", &self.line)
            .field("has_power", &self.has_power)
            .finish_non_exhaustive()
    }
}

impl<M: Machine> Device<M> {
    /// Creates a machine that is switched on, with a line of this rate.
    pub fn of(machine: M, emulated: Pair<M>, bits_per_s: u32) -> Self {
        Self {
            machine,
            line: Line::new(bits_per_s),
            emulated,
            has_power: true,
            reported: Vec::new(),
            rows: None,
            due: Vec::new(),
        }
    }

    /// Schedules a command of the panel `after_us` from now, for example a fault during a motion.
    pub fn schedule(&mut self, after_us: u64, line: &str) {
        let at_us = self.emulated.now_us() + after_us;
        self.due.push((at_us, line.to_owned()));
    }

    /// Returns the simulated time since the machine was switched on, us.
    pub fn now_us(&self) -> u64 {
        self.emulated.now_us()
    }

    /// Records the step events for [`Emulation::made`].
    pub fn with_rows(mut self) -> Self {
        self.rows = Some(StepRows::new(M::COLUMNS));
        self
    }

    /// Returns the commands of the panel.
    pub fn panel() -> String {
        format!("{PANEL}, {}", M::PANEL)
    }

    /// Returns the serial line, so that faults can be set.
    pub fn line(&mut self) -> &mut Line {
        &mut self.line
    }

    /// Returns the mechanics of a machine of the controller. Returns `None` if there is no such
    /// machine.
    pub fn rig(&self, machine: u8) -> Option<&M::Plant> {
        self.emulated.plant(machine)
    }

    /// Returns the numbers of the machines.
    fn machines(&self) -> impl Iterator<Item = u8> + use<M> {
        0..self.emulated.plants()
    }

    /// Presses the reset button, or restores the power.
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

    /// Simulates some time.
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

    /// Passes the bytes that have arrived to the controller.
    fn receive(&mut self, now_us: u64) {
        while let Some(byte) = self.line.received(now_us) {
            if self.has_power {
                self.emulated.receive(byte);
                let heard = self.machine.heard(self.emulated.controller());
                self.reported.extend(heard);
            }
        }
    }

    /// Takes bytes from the controller while the transmitter is free. The controller waits until
    /// its byte is taken.
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

    /// Carries out a command of the panel for one machine.
    fn control_of(&mut self, machine: u8, words: &[&str]) -> String {
        if self.emulated.plant(machine).is_none() {
            return format!("there is no machine {}", machine + 1);
        }
        if words == ["where"] {
            return self.machine.place(&self.emulated, machine);
        }
        if let Some(text) = self.machine.shown(&self.emulated, words) {
            return text;
        }
        let plant = self.emulated.plant_mut(machine);
        plant
            .and_then(|plant| self.machine.control(plant, words))
            .unwrap_or_else(|| format!("there are {}", Self::panel()))
    }
}

/// Appends the row of an event.
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

/// Puts the number of the machine before a text if there are several machines.
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

    fn on_the_line(&self) -> usize {
        self.line.waiting()
    }

    fn tick(&mut self) -> Vec<u8> {
        let start_us = self.emulated.now_us();
        let is_due = |(at_us, _): &mut (u64, String)| *at_us <= start_us;
        let due: Vec<_> = self.due.extract_if(.., is_due).collect();
        for (_, line) in due {
            let answer = self.control(&line);
            self.reported.push(answer);
        }
        let end_us = start_us + PERIOD_US;
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

    fn take_reports(&mut self) -> Vec<String> {
        std::mem::take(&mut self.reported)
    }

    fn made(&mut self) -> String {
        self.rows.as_mut().map(StepRows::take).unwrap_or_default()
    }
}

/// Carries out the panel commands `close`, `open` and `free` for a switch with one of these names.
/// Returns `None` for another command.
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

/// Carries out the panel command `push AXIS STEPS` for an axis with one of these names. Returns
/// `None` for another command.
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
        (Some(axis), Ok(steps)) => format!("pushed by {}", counted(push(axis, steps), "step")),
        _ => format!(
            "push {} by how many steps? As in `push x -40`",
            names.join("|")
        ),
    })
}

/// Carries out the panel commands `block AXIS` and `unblock AXIS` for an axis with one of these
/// names. Returns `None` for another command.
pub fn block(words: &[&str], names: &[&str], block: impl FnOnce(usize, bool)) -> Option<String> {
    let [word @ ("block" | "unblock"), axis] = *words else {
        return None;
    };
    let Some(number) = names.iter().position(|name| *name == axis) else {
        return Some(format!("no axis `{axis}`: there are {}", names.join(", ")));
    };
    block(number, word == "block");
    let is = if word == "block" { "blocked" } else { "free" };
    Some(format!("the motor of {axis} is {is}"))
}
