//! A simulated microfactory behind its link: bytes, controller, chips, motors, switches.

use super::settings::Settings;
use crate::emulate::emulation::Emulation;
use crate::emulate::step_rows::StepRows;
use crate::link::serial_line::Line;
use husillo_controllers::{
    MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs, MicrofactoryPair, MicrofactoryReport,
};
use husillo_sim::MicrofactoryRig;
use husillo_transports::microfactory::{Device as LinkDevice, Order, REJECTED};

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
pub const PANEL: &str = "where, reset, close x|y|z|contact, open x|y|z|contact, power off|on, unplug, plug; 2: before it for the second machine";

/// A machine: its mechanics, and what is under way there.
struct Bay {
    rig: MicrofactoryRig,
    /// A figure that is coming in.
    loading: Vec<[i16; 2]>,
    /// The event that waits for its time.
    due: Option<(u64, MicrofactoryEvent)>,
    held: MicrofactoryInputs,
    has_current: bool,
}

/// The device: a controller of one machine, or of two.
pub struct Device {
    link: LinkDevice,
    machines: MicrofactoryPair<Vec<[i16; 2]>>,
    /// One, or two.
    bays: Vec<Bay>,
    line: Line,
    now: u64,
    has_power: bool,
    told: Vec<String>,
    /// What is made, where that is kept.
    rows: Option<StepRows>,
}

impl Device {
    /// Switched on, with a figure; one that answers has a dead-man's time as well, one that does not is the original.
    pub fn new(settings: &Settings, figure: Vec<[i16; 2]>, answers: bool, bits_per_s: u32) -> Self {
        let config = MicrofactoryConfig {
            dead_man_ticks: answers.then_some(DEAD_MAN_TICKS),
            ..settings.config
        };
        let link = LinkDevice::new(settings.table);
        let bay = Bay {
            rig: MicrofactoryRig::new(&config, ABOVE_SWITCHES, FACE_STEPS, settings.pull_out_ticks),
            loading: Vec::new(),
            due: None,
            held: MicrofactoryInputs::default(),
            has_current: false,
        };
        Self {
            link: if answers {
                link.acknowledging().storing(ROOM)
            } else {
                link
            },
            machines: MicrofactoryPair::new(config, [figure.clone(), figure]),
            bays: vec![bay],
            line: Line::new(bits_per_s),
            now: 0,
            has_power: true,
            told: Vec::new(),
            rows: None,
        }
    }

    /// The same; what it makes is kept. Its states are the current of the motors, RESET of their sequencers, and the number of the machine.
    pub fn with_rows(mut self) -> Self {
        self.rows = Some(StepRows::new("dx,dy,dz,dc,current,reset,machine"));
        self
    }

    /// The same with a second machine like the first one.
    pub fn with_two_machines(mut self) -> Self {
        self.link = self.link.of_two_machines();
        if let [Bay { rig, .. }] = &self.bays[..] {
            let second = Bay {
                rig: rig.clone(),
                loading: Vec::new(),
                due: None,
                held: MicrofactoryInputs::default(),
                has_current: false,
            };
            self.bays.push(second);
        }
        self
    }

    /// The line.
    #[cfg(test)]
    pub fn line(&mut self) -> &mut Line {
        &mut self.line
    }

    /// The mechanics of the first machine.
    #[cfg(test)]
    pub fn rig(&self) -> &MicrofactoryRig {
        self.rig_of(0)
    }

    /// The mechanics of a machine.
    #[cfg(test)]
    pub fn rig_of(&self, machine: usize) -> &MicrofactoryRig {
        &self.bays[machine].rig
    }

    /// Bytes that are complete, in order.
    fn receive(&mut self) {
        while let Some(byte) = self.line.received(self.now) {
            if !self.has_power {
                continue;
            }
            let is_moving = self.machines.is_moving(self.link.machine());
            let received = self.link.receive(byte, is_moving);
            let machine = self.link.machine();
            let is_taken = match received.command {
                Some(command) if command.is_a_motion() => self.machines.command(machine, command),
                _ => true,
            };
            let reply = received.reply;
            self.answer(reply.map(|reply| if is_taken { reply } else { REJECTED }));
            if let Some(command) = received.command {
                self.keep(machine, command);
            }
        }
    }

    /// What does not concern the controller of a machine: its figure, and what is asked.
    fn keep(&mut self, machine: u8, command: Order) {
        let (Some(bay), Some(controller)) = (
            self.bays.get_mut(usize::from(machine)),
            self.machines.machine_mut(machine),
        ) else {
            return;
        };
        // Nothing moves while a figure comes in, so the machine takes it.
        match command {
            Order::Ask => {
                let status = controller.status();
                self.answer(status.bytes());
            }
            Order::Clear => {
                bay.loading.clear();
                let _ = controller.set_figure(Vec::new());
            }
            Order::Line(way) => bay.loading.push(way),
            Order::Keep => {
                let figure = std::mem::take(&mut bay.loading);
                let moves = figure.len();
                let _ = controller.set_figure(figure);
                self.tell_of(machine, format!("a figure of {moves} moves"));
            }
            // Begun, or refused.
            _ => {}
        }
    }

    /// With the number of the machine, where there are two.
    fn tell_of(&mut self, machine: u8, what: String) {
        self.told.push(if self.bays.len() > 1 {
            format!("{}: {what}", machine + 1)
        } else {
            what
        });
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
        self.machines.reset();
        self.link.reset();
        for machine in (0..).take(self.bays.len()) {
            if let Some(bay) = self.bays.get_mut(usize::from(machine)) {
                bay.due = None;
            }
            self.apply(machine, self.now, &MicrofactoryEvent::Enable(false));
        }
    }

