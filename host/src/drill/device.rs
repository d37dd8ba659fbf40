//! A simulated drill behind its link: bytes, controller, motors, switches, a board.

use crate::emulate::emulation::Emulation;
use crate::emulate::step_rows::StepRows;
use crate::link::serial_line::Line;
use husillo_controllers::{Drill, DrillConfig, DrillEvent, DrillFault, DrillReport};
use husillo_sim::{DrillRig, DrilledHole};
use husillo_transports::drill::MEMORY_BYTES;

/// Microseconds, and ticks of the timer, of a period.
const PERIOD_US: u64 = 1000;
/// Where X, Y and Z stand at first, in steps from their switches.
const BEGIN: [i32; 3] = [500, 250, 60];
/// 35 mm from one sensor of Z to the other, and 30 mm to the board, in steps.
pub const STROKE_STEPS: u16 = 3745;
const BOARD_STEPS: u16 = 3210;
/// Motors of 247 Hz lose steps above 390 Hz, as those of the other machines.
const PULL_OUT_TICKS: u32 = 2564;

/// What may be typed at the panel.
pub const PANEL: &str = "where, holes, board, reset, close x|y|up|down, open x|y|up|down, free x|y|up|down, push x|y N, \
     power off|on, unplug, plug";

/// The device.
pub struct Device {
    line: Line,
    drill: Drill<MEMORY_BYTES>,
    rig: DrillRig,
    now_us: u64,
    /// The event that waits for its time.
    due: Option<(u64, DrillEvent)>,
    has_power: bool,
    told: Vec<String>,
    /// What is made, where that is kept.
    rows: Option<StepRows>,
}

impl Device {
    /// Switched on, at so many bits a second: as it was, or with its flaws mended.
    pub fn new(bits_per_s: u32, is_original: bool) -> Self {
        let config = if is_original {
            DrillConfig::ORIGINAL
        } else {
            DrillConfig::FIXED
        };
        Self {
            line: Line::new(bits_per_s),
            drill: Drill::new(config),
            rig: DrillRig::new(BEGIN, STROKE_STEPS, BOARD_STEPS, PULL_OUT_TICKS),
            now_us: 0,
            due: None,
            has_power: true,
            told: Vec::new(),
            rows: None,
        }
    }

    /// The same; what it makes is kept. Its states are the wires of each motor, bit 0 for the first one, and the spindle.
    pub fn with_rows(mut self) -> Self {
        self.rows = Some(StepRows::new("dx,dy,dz,lx,ly,lz,spindle"));
        self
    }

    /// One that is small and quick, so that many programs are run in little time.
    #[cfg(test)]
    pub fn quick(is_original: bool) -> Self {
        let mut device = Self::new(2400, is_original);
        let config = DrillConfig {
            rate_hz: [1000; 3],
            back_off_steps: 8,
            stroke_steps: 20,
            settle_ticks: 1000,
            ..if is_original {
                DrillConfig::ORIGINAL
            } else {
                DrillConfig::FIXED
            }
        };
        device.drill = Drill::new(config);
        device.rig = DrillRig::new([3, 0, 2], 6, 3, 0);
        device
    }

    /// The mechanics.
    #[cfg(test)]
    pub fn rig(&self) -> &DrillRig {
        &self.rig
    }

    /// The line.
    #[cfg(test)]
    pub fn line(&mut self) -> &mut Line {
        &mut self.line
    }

    /// Events whose time has come.
    fn happen(&mut self) {
        let mut from_us = self.now_us - PERIOD_US;
        loop {
            if self.due.is_none() {
                let event = self.drill.next_event(&self.rig.inputs());
                let wait_us = match event {
                    DrillEvent::Idle => return,
                    DrillEvent::Step(step) => step.wait_ticks,
                    DrillEvent::Dwell { wait_ticks } => wait_ticks,
                    DrillEvent::Spindle(_) | DrillEvent::Report(_) => 0,
                };
                self.due = Some((from_us + u64::from(wait_us), event));
            }
            let Some((at_us, event)) = self.due.take_if(|(at_us, _)| *at_us <= self.now_us) else {
                return;
            };
            from_us = at_us;
            self.apply(at_us, &event);
            match event {
                DrillEvent::Report(report) => self.told.push(text(report)),
                DrillEvent::Spindle(on) => self
                    .told
                    .push(format!("spindle {}", if on { "on" } else { "off" })),
                _ => {}
            }
        }
    }

    /// Makes an event happen.
    fn apply(&mut self, at_us: u64, event: &DrillEvent) {
        self.rig.apply(event);
        let (wait_ticks, delta) = match *event {
            DrillEvent::Step(step) => (step.wait_ticks, step.delta),
            DrillEvent::Dwell { wait_ticks } if wait_ticks > 0 => (wait_ticks, [0; 3]),
            DrillEvent::Spindle(_) => (0, [0; 3]),
            // Nothing of them is to be seen at the motors.
            DrillEvent::Dwell { .. } | DrillEvent::Report(_) | DrillEvent::Idle => return,
        };
        if let Some(rows) = &mut self.rows {
            let [x, y, z] = self.rig.levels().map(|levels| levels.0);
            let states = [x, y, z, self.rig.spindle_turns().into()];
            rows.push(at_us, wait_ticks, &delta, &states);
        }
    }

