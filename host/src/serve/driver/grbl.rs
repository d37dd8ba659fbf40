//! The driver of a controller that speaks Grbl's protocol.

mod by_hand;
mod changing;
mod going_on;
mod halting;
mod hearing;
mod jogging;
mod overriding;
mod probing;
mod running;
mod sequence;
mod setting_up;
mod zeroing;

use super::{Desk, Drive, Port, Published, WAITING};
use crate::serve::console_lines::From;
use crate::serve::machine::{Asked, Machine};
use crate::serve::machine_state::{Link, MachineState};
use crate::serve::reply::Reply;
use crate::serve::request::Request;
use going_on::Making;
use halting::Halting;
use husillo_clients::grbl::{Session, Stream};
use husillo_clients::{StopRequests, Wire};
use husillo_sim::device::grbl::Device;
use husillo_transports::grbl::{Realtime, Settings, State};
use jogging::Jogging;
use overriding::Wanted;
use running::Running;
use sequence::Sequence;
use serde_json::Value;
use std::collections::{BTreeMap, VecDeque};
use std::sync::mpsc::Receiver;
use std::time::Duration;
use zeroing::Zeroing;

/// Interval of the requests for a status report. That leaves most of a serial line of 115,200
/// bits/s to the program.
const POLL: Duration = Duration::from_millis(50);
/// The same while a controller moves whose line is not a serial device. It is shown 60 times a
/// second.
const POLL_IN_MOTION: Duration = Duration::from_millis(16);
/// While it homes, a controller may be silent for this time.
const HOMING: Duration = Duration::from_secs(180);
/// Moves that wait in the queue of Grbl.
const QUEUE: usize = 15;

/// Drives Grbl.
#[derive(Debug)]
pub(super) struct Grbl {
    /// Settings of a simulated controller.
    settings: Settings,
    kept: Kept,
}

impl Grbl {
    /// `settings` are those of a simulated controller.
    pub(super) fn new(settings: Settings) -> Self {
        Self {
            settings,
            kept: Kept::default(),
        }
    }

    /// Opens the port and waits for the controller.
    fn connect(&self, port: &Port) -> Result<Session, String> {
        let wire = match port.name.as_str() {
            "sim" => Wire::paced(Device::new(port.baud, self.settings), port.speed),
            name => Wire::open(name, port.baud).map_err(|error| format!("{name}: {error}"))?,
        };
        // A stop that was requested meanwhile is carried out by the driver.
        let mut session = Session::new(wire, StopRequests::default());
        session.begin()?;
        Ok(session)
    }
}

impl Drive for Grbl {
    fn drive(&mut self, port: &Port, desk: Desk<'_>) -> Result<(), String> {
        let session = self.connect(port)?;
        let mut driver = Driver::new(session, desk, &mut self.kept);
        if port.name == "sim" || port.name.starts_with("tcp:") {
            driver.poll_in_motion = POLL_IN_MOTION;
        }
        driver.drive()
    }
}

/// Why a line was sent.
#[derive(Debug)]
enum Purpose {
    /// For a page.
    Asked(Reply),
    /// For a page: homing.
    Home(Reply),
    /// For a page: a new work zero, with the data of the answer. The work zero before it can be
    /// restored.
    Zero(Reply, zeroing::Zero, Value),
    /// For a page: the restored work zero.
    Undo(Reply),
    /// A part of a jog.
    Jog,
    /// A line of a macro or of a move that probes.
    Sequence {
        /// It homes.
        is_home: bool,
    },
    /// A line of the program.
    Program,
    /// To know when the lines before are made.
    Synchronise,
    /// The begin of the change of a tool.
    Change,
    /// For a page: all settings.
    Settings(Reply),
    /// A setting. The list that follows shows whether it was accepted.
    Written,
    /// To know the modes or the settings. The console does not show it.
    Known,
}

/// What outlasts the loss of a controller.
#[derive(Debug, Default)]
struct Kept {
    zeroing: Zeroing,
    running: Running,
}