    /// Makes an event of a machine happen.
    fn apply(&mut self, machine: u8, at: u64, event: &MicrofactoryEvent) {
        let Some(bay) = self.bays.get_mut(usize::from(machine)) else {
            return;
        };
        bay.rig.apply(event);
        let (wait_ticks, delta, is_reset) = match *event {
            MicrofactoryEvent::Step(step) => (step.wait_ticks, step.delta, false),
            MicrofactoryEvent::Dwell { wait_ticks } if wait_ticks > 0 => {
                (wait_ticks, [0; 4], false)
            }
            MicrofactoryEvent::Reset { ticks } => (ticks, [0; 4], true),
            MicrofactoryEvent::Enable(on) => {
                bay.has_current = on;
                (0, [0; 4], false)
            }
            // Nothing of them is to be seen at the motors.
            MicrofactoryEvent::Dwell { .. }
            | MicrofactoryEvent::Report(_)
            | MicrofactoryEvent::Idle => return,
        };
        if let Some(rows) = &mut self.rows {
            let states = [bay.has_current.into(), is_reset.into(), machine + 1];
            rows.push(at, wait_ticks, &delta, &states);
        }
    }

    /// Events of a machine whose time has come.
    fn happen(&mut self, machine: u8) {
        let mut from = self.now - PERIOD_TICKS;
        while let Some(bay) = self.bays.get_mut(usize::from(machine)) {
            if bay.due.is_none() {
                let event = self.machines.next_event(machine, &bay.rig.inputs());
                let wait = match event {
                    MicrofactoryEvent::Idle => return,
                    MicrofactoryEvent::Step(step) => step.wait_ticks,
                    MicrofactoryEvent::Dwell { wait_ticks } => wait_ticks,
                    MicrofactoryEvent::Reset { ticks } => ticks,
                    MicrofactoryEvent::Enable(_) | MicrofactoryEvent::Report(_) => 0,
                };
                bay.due = Some((from + u64::from(wait), event));
            }
            let Some((at, event)) = bay.due.take_if(|(at, _)| *at <= self.now) else {
                return;
            };
            from = at;
            self.apply(machine, at, &event);
            if let MicrofactoryEvent::Report(report) = event {
                if matches!(report, MicrofactoryReport::Switch { .. })
                    && self.link.machine() == machine
                {
                    self.link.leave_mode();
                }
                self.tell_of(machine, text(report));
            }
        }
    }

    fn place(&self, machine: u8) -> String {
        let (Some(bay), Some(machine)) = (
            self.bays.get(usize::from(machine)),
            self.machines.machine(machine),
        ) else {
            return format!("there is no machine {}", machine + 1);
        };
        let [x, y, z, spindle] = machine.position_steps();
        let frame = if machine.is_homed() {
            "from home"
        } else {
            "not homed"
        };
        let lost: u64 = bay.rig.lost_steps().iter().sum();
        format!("x {x} y {y} z {z} spindle {spindle} steps, {frame}; {lost} lost")
    }

    fn hold(&mut self, machine: u8, switch: &str, closed: bool) -> String {
        let Some(bay) = self.bays.get_mut(usize::from(machine)) else {
            return format!("there is no machine {}", machine + 1);
        };
        let [x, y, z] = &mut bay.held.home;
        let place = match switch {
            "x" => x,
            "y" => y,
            "z" => z,
            "contact" => &mut bay.held.contact,
            _ => return format!("no switch `{switch}`: there are x, y, z and contact"),
        };
        *place = closed;
        bay.rig.hold(bay.held);
        format!("{switch} is {}", if closed { "closed" } else { "let go" })
    }
}

/// A report for people.
pub fn text(report: MicrofactoryReport) -> String {
    let letter = |axis: u8| {
        ["x", "y", "z"]
            .get(usize::from(axis))
            .copied()
            .unwrap_or("?")
    };
    match report {
        MicrofactoryReport::Homed => "homed".into(),
        MicrofactoryReport::Done => "done".into(),
        MicrofactoryReport::Stopped => "stopped".into(),
        MicrofactoryReport::DeadMan => "the jog was not said again".into(),
        MicrofactoryReport::Contact => "the tool touches: the figure begins".into(),
        MicrofactoryReport::NoContact => {
            "no contact on the longest way; the figure was not cut".into()
        }
        MicrofactoryReport::NoFigure => "no figure is stored".into(),
        MicrofactoryReport::Switch { axis } => {
            format!("home switch {} closed: going back off it", letter(axis))
        }
        MicrofactoryReport::NoSwitch { axis } => {
            format!("no home switch {} on the longest way", letter(axis))
        }
        MicrofactoryReport::StillClosed { axis } => format!(
            "home switch {} is closed still after the way back off it",
            letter(axis)
        ),
        MicrofactoryReport::Emergency => "emergency stop: until a reset nothing moves".into(),
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
            for machine in (0..).take(self.bays.len()) {
                self.happen(machine);
            }
        }
        std::iter::from_fn(|| self.line.answered(self.now)).collect()
    }

    fn control(&mut self, line: &str) -> String {
        let words: Vec<_> = line.split_whitespace().collect();
        let (machine, words) = match words[..] {
            ["2:", ..] => (1, &words[1..]),
            ["1:", ..] => (0, &words[1..]),
            _ => (0, &words[..]),
        };
        match *words {
            ["where"] => self.place(machine),
            ["reset"] => {
                self.reset();
                "reset".into()
            }
            ["close", switch] => self.hold(machine, switch, true),
            ["open", switch] => self.hold(machine, switch, false),
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

    fn made(&mut self) -> String {
        self.rows.as_mut().map(StepRows::take).unwrap_or_default()
    }
}
