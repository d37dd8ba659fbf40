//! A simulated microfactory behind its link: bytes, controller, chips, motors, switches.

use super::settings::Settings;
use crate::emulation::Emulation;
use crate::line::Line;
use husillo_machine::{Cell, CellConfig, CellEvent, CellInputs, CellReport};
use husillo_sim::CellRig;
use husillo_transports::byte_commands::{ByteCommand, ByteCommands, REJECTED};

/// Ticks of a period, on the timer of 1 MHz.
const PERIOD_TICKS: u64 = 1000;
/// Moves that a device which answers has room for.
pub const ROOM: u16 = 1000;
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
    /// A figure that is coming in.
    loading: Vec<[i16; 2]>,
    line: Line,
    now: u64,
    /// The event that waits for its time.
    due: Option<(u64, CellEvent)>,
    held: CellInputs,
    has_power: bool,
    told: Vec<String>,
}

impl Device {
    /// Switched on, with a figure; one that answers has a dead-man's time as well, one that does not is the original.
    pub fn new(settings: &Settings, figure: Vec<[i16; 2]>, answers: bool, bits_per_s: u32) -> Self {
        let config = CellConfig {
            dead_man_ticks: answers.then_some(DEAD_MAN_TICKS),
            ..settings.config
        };
        let link = ByteCommands::new(settings.table);
        Self {
            link: if answers {
                link.acknowledging().storing(ROOM)
            } else {
                link
            },
            cell: Cell::new(config, figure),
            rig: CellRig::new(&config, ABOVE_SWITCHES, FACE_STEPS),
            loading: Vec::new(),
            line: Line::new(bits_per_s),
            now: 0,
            due: None,
            held: CellInputs::default(),
            has_power: true,
            told: Vec::new(),
        }
    }

    /// The line.
    #[cfg(test)]
    pub fn line(&mut self) -> &mut Line {
        &mut self.line
    }

    /// The mechanics.
    #[cfg(test)]
    pub fn rig(&self) -> &CellRig {
        &self.rig
    }

    /// Bytes that are complete, in order.
    fn receive(&mut self) {
        while let Some(byte) = self.line.received(self.now) {
            if !self.has_power {
                continue;
            }
            let received = self.link.receive(byte, self.cell.is_moving());
            let is_taken = match received.command {
                Some(command) if command.is_a_motion() => self.cell.command(command),
                _ => true,
            };
            let reply = received.reply;
            self.answer(reply.map(|reply| if is_taken { reply } else { REJECTED }));
            match received.command {
                Some(ByteCommand::Ask) => self.answer(self.cell.status().bytes()),
                Some(ByteCommand::Clear) => {
                    self.loading.clear();
                    self.store(Vec::new());
                }
                Some(ByteCommand::Line(way)) => self.loading.push(way),
                Some(ByteCommand::Keep) => {
                    let figure = std::mem::take(&mut self.loading);
                    self.told
                        .push(format!("a figure of {} moves", figure.len()));
                    self.store(figure);
                }
                // Begun above, or refused.
                _ => {}
            }
        }
    }

    /// Nothing moves while a figure comes in, so the cell takes it.
    fn store(&mut self, figure: Vec<[i16; 2]>) {
        let _ = self.cell.set_figure(figure);
    }

    fn answer(&mut self, bytes: impl IntoIterator<Item = u8>) {
        for byte in bytes {
            if self.line.answer(byte, self.now) {
                self.reset();
            }
        }
    }

    /// The button at the panel, or power that comes back.
    fn reset(&mut self) {
        self.cell.reset();
        self.link.reset();
        self.due = None;
        self.rig.apply(&CellEvent::Enable(false));
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
                if let CellReport::Switch { .. } = report {
                    self.link.leave_mode();
                }
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
pub fn text(report: CellReport) -> String {
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
        CellReport::NoFigure => "no figure is stored".into(),
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
        if self.line.send(byte, self.now) {
            self.reset();
        }
    }

    fn tick(&mut self) -> Vec<u8> {
        self.now += PERIOD_TICKS;
        self.receive();
        if self.has_power {
            self.happen();
        }
        std::iter::from_fn(|| self.line.answered(self.now)).collect()
    }

    fn control(&mut self, line: &str) -> String {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["where"] => self.place(),
            ["reset"] => {
                self.reset();
                "reset".into()
            }
            ["close", switch] => self.hold(switch, true),
            ["open", switch] => self.hold(switch, false),
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
            _ => format!("there are {PANEL}"),
        }
    }

    fn tell(&mut self) -> Vec<String> {
        std::mem::take(&mut self.told)
    }
}