/// The driver, while its controller answers.
struct Driver<'a> {
    machine: &'a Machine,
    session: Session,
    state: &'a mut MachineState,
    zeroing: &'a mut Zeroing,
    /// A continuation that is being made.
    making: Option<Making>,
    running: &'a mut Running,
    requests: &'a Receiver<Asked>,
    stream: Stream<Purpose>,
    /// Lines that wait for room in the controller.
    waiting: VecDeque<(String, Purpose)>,
    jogging: Jogging,
    sequence: Option<Sequence>,
    halting: Option<Halting>,
    /// Number of the last alarm.
    alarm: Option<u16>,
    /// Moves that wait in the controller at most.
    queue_moves: usize,
    /// Overrides of feed and spindle that the controller has not reached yet.
    wanted: [Option<Wanted>; 2],
    /// Interval of the requests for a status report while something moves.
    poll_in_motion: Duration,
    /// Values of the settings.
    settings: BTreeMap<u16, String>,
    /// The options and the settings are not known. While it moves, a controller refuses to tell
    /// them.
    settings_are_due: bool,
    /// The modes may have changed.
    modes_are_due: bool,
    /// The work zero may have changed. The next report contains it then.
    zero_is_due: bool,
    /// Requests that wait for the modes.
    postponed: VecDeque<Asked>,
    published: Published,
}

impl<'a> Driver<'a> {
    fn new(session: Session, desk: Desk<'a>, kept: &'a mut Kept) -> Self {
        Self {
            machine: desk.machine,
            session,
            state: desk.state,
            zeroing: &mut kept.zeroing,
            making: None,
            running: &mut kept.running,
            requests: desk.requests,
            stream: Stream::new(),
            waiting: VecDeque::new(),
            jogging: Jogging::default(),
            sequence: None,
            halting: None,
            alarm: None,
            queue_moves: QUEUE,
            wanted: [None, None],
            poll_in_motion: POLL,
            settings: BTreeMap::new(),
            settings_are_due: true,
            modes_are_due: true,
            zero_is_due: true,
            postponed: VecDeque::new(),
            published: Published::new(),
        }
    }

    /// Drives until the program ends.
    ///
    /// # Errors
    ///
    /// The controller is lost: a sentence.
    fn drive(mut self) -> Result<(), String> {
        self.state.link = Link::Up;
        self.state.why = None;
        self.machine.tell(From::Server, "the controller answers");
        let ended = self.turns();
        self.drop_lines(match &ended {
            Ok(()) => "this program has ended",
            Err(_) => "the controller is lost",
        });
        self.state.program = self.program_shown();
        self.note_run();
        ended
    }

    fn turns(&mut self) -> Result<(), String> {
        loop {
            if self.machine.is_ending() && self.rests() && self.halting.is_none() {
                return Ok(());
            }
            if self.machine.is_ending() && self.halting.is_none() {
                self.machine.stop.request();
            }
            self.halt()?;
            for _ in 0..WAITING {
                let Ok(asked) = self.requests.try_recv() else {
                    break;
                };
                self.carry_out(asked)?;
            }
            self.jog()?;
            self.take_continuation();
            self.feed_sequence();
            self.ask_modes();
            self.carry_out_postponed()?;
            self.send_waiting()?;
            self.feed_program()?;
            let poll = match self.session.is_in_motion() {
                true => self.poll_in_motion,
                false => POLL,
            };
            self.session.poll_every(poll);
            if let Some(heard) = self.session.turn()? {
                self.hear(heard)?;
            }
            self.publish();
        }
    }

    /// Whether nothing moves, and nothing that was sent will move. During a dwell Grbl reports
    /// that it is idle.
    fn rests(&self) -> bool {
        !self.session.is_in_motion()
            && !self.session.is_held()
            && self.is_quiet()
            && self.sequence.is_none()
            && !self.running.course.is_active()
    }

    /// Publishes the state if it has changed, and not too often.
    fn publish(&mut self) {
        self.state.jog = self.jogging.shown();
        self.state.stopping = self.halting.is_some();
        self.state.undo = self.zeroing.count();
        if self.is_homing() {
            // Grbl sends no reports while it homes.
            self.state.state = Some("Home");
        }
        self.state.program = self.program_shown();
        self.note_run();
        self.published.update(self.machine, self.state);
    }

    /// Sends a line as soon as the controller has room for it. The console shows it.
    fn send(&mut self, line: impl Into<String>, purpose: Purpose) {
        self.waiting.push_back((line.into(), purpose));
    }

