//! A host, a line with faults, the controller of the drill and its mechanics, in virtual time.

use husillo_controllers::{Drill, DrillConfig, DrillEvent, DrillReport};
use husillo_sim::DrillRig;
use husillo_transports::drill::{Host, Outcome, Progress, Refused, Rules, Step, Timing};

/// Time of a character at 2400 baud.
const CHARACTER_US: u32 = 4167;
/// Distance from one sensor of Z to the other, and to the board, in steps.
pub const STROKE: u16 = 6;
pub const BOARD: u16 = 3;

/// A fault of one byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    Lost,
    Doubled,
    Flipped(u8),
    /// Delayed by more than the host waits for an echo and less than it waits for a late one; also
    /// by more than that.
    Late(u32),
}

/// An event at the given byte, counted in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    Byte(Fault),
    /// The button, or a power cycle.
    Reset,
    /// No byte gets through from here on.
    Unplugged,
}

/// Every event.
pub fn events() -> impl Iterator<Item = Event> {
    let bytes = (0..8).map(Fault::Flipped).chain([
        Fault::Lost,
        Fault::Doubled,
        Fault::Late(30_000),
        Fault::Late(60_000),
        Fault::Late(200_000),
    ]);
    bytes
        .map(Event::Byte)
        .chain([Event::Reset, Event::Unplugged])
}

/// A fast and small machine, so that many programs run in little time.
pub fn quick(rules: Rules) -> DrillConfig {
    DrillConfig {
        rate_hz: [1000; 3],
        back_off_steps: 8,
        search_steps: 70_000,
        stroke_steps: 20,
        shortest_stroke_steps: Some(STROKE),
        travel_steps: [u16::MAX; 2],
        settle_ticks: 1000,
        rules,
        ..DrillConfig::FIXED
    }
}

/// The complete set-up.
pub struct Bench<const N: usize> {
    pub host: Host,
    pub drill: Drill<N>,
    pub rig: DrillRig,
    pub reports: Vec<DrillReport>,
    /// Every switching of the spindle: on or off, and the positions of the axes.
    pub switched: Vec<(bool, [i32; 3])>,
    now_us: u32,
    /// The event that waits for its time.
    due: Option<(u32, DrillEvent)>,
    /// Bytes in flight in both directions: arrival time, whether to the host, and value.
    flying: Vec<(u32, bool, u8)>,
    pub carried: u64,
    pub event: Option<(u64, Event)>,
    pub is_unplugged: bool,
    free_us: [u32; 2],
}

impl<const N: usize> Bench<N> {
    pub fn new(config: DrillConfig) -> Self {
        let mut bench = Bench {
            host: Host::new(Timing::of(2400, 600_000_000), N as u32),
            drill: Drill::new(config),
            rig: DrillRig::new([3, 0, 2], STROKE, BOARD, 0),
            reports: Vec::new(),
            switched: Vec::new(),
            now_us: 0,
            due: None,
            flying: Vec::new(),
            carried: 0,
            event: None,
            is_unplugged: false,
            free_us: [0; 2],
        };
        assert_eq!(bench.run(Step::AwaitBoot), Ok(Outcome::Done));
        bench
    }

    fn send(&mut self, to_host: bool, byte: u8) {
        let number = self.carried;
        self.carried += 1;
        let free_us = &mut self.free_us[usize::from(to_host)];
        let begin_us = self.now_us.max(*free_us);
        *free_us = begin_us + CHARACTER_US;
        let arrives_us = begin_us + CHARACTER_US;
        let event = self.event.filter(|(at, _)| *at == number);
        match event {
            Some((_, Event::Unplugged)) => self.is_unplugged = true,
            Some((_, Event::Reset)) => {
                self.reset();
                return;
            }
            _ => {}
        }
        if self.is_unplugged {
            return;
        }
        let mut fly = |us, byte| self.flying.push((us, to_host, byte));
        match event {
            Some((_, Event::Byte(Fault::Lost))) => {}
            Some((_, Event::Byte(Fault::Doubled))) => {
                fly(arrives_us, byte);
                fly(arrives_us + CHARACTER_US, byte);
                self.free_us[usize::from(to_host)] += CHARACTER_US;
            }
            Some((_, Event::Byte(Fault::Flipped(bit)))) => fly(arrives_us, byte ^ (1 << bit)),
            Some((_, Event::Byte(Fault::Late(us)))) => fly(arrives_us + us, byte),
            _ => fly(arrives_us, byte),
        }
    }