    fn place(&self) -> String {
        let [x, y] = self.drill.position_steps();
        let [.., z] = self.rig.place();
        let frame = if self.drill.is_homed() {
            "from home"
        } else {
            "not homed"
        };
        let spindle = if self.rig.spindle_turns() {
            "on"
        } else {
            "off"
        };
        let (holes, bytes) = (self.rig.holes().len(), self.drill.stored().len());
        let lost: u64 = self.rig.lost_steps().iter().sum();
        format!(
            "x {x} y {y} steps {frame}, z {z} below its sensor, spindle {spindle}; {holes} holes, program of {bytes} bytes; {lost} \
             steps lost"
        )
    }

    fn holes_text(&self) -> String {
        let hole = |hole: &DrilledHole| {
            let ([x, y], depth) = (hole.at, hole.depth);
            let how = if hole.is_clean {
                ""
            } else {
                " with a spindle that stood"
            };
            format!("{x},{y} depth {depth}{how}")
        };
        let holes: Vec<_> = self.rig.holes().iter().map(hole).collect();
        format!("{} holes: {}", holes.len(), holes.join("; "))
    }

    fn hold(&mut self, switch: &str, closed: Option<bool>) -> String {
        let Some(number) = ["x", "y", "up", "down"]
            .iter()
            .position(|name| *name == switch)
        else {
            return format!("no switch `{switch}`: there are x, y, up and down");
        };
        self.rig.hold(number, closed);
        let is = match closed {
            Some(true) => "held closed",
            Some(false) => "held open",
            None => "free",
        };
        format!("{switch} is {is}")
    }

    fn push(&mut self, axis: &str, steps: &str) -> String {
        let axis = ["x", "y"].iter().position(|name| *name == axis);
        match (axis, steps.parse()) {
            (Some(axis), Ok(steps)) => format!("pushed by {} steps", self.rig.push(axis, steps)),
            _ => "push x|y by how many steps? As in `push x -40`".into(),
        }
    }

    fn reset(&mut self) {
        self.drill.reset();
        self.due = None;
        // What is in the receiver is gone as well; the spindle stops with the supply of its relay.
        self.apply(self.now_us, &DrillEvent::Spindle(false));
    }
}

/// A report for people.
fn text(report: DrillReport) -> String {
    let letter = |axis: u8| if axis == 0 { "x" } else { "y" };
    match report {
        DrillReport::Homed => "homed".into(),
        DrillReport::Drilled { at: [x, y] } => format!("drilled at {x},{y}"),
        DrillReport::Taught { at: [x, y] } => format!("taught {x},{y}"),
        DrillReport::Fault(fault) => {
            let why = match fault {
                DrillFault::NoSwitch { axis } => {
                    format!("no home switch {} on the longest way", letter(axis))
                }
                DrillFault::StillClosed { axis } => format!(
                    "home switch {} is closed still after the way off it",
                    letter(axis)
                ),
                DrillFault::NotUp => "the upper sensor does not see the spindle".into(),
                DrillFault::NotDown => "the lower sensor does not see the spindle".into(),
                DrillFault::LostSteps { axis } => format!(
                    "home switch {} closed too early: steps were lost",
                    letter(axis)
                ),
                DrillFault::OffTable { axis } => {
                    format!("a record is beyond the table in {}", letter(axis))
                }
            };
            format!("fault: {why}; until a reset nothing moves")
        }
    }
}

impl Emulation for Device {
    const PERIOD_NS: u64 = PERIOD_US * 1000;

    fn send(&mut self, byte: u8) {
        if self.line.send(byte, self.now_us) {
            self.reset();
        }
    }

    fn tick(&mut self) -> Vec<u8> {
        self.now_us += PERIOD_US;
        let now_us = self.now_us;
        while let Some(byte) = self.line.received(now_us) {
            if self.has_power {
                self.drill.push(byte);
            }
        }
        if self.has_power {
            self.happen();
            while let Some(byte) = self.drill.transmit() {
                if self.line.answer(byte, now_us) {
                    self.reset();
                }
            }
        }
        std::iter::from_fn(|| self.line.answered(now_us)).collect()
    }

    fn control(&mut self, line: &str) -> String {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["where"] => self.place(),
            ["holes"] => self.holes_text(),
            ["board"] => {
                self.rig.change_board();
                "a board without holes".into()
            }
            ["reset"] => {
                self.reset();
                "reset".into()
            }
            ["close", switch] => self.hold(switch, Some(true)),
            ["open", switch] => self.hold(switch, Some(false)),
            ["free", switch] => self.hold(switch, None),
            ["push", axis, steps] => self.push(axis, steps),
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