    /// Sends a line whose answer this program wants to know.
    fn send_known(&mut self, line: &str) {
        self.waiting.push_back((line.to_owned(), Purpose::Known));
    }

    /// Sends the lines for which the controller has room.
    fn send_waiting(&mut self) -> Result<(), String> {
        // A held controller takes lines and does not answer them.
        while self.halting.is_none() {
            let next = self.waiting.front();
            if !next.is_some_and(|(line, _)| self.stream.has_room(line)) {
                break;
            }
            let Some((line, purpose)) = self.waiting.pop_front() else {
                break;
            };
            if !matches!(purpose, Purpose::Jog | Purpose::Known) {
                self.machine.tell(From::Host, line.as_str());
            }
            if is_home(&purpose) {
                self.session.allow_silence(Some(HOMING));
            }
            self.session.put(format!("{line}\n").as_bytes())?;
            self.stream.sent(&line, purpose);
        }
        Ok(())
    }

    /// Sends a byte that takes effect at once.
    fn put(&mut self, byte: Realtime) -> Result<(), String> {
        let name = match byte {
            Realtime::Reset => "0x18 (reset)",
            Realtime::Hold => "! (hold)",
            Realtime::Resume => "~ (resume)",
            Realtime::JogCancel => "0x85 (jog cancel)",
            Realtime::Feed(_) => "feed override",
            Realtime::Rapid(_) => "rapid override",
            Realtime::Spindle(_) => "spindle override",
            Realtime::SpindleStop => "0x9E (spindle stop)",
            Realtime::Flood => "0xA0 (flood)",
            Realtime::Mist => "0xA1 (mist)",
            Realtime::Unknown(0xa3) => "0xA3 (take over while the tool is changed)",
            Realtime::Door | Realtime::Status | Realtime::Unknown(_) => "",
        };
        self.machine.tell(From::Host, name);
        self.session.put(&[byte.byte()])
    }

    /// Asks for the settings, the modes and the length of the tool, when all lines are answered.
    fn ask_modes(&mut self) {
        let state = self.session.state();
        let is_active = self.running.course.is_active();
        let is_idle = matches!(state, Some(State::Idle | State::Alarm | State::Tool))
            && (!is_active || self.is_changing());
        if !is_idle || !self.stream.is_empty() || !self.waiting.is_empty() {
            return;
        }
        if self.settings_are_due && !is_active && state != Some(State::Tool) {
            self.settings_are_due = false;
            self.send_known("$I");
            self.send_known("$$");
        }
        if std::mem::take(&mut self.modes_are_due) {
            self.send_known("$G");
            self.send_known("$#");
        }
    }

    /// Whether the modes and the work zero will be known soon.
    fn modes_are_pending(&self) -> bool {
        self.settings_are_due
            || self.modes_are_due
            || self.zero_is_due
            || !self.stream.is_empty()
            || !self.waiting.is_empty()
    }

    /// Carries out the requests that have waited for the modes.
    fn carry_out_postponed(&mut self) -> Result<(), String> {
        if self.modes_are_pending() && self.stands().is_ok() {
            return Ok(());
        }
        while let Some(asked) = self.postponed.pop_front() {
            match self.machine.control.operator() == Some(asked.client) {
                true => self.carry_out(asked)?,
                false => asked.reply.error("take control first"),
            }
        }
        Ok(())
    }

    /// Whether the machine homes, or a line that homes is not answered.
    fn is_homing(&self) -> bool {
        self.session.state() == Some(State::Home) || self.stream.purposes().any(is_home)
    }

    /// Whether all lines are answered, except those that this program itself has sent to know
    /// something.
    fn is_quiet(&self) -> bool {
        let is_known = |purpose: &Purpose| matches!(purpose, Purpose::Known);
        self.stream.purposes().all(is_known) && self.waiting.iter().all(|(_, of)| is_known(of))
    }

