//! What the driver of a drill has beside the link: the state, the requests, the program.

use super::Published;
use super::jogging::Jogging;
use super::placing::Placement;
use super::running::Running;
use crate::serve::console_lines::From;
use crate::serve::drill_program::millimetres;
use crate::serve::driver::WAITING;
use crate::serve::driver::phase::Phase;
use crate::serve::loaded::{Surroundings, Target};
use crate::serve::machine::{Asked, Machine};
use crate::serve::machine_state::MachineState;
use crate::serve::reply::Reply;
use crate::serve::request::Request;
use crate::serve::tool_path::Motion;
use husillo_clients::drill::Place;
use husillo_transports::drill::MEMORY_BYTES;
use std::sync::mpsc::Receiver;
use std::time::Duration;

/// Records that the memory of the drill holds.
const MEMORY_RECORDS: u16 = (MEMORY_BYTES / 3) as u16;

/// What works.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Work {
    /// Nothing.
    #[default]
    None,
    /// All axes are homed.
    Home,
    /// X moves.
    X,
    /// Y moves.
    Y,
    /// Z moves.
    Z,
    /// A record is sent.
    Receive,
}

/// Everything but the link.
pub(super) struct Bench<'a> {
    pub(super) machine: &'a Machine,
    pub(super) state: &'a mut MachineState,
    pub(super) requests: &'a Receiver<Asked>,
    pub(super) running: &'a mut Running,
    pub(super) jogging: Jogging,
    /// Where the drill is.
    pub(super) place: Option<Place>,
    pub(super) work: Work,
    pub(super) is_manual: bool,
    /// The advance of the manual mode, steps.
    pub(super) advance: u8,
    pub(super) has_spindle: bool,
    pub(super) heartbeats: u64,
    /// Positions that were taught since the memory was cleared, steps.
    pub(super) taught: Vec<[u16; 2]>,
    /// A board that is being placed.
    pub(super) placement: Option<Placement>,
    /// Why everything is being stopped.
    pub(super) halting: Option<&'static str>,
    /// Time of the link.
    pub(super) now: Duration,
    published: Published,
}

impl<'a> Bench<'a> {
    pub(super) fn new(
        machine: &'a Machine,
        state: &'a mut MachineState,
        requests: &'a Receiver<Asked>,
        running: &'a mut Running,
    ) -> Self {
        Self {
            machine,
            state,
            requests,
            running,
            jogging: Jogging::default(),
            place: None,
            work: Work::None,
            is_manual: false,
            advance: 0,
            has_spindle: false,
            heartbeats: 0,
            taught: Vec::new(),
            placement: None,
            halting: None,
            now: Duration::ZERO,
            published: Published::new(),
        }
    }

    /// Answers pages while something moves.
    pub(super) fn attend(&mut self) {
        for _ in 0..WAITING {
            let Ok(asked) = self.requests.try_recv() else {
                break;
            };
            let Asked {
                client,
                request,
                reply,
            } = asked;
            match request {
                _ if self.halting.is_some() => reply.error("the machine is being stopped"),
                _ if !self.machine.permits(client, &request) => reply.error("take control first"),
                Request::Jog { jog, ref axes, .. } if self.jogging.is_active() => {
                    reply.with(self.begin_jog(client, jog, axes));
                }
                request => self.settle(request, reply),
            }
        }
        self.show();
    }

    /// Carries out what needs no step on the link.
    pub(super) fn settle(&mut self, request: Request, reply: Reply) {
        match request {
            Request::Hold => reply.with(self.running.course.pause()),
            Request::Resume => reply.with(self.running.course.resume()),
            Request::SingleBlock { on } => {
                self.running.course.single_block = on;
                reply.ok();
            }
            Request::Breakpoints { lines } => {
                self.running.course.breakpoints = lines.into_iter().collect();
                reply.ok();
            }
            Request::Surroundings(to) => {
                // If nobody waits any more, nobody needs them.
                let _ = to.try_send(surroundings());
            }
            Request::Jog { jog, .. } => {
                self.machine.lease.release(self.jogging.client(), jog);
                reply.error("the machine moves");
            }
            Request::Unlock
            | Request::Reset
            | Request::Line { .. }
            | Request::Override { .. }
            | Request::Toggle { .. }
            | Request::UndoZero
            | Request::Probe(_)
            | Request::MacroRun { .. }
            | Request::Settings
            | Request::SettingsDiff { .. }
            | Request::SettingsSave { .. }
            | Request::Pace { .. }
            | Request::Backlash { .. } => reply.error("a drill does not have this"),
            _ if self.running.course.is_active() => reply.error("a program runs"),
            _ => reply.error("the machine moves"),
        }
    }