    /// Resets the controller during a step or between two steps.
    pub fn reset(&mut self) {
        self.drill.reset();
        self.due = None;
        self.flying.clear();
    }

    /// Runs everything for one millisecond.
    pub fn tick(&mut self) {
        self.now_us += 1000;
        let now_us = self.now_us;
        if self.flying.iter().any(|one| one.0 <= now_us) {
            let (mut arrived, flying): (Vec<_>, Vec<_>) =
                self.flying.iter().partition(|one| one.0 <= now_us);
            self.flying = flying;
            arrived.sort_by_key(|one| one.0);
            for (_, to_host, byte) in arrived {
                if to_host {
                    self.host.push(byte, now_us);
                } else {
                    self.drill.push(byte);
                }
            }
        }
        let mut from_us = now_us - 1000;
        loop {
            if self.due.is_none() {
                let event = self.drill.next_event(&self.rig.inputs());
                let wait_us = match event {
                    DrillEvent::Idle => break,
                    DrillEvent::Step(step) => step.wait_ticks,
                    DrillEvent::Dwell { wait_ticks } => wait_ticks,
                    DrillEvent::Spindle(_) | DrillEvent::Report(_) => 0,
                };
                self.due = Some((from_us + wait_us, event));
            }
            let Some((at_us, event)) = self.due.take_if(|(at_us, _)| *at_us <= now_us) else {
                break;
            };
            from_us = at_us;
            self.rig.apply(&event);
            match event {
                DrillEvent::Report(report) => self.reports.push(report),
                DrillEvent::Spindle(on) => self.switched.push((on, self.rig.place())),
                _ => {}
            }
        }
        while let Some(byte) = self.drill.transmit() {
            self.send(true, byte);
        }
    }

    /// Starts a step that can start.
    pub fn start(&mut self, step: Step) {
        self.host.start(step, self.now_us).expect("it can begin");
    }

    /// Runs one millisecond of it; returns the outcome at its end.
    pub fn advance(&mut self) -> Option<Outcome> {
        if let Some(byte) = self.host.transmit(self.now_us) {
            self.send(false, byte);
        }
        if let Progress::Done(outcome) = self.host.poll(self.now_us) {
            return Some(outcome);
        }
        self.tick();
        None
    }

    pub fn run(&mut self, step: Step) -> Result<Outcome, Refused> {
        self.host.start(step, self.now_us)?;
        for _ in 0..3_000_000 {
            if let Some(outcome) = self.advance() {
                return Ok(outcome);
            }
        }
        panic!("the host hangs in {step:?}");
    }

    /// Runs steps that must all succeed.
    pub fn all(&mut self, steps: &[Step]) {
        for step in steps {
            assert_eq!(self.run(*step), Ok(Outcome::Done), "{step:?}");
        }
    }

    /// Homes, clears, stores and runs; the first failure ends it.
    pub fn program(&mut self, bytes: &[u8]) -> Result<(), (Step, Outcome)> {
        let body = bytes.iter().map(|byte| Step::Store(*byte));
        let steps = [Step::Home, Step::Clear, Step::Begin]
            .into_iter()
            .chain(body)
            .chain([Step::End, Step::Execute, Step::Test]);
        for step in steps {
            match self.run(step) {
                Ok(Outcome::Done) => {}
                Ok(outcome) => return Err((step, outcome)),
                Err(refused) => panic!("{step:?}: {refused}"),
            }
        }
        Ok(())
    }

    /// Runs until nothing is in progress.
    pub fn rest(&mut self) {
        for _ in 0..300 {
            self.tick();
        }
        while self.drill.is_working() && !self.stands_for_a_fault() {
            self.tick();
        }
    }

    pub fn stands_for_a_fault(&self) -> bool {
        matches!(self.reports.last(), Some(DrillReport::Fault(_)))
    }

    /// Positions of finished holes in order. A hole that was interrupted and drilled again at the
    /// same position counts once.
    pub fn drilled(&self) -> Vec<[i32; 2]> {
        let whole = self
            .rig
            .holes()
            .iter()
            .filter(|hole| hole.depth == i32::from(STROKE));
        whole.map(|hole| hole.at).collect()
    }
}

/// Records of holes at these positions.
pub fn records(holes: &[[u16; 2]]) -> Vec<u8> {
    let hole = |[x, y]: &[u16; 2]| {
        let ([x0, x1], [y0, y1]) = (x.to_le_bytes(), y.to_le_bytes());
        [b'X', x0, x1, b'Y', y0, y1, b'Z', 0, 0]
    };
    holes.iter().flat_map(hole).collect()
}