    /// Forgets all lines that wait or are not answered. Those who asked get the reason.
    fn drop_lines(&mut self, why: &str) {
        let waiting = self.waiting.drain(..).map(|(_, purpose)| purpose);
        let purposes: Vec<_> = self.stream.clear().chain(waiting).collect();
        for purpose in purposes {
            match purpose {
                Purpose::Asked(reply)
                | Purpose::Home(reply)
                | Purpose::Zero(reply, ..)
                | Purpose::Undo(reply)
                | Purpose::Settings(reply) => reply.error(why),
                Purpose::Jog
                | Purpose::Known
                | Purpose::Program
                | Purpose::Sequence { .. }
                | Purpose::Synchronise
                | Purpose::Change
                | Purpose::Written => {}
            }
        }
        for asked in self.postponed.drain(..) {
            asked.reply.error(why);
        }
        self.forget_making(why);
        self.jogging.forget();
        self.end_sequence(why);
        self.end_program(why);
        self.session.allow_silence(None);
    }

    /// Carries out a request of a page.
    fn carry_out(&mut self, asked: Asked) -> Result<(), String> {
        let goes_on = matches!(asked.request, Request::Resume) && self.is_changing();
        let needs_modes = asked.request.needs_modes() || goes_on;
        let must_wait = needs_modes && self.modes_are_pending();
        if must_wait && self.stands().is_ok() && self.postponed.len() < WAITING {
            self.postponed.push_back(asked);
            return Ok(());
        }
        let Asked {
            client,
            request,
            reply,
        } = asked;
        if self.halting.is_some() {
            reply.error("the machine is being stopped");
            return Ok(());
        }
        if !self.machine.permits(client, &request) {
            reply.error("take control first");
            return Ok(());
        }
        match request {
            Request::Hold => return self.put(Realtime::Hold).map(|()| reply.ok()),
            Request::Resume => return self.resume(reply),
            Request::Reset => {
                reply.ok();
                return self.begin_halt(true, "the controller was reset");
            }
            Request::Override { what, percent } => {
                let done = self.set_override(what, percent)?;
                reply.with(done);
            }
            Request::Toggle { what } => {
                let done = self.toggle(what)?;
                reply.with(done);
            }
            Request::Jog {
                jog, axes, feed, ..
            } => {
                let begun = self.begin_jog(client, jog, &axes, feed);
                if begun.is_err() {
                    self.machine.lease.release(client, jog);
                }
                reply.with(begun);
            }
            Request::UndoZero => self.undo_zero(reply),
            Request::Zero { at_mm } => self.zero(&at_mm, reply),
            Request::Unlock => self.by_hand("$X", reply, Purpose::Asked),
            Request::Home { axis } => self.home(axis, reply),
            Request::Step { move_mm, feed } => self.step(&move_mm, feed, reply),
            Request::Goto {
                to_mm, frame, feed, ..
            } => self.go(&to_mm, frame, feed, reply),
            Request::Line { text } => return self.line(&text, reply),
            Request::Run { confirmed, from } => match from {
                None => self.run(confirmed, reply),
                Some(line) if confirmed => self.go_on(line, reply),
                Some(line) => self.show_from(line, reply),
            },
            Request::SingleBlock { on } => self.set_single_block(on, reply),
            Request::Breakpoints { lines } => self.set_breakpoints(lines, reply),
            Request::Unload => self.unload(reply),
            Request::Load(program) => self.load(program, reply),
            Request::Surroundings(to) => {
                // If nobody waits any more, nobody needs them.
                let _ = to.try_send(self.surroundings());
            }
            Request::Settings => self.by_hand("$$", reply, Purpose::Settings),
            Request::SettingsDiff { values } => reply.data(self.settings_diff(&values)),
            Request::SettingsSave { values } => self.save_settings(&values, reply),
            Request::Probe(asked) => self.probe(&asked, reply),
            Request::MacroRun { name } => self.run_macro(&name, reply),
            Request::Stop
            | Request::Macros
            | Request::MacroSave { .. }
            | Request::MacroDelete { .. }
            | Request::Take { .. }
            | Request::Give
            | Request::Renew { .. }
            | Request::Release { .. } => {}
            _ => reply.error("this is for a machine of another family"),
        }
        Ok(())
    }
}

const fn is_home(purpose: &Purpose) -> bool {
    matches!(
        purpose,
        Purpose::Home(_) | Purpose::Sequence { is_home: true }
    )
}