    /// Whether an order by hand may be carried out.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    pub(super) fn is_free(&self) -> Result<(), String> {
        if self.running.course.is_active() {
            return Err("a program runs".into());
        }
        if self.placement.as_ref().is_some_and(Placement::is_wanted) {
            return Err("the board is being placed: wait, or press STOP".into());
        }
        match self.jogging.is_active() {
            true => Err("the machine jogs".into()),
            false => Ok(()),
        }
    }

    /// Whether everything must be stopped.
    pub(super) fn must_halt(&mut self) -> bool {
        let has_left = self.machine.take_left() && !self.running.course.is_active();
        if self.machine.stop.is_asked() {
            self.halting = Some("stopped");
        } else if has_left && self.halting.is_none() {
            self.halting = Some("its operator has gone");
        } else if self.machine.is_ending() {
            self.halting = Some("this program has ended");
        }
        self.halting.is_some()
    }

    /// Steps of X and Y from the zero.
    pub(super) fn at(&self) -> [u16; 2] {
        self.place.map_or([0; 2], |place| place.machine.place_steps)
    }

    /// Steps of the zero from the switches.
    pub(super) fn zero(&self) -> [u16; 2] {
        self.place.map_or([0; 2], |place| place.machine.zero_steps)
    }

    /// An axis is there, by its steps from the zero.
    pub(super) fn moved(&mut self, axis: usize, to: u16, motion: Motion) {
        if let Some(place) = &mut self.place {
            if let Some(at) = place.machine.place_steps.get_mut(axis) {
                *at = to;
            }
        }
        self.draw(motion);
    }

    /// The path begins where the drill is.
    pub(super) fn begin_path(&self) {
        self.draw(Motion::Begin);
    }

    pub(super) fn draw(&self, motion: Motion) {
        let [x, y] = self.machine_mm().map(|mm| (mm * 1e6).round() as i64);
        self.machine.path.to(motion, [x, y, 0]);
        self.machine.drawn();
    }

    fn machine_mm(&self) -> [f64; 2] {
        let ([x, y], [zero_x, zero_y]) = (self.at(), self.zero());
        [x.saturating_add(zero_x), y.saturating_add(zero_y)].map(millimetres)
    }

    /// What a simulated drill shows on its panel.
    pub(super) fn tell_reports(&self, reports: Vec<String>) {
        for line in reports {
            self.machine.tell(From::Controller, line);
        }
    }

    /// Publishes the state if it has changed, and not too often.
    pub(super) fn show(&mut self) {
        self.state.stopping = self.halting.is_some();
        self.state.state = Some(self.word());
        self.state.jog = self.jogging.shown();
        let place = self.place;
        let is_homed = place.is_some_and(|place| place.machine.is_homed);
        self.state.advice = (!is_homed).then_some(
            "the drill is not homed: it counts from where it was switched on; home it first",
        );
        self.state.machine_mm = Some(self.machine_mm().to_vec());
        self.state.work_mm = Some(self.at().map(millimetres).to_vec());
        self.state.zero_mm = Some(self.zero().map(millimetres).to_vec());
        let lights = self.lights();
        let taught_mm = self.taught.iter().map(|at| at.map(millimetres)).collect();
        if let Some(drill) = &mut self.state.drill {
            drill.is_homed = is_homed;
            drill.is_manual = self.is_manual;
            drill.steps = place.map_or([0; 2], |place| place.machine.place_steps);
            drill.z = place.map_or("between", |place| {
                match (place.machine.is_up, place.machine.is_down) {
                    (true, _) => "up",
                    (_, true) => "down",
                    _ => "between",
                }
            });
            drill.spindle = self.has_spindle;
            drill.lights = lights;
            drill.heartbeats = self.heartbeats;
            drill.records = place.and_then(|place| place.records);
            drill.taught_mm = taught_mm;
        }
        self.state.program = self.program_shown();
        self.note_run();
        self.published.update(self.machine, self.state);
    }

    /// The lamps of the panel that are lit, as far as the link tells.
    fn lights(&self) -> Vec<&'static str> {
        let is_full = |place: Place| place.records.is_some_and(|count| count >= MEMORY_RECORDS);
        let lamps = [
            ("x", self.work == Work::X),
            ("y", self.work == Work::Y),
            ("home", self.work == Work::Home),
            ("drill", self.has_spindle || self.work == Work::Z),
            ("manual", self.is_manual),
            ("ready", self.work == Work::None),
            ("receive", self.work == Work::Receive),
            ("full", self.place.is_some_and(is_full)),
        ];
        let lit = lamps.into_iter().filter(|(_, is_lit)| *is_lit);
        lit.map(|(name, _)| name).collect()
    }

    /// The state as a word.
    fn word(&self) -> &'static str {
        match self.work {
            Work::Home => "Home",
            _ if self.jogging.is_active() => "Jog",
            _ if self.running.course.phase() == Phase::Running => "Run",
            Work::None | Work::Receive => "Idle",
            _ => "Run",
        }
    }
}

/// What a program is checked against: the table, wherever the drill is.
pub(super) const fn surroundings() -> Surroundings {
    Surroundings {
        target: Target::Drill,
        zero_mm: Vec::new(),
        at_mm: Vec::new(),
    }
}
