//! A simulated microfactory behind its link: bytes, controller, chips, motors, switches.

use crate::emulation::Emulation;
use husillo_machine::{Cell, CellConfig, CellEvent, CellInputs, CellReport};
use husillo_sim::CellRig;
use husillo_transports::byte_commands::{ByteCommands, ByteTable};
use std::collections::VecDeque;

/// Ticks of a byte at 9600 baud, ten bits, on the timer of 1 MHz.
const BYTE_TICKS: u64 = 1042;
/// Ticks of a period.
const PERIOD_TICKS: u64 = 1000;
/// Ticks after which a jog that is not said again ends, on devices that answer.
const DEAD_MAN_TICKS: u32 = 500_000;
/// Where the axes stand above their home switches at first, and the work piece before the tool.
const ABOVE_SWITCHES: [u16; 3] = [420, 380, 900];
const FACE_STEPS: i32 = 1200;

/// What may be typed at the panel.
pub const PANEL: &str =
    "where, reset, close x|y|z|contact, open x|y|z|contact, power off|on, unplug, plug";

/// The device.
pub struct Device {
    link: ByteCommands,
    cell: Cell<Vec<[i16; 2]>>,
    rig: CellRig,
    /// Bytes on the line, with the tick at which each is complete.
    line: VecDeque<(u64, u8)>,
    /// When the line is free again.
    free_at: u64,
    now: u64,
    /// The event that waits for its time.
    due: Option<(u64, CellEvent)>,
    held: CellInputs,
    has_power: bool,
    is_plugged: bool,
    answers: Vec<u8>,
    told: Vec<String>,
}

impl Device {
    /// Switched on, with a figure; one that answers has a dead-man's time as well, one that does not is the original.
    pub fn new(figure: Vec<[i16; 2]>, answers: bool) -> Self {
        let config = CellConfig {
            dead_man_ticks: answers.then_some(DEAD_MAN_TICKS),
            ..CellConfig::ORIGINAL
        };
        let link = ByteCommands::new(ByteTable::DEFAULT);
        Self {
            link: if answers { link.acknowledging() } else { link },
            cell: Cell::new(config, figure),
            rig: CellRig::new(&config, ABOVE_SWITCHES, FACE_STEPS),
            line: VecDeque::new(),
            free_at: 0,
            now: 0,
            due: None,
            held: CellInputs::default(),
            has_power: true,
            is_plugged: true,
            answers: Vec::new(),
            told: Vec::new(),
        }
    }

    /// Bytes that are complete, in order.
    fn receive(&mut self) {
        while self.line.front().is_some_and(|(at, _)| *at <= self.now) {
            let Some((_, byte)) = self.line.pop_front() else {
                return;
            };
            if !self.has_power {
                continue;
            }
            let received = self.link.receive(byte, self.cell.is_moving());
            if let Some(command) = received.command {
                self.cell.command(command);
            }
            if self.is_plugged {
                self.answers.extend(received.reply);
            }
        }
    }

    /// Events whose time has come.
    fn happen(&mut self) {
        let mut from = self.now - PERIOD_TICKS;
        loop {
            if self.due.is_none() {
                let event = self.cell.next_event(&self.rig.inputs());
                let wait = match event {
                    CellEvent::Idle => return,
                    CellEvent::Step(step) => step.wait_ticks,
                    CellEvent::Dwell { wait_ticks } => wait_ticks,
                    CellEvent::Reset { ticks } => ticks,
                    CellEvent::Enable(_) | CellEvent::Report(_) => 0,
                };
                self.due = Some((from + u64::from(wait), event));
            }
            let Some((at, event)) = self.due.take_if(|(at, _)| *at <= self.now) else {
                return;
            };
            from = at;
            self.rig.apply(&event);
            if let CellEvent::Report(report) = event {
                self.told.push(text(report));
            }
        }
    }

    fn place(&self) -> String {
        let [x, y, z, spindle] = self.cell.position_steps();
        let frame = if self.cell.is_homed() {
            "from home"
        } else {
            "not homed"
        };
        let lost: u64 = self.rig.lost_steps().iter().sum();
        format!("x {x} y {y} z {z} spindle {spindle} steps, {frame}; {lost} lost")
    }

    fn hold(&mut self, switch: &str, closed: bool) -> String {
        let [x, y, z] = &mut self.held.home;
        let place = match switch {
            "x" => x,
            "y" => y,
            "z" => z,
            "contact" => &mut self.held.contact,
            _ => return format!("no switch `{switch}`: there are x, y, z and contact"),
        };
        *place = closed;
        self.rig.hold(self.held);
        format!("{switch} is {}", if closed { "closed" } else { "let go" })
    }
}

/// A report for people.
fn text(report: CellReport) -> String {
    let letter = |axis: u8| {
        ["x", "y", "z"]
            .get(usize::from(axis))
            .copied()
            .unwrap_or("?")
    };
    match report {
        CellReport::Homed => "homed".into(),
        CellReport::Done => "done".into(),
        CellReport::Stopped => "stopped".into(),
        CellReport::DeadMan => "the jog was not said again".into(),
        CellReport::Contact => "the tool touches: the figure begins".into(),
        CellReport::NoContact => "no contact on the longest way; the figure was not cut".into(),
        CellReport::Switch { axis } => {
            format!("home switch {} closed: going back off it", letter(axis))
        }
        CellReport::NoSwitch { axis } => {
            format!("no home switch {} on the longest way", letter(axis))
        }
        CellReport::StillClosed { axis } => format!(
            "home switch {} is closed still after the way back off it",
            letter(axis)
        ),
        CellReport::Emergency => "emergency stop: until a reset nothing moves".into(),
    }
}

impl Emulation for Device {
    const PERIOD_NS: u64 = PERIOD_TICKS * 1000;

    fn send(&mut self, byte: u8) {
        if self.is_plugged {
            self.free_at = self.free_at.max(self.now) + BYTE_TICKS;
            self.line.push_back((self.free_at, byte));
        }
    }

    fn tick(&mut self) -> Vec<u8> {
        self.now += PERIOD_TICKS;
        self.receive();
        if self.has_power {
            self.happen();
        }
        std::mem::take(&mut self.answers)
    }

    fn control(&mut self, line: &str) -> String {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["where"] => self.place(),
            ["reset"] => {
                self.cell.reset();
                self.link.reset();
                self.due = None;
                self.rig.apply(&CellEvent::Enable(false));
                "reset".into()
            }
            ["close", switch] => self.hold(switch, true),
            ["open", switch] => self.hold(switch, false),
            ["power", "off"] => {
                self.has_power = false;
                self.due = None;
                self.rig.apply(&CellEvent::Enable(false));
                "power is off".into()
            }
            ["power", "on"] => {
                self.has_power = true;
                self.cell.reset();
                self.link.reset();
                "power is on".into()
            }
            ["unplug"] => {
                self.is_plugged = false;
                "unplugged".into()
            }
            ["plug"] => {
                self.is_plugged = true;
                "plugged in".into()
            }
            _ => format!("there are {PANEL}"),
        }
    }

    fn tell(&mut self) -> Vec<String> {
        std::mem::take(&mut self.told)
    }
}
