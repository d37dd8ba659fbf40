//! The driver of a measuring machine.
//!
//! The motions of a head last until they end, so a second thread owns it ([`mod@work`]). This one
//! carries out requests meanwhile, and stops the head.

mod hands;
mod jogging;
mod measured;
mod orders;
mod paced_port;
mod place;
mod routines;
mod work;

use super::{Desk, Drive, Port, Published};
use crate::serve::console_lines::From;
use crate::serve::machine::{Asked, Machine};
use crate::serve::machine_state::{Link, MachineState};
use crate::serve::reply::Reply;
use crate::serve::request::Request;
use hands::Hands;
use husillo_metrology::heads::{self, Stylus};
use husillo_metrology::simulated::SimulatedNetwork;
use jogging::NextJog;
use place::Place;
use routines::Routines;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;
use work::{Event, Job, Kept, Setup, work};

/// The longest wait for an event in one turn.
const TURN: Duration = Duration::from_millis(20);
/// Events of one turn. Requests and stops do not wait for more.
const MOST_EVENTS: usize = 500;
/// Why requests are refused between a STOP and the rest of the axes.
const STOPPING: &str = "the machine is being stopped";

/// Drives a measuring machine.
#[derive(Debug)]
pub(super) struct Measuring {
    name: String,
    machine: heads::Machine,
    network: SimulatedNetwork,
    /// The tip in use. It stays when the modules are lost.
    tip: Stylus,
    routines: Routines,
}

impl Measuring {
    /// A machine by its name or the path of its file, and its modules in a simulation.
    pub(super) fn new(name: String, machine: heads::Machine, network: SimulatedNetwork) -> Self {
        Self {
            name,
            tip: machine.probe.stylus,
            machine,
            network,
            routines: Routines::default(),
        }
    }
}

impl Drive for Measuring {
    fn drive(&mut self, port: &Port, desk: Desk<'_>) -> Result<(), String> {
        let setup = Setup {
            name: self.name.clone(),
            machine: self.machine.clone(),
            network: self.network.clone(),
            tip: self.tip,
            port: Port {
                name: port.name.clone(),
                ..*port
            },
        };
        let hands = Arc::new(Hands::default());
        let (jobs, asked) = channel();
        let (heard, events) = channel();
        let worker = {
            let hands = Arc::clone(&hands);
            std::thread::spawn(move || work(&setup, &hands, &asked, &heard))
        };
        let driver = Driver {
            machine: desk.machine,
            config: &self.machine,
            place: Place::new(&self.machine),
            state: desk.state,
            requests: desk.requests,
            tip: &mut self.tip,
            routines: &mut self.routines,
            hands,
            jobs,
            events: &events,
            current: None,
            next_jog: None,
            is_stopping: false,
            published: Published::new(),
        };
        let ended = driver.drive();
        // Without jobs the thread ends, and keeps homes and zeros.
        drop(events);
        worker
            .join()
            .map_err(|_| "the thread of the head has failed")?;
        ended
    }
}

/// What the head does.
#[derive(Debug)]
enum Purpose {
    /// Something that a page waits for.
    Asked(Reply),
    /// A jog of a page.
    Jog { client: u64, number: u64 },
    /// A routine.
    Routine,
}

/// The driver, while the modules answer.
struct Driver<'a> {
    machine: &'a Machine,
    config: &'a heads::Machine,
    place: Place,
    state: &'a mut MachineState,
    requests: &'a Receiver<Asked>,
    tip: &'a mut Stylus,
    routines: &'a mut Routines,
    hands: Arc<Hands>,
    jobs: Sender<Job>,
    events: &'a Receiver<Event>,
    /// What the head does, and the word for it.
    current: Option<(Purpose, &'static str)>,
    next_jog: Option<NextJog>,
    is_stopping: bool,
    published: Published,
}

impl Driver<'_> {
    /// Drives until the program ends.
    fn drive(mut self) -> Result<(), String> {
        let ended = self.turns();
        self.machine.lease.end();
        self.hands.steer(None);
        if self.current.is_some() {
            self.hands.stop();
        }
        let why = match &ended {
            Ok(()) => "this program has ended",
            Err(_) => "the controller is lost",
        };
        if let Some((Purpose::Asked(reply), _)) = self.current.take() {
            reply.error(why);
        }
        if let Some(next) = self.next_jog.take() {
            next.refuse(why);
        }
        self.routines.end(why);
        ended
    }

    fn turns(&mut self) -> Result<(), String> {
        loop {
            if self.machine.is_ending() {
                if self.current.is_none() {
                    return Ok(());
                }
                self.machine.stop.request();
            }
            self.halt();
            self.follow_jog();
            while let Ok(asked) = self.requests.try_recv() {
                self.carry_out(asked);
            }
            self.hear()?;
            self.show();
        }
    }

    /// Hears of the head.
    fn hear(&mut self) -> Result<(), String> {
        let mut event = match self.events.recv_timeout(TURN) {
            Ok(event) => event,
            Err(RecvTimeoutError::Timeout) => return Ok(()),
            Err(RecvTimeoutError::Disconnected) => return Err("the controller is lost".into()),
        };
        for _ in 0..MOST_EVENTS {
            self.take(event)?;
            match self.events.try_recv() {
                Ok(next) => event = next,
                Err(_) => break,
            }
        }
        Ok(())
    }

    fn take(&mut self, event: Event) -> Result<(), String> {
        match event {
            Event::Up(kept) => {
                self.state.link = Link::Up;
                self.state.why = None;
                self.state.controller = Some(self.config.title.clone());
                let letters = self.config.axes.iter().map(|axis| axis.letter);
                self.state.axes = letters.collect();
                self.tell("the modules answer, and their servos are on");
                match kept {
                    Kept::All => self.tell("zero and home are kept from before"),
                    Kept::Lost => {
                        self.tell("the modules were reset or moved, so zero and home are lost")
                    }
                    Kept::NoneBefore => {}
                }
                self.place.begin(&self.machine.path);
            }
            Event::Lost(why) => return Err(why),
            Event::At(position, is_pressed) => {
                self.place.set_pressed(is_pressed);
                let motion = self.motion();
                // At rest the axes are reported with the zero that they have by then.
                if self.current.is_some() && self.place.at(position, motion, &self.machine.path) {
                    self.machine.drawn();
                }
            }
            Event::Axes(axes, held) => self.place.rests(axes, held),
            Event::Exchange(exchange) => self.place.exchange(exchange),
            Event::Note(text) => self.tell(&text),
            Event::Touched(touched) => {
                let text = self.place.touched(&touched);
                self.machine.tell(From::Controller, text);
            }
            Event::Tip(tip) => {
                *self.tip = *tip;
                self.place.tip(*tip);
            }
            Event::Line(line) => self.routines.line(line),
            Event::Feature(feature) => self.routines.feature(feature),
            Event::Waits(line) => self.routines.waits(line),
            Event::Measured(measured) => self.routines.measured(*measured, self.machine),
            Event::Ended(result, is_stopped) => self.ended(result, is_stopped),
        }
        Ok(())
    }

    /// The head has ended what it did.
    fn ended(&mut self, result: Result<(), String>, is_stopped: bool) {
        let Some((purpose, _)) = self.current.take() else {
            return;
        };
        self.place.set_target(None);
        // A stop that came too late stops nothing else.
        self.hands.take_stopped();
        let is_stopped = is_stopped || self.is_stopping;
        if is_stopped {
            self.stopped();
        }
        match purpose {
            Purpose::Asked(reply) => {
                if let Err(why) = &result {
                    self.tell(why);
                }
                reply.with(result);
            }
            Purpose::Jog { client, number } => {
                self.jog_ended(client, number, &result, is_stopped);
            }
            Purpose::Routine => {
                if let Err(why) = &result {
                    self.tell(why);
                }
                self.routines.ended(result, is_stopped);
            }
        }
    }

    /// Publishes the state if it has changed, and not too often.
    fn show(&mut self) {
        if self.state.link != Link::Up {
            return self.published.update(self.machine, self.state);
        }
        self.state.stopping = self.is_stopping;
        self.state.state = Some(self.current.as_ref().map_or("Idle", |(_, word)| word));
        self.state.jog = match &self.current {
            Some((Purpose::Jog { client, number }, _)) => {
                Some(serde_json::json!({"client": client, "jog": number}))
            }
            _ => None,
        };
        self.state.advice = (!self.place.is_homed()).then_some(
            "not every axis is homed: such an axis is slow, and its travel counts from where it \
             was switched on",
        );
        self.place.show(self.state, self.routines);
        self.published.update(self.machine, self.state);
    }

    fn tell(&self, text: &str) {
        self.machine.tell(From::Server, text);
    }

    /// Carries out a request of a page.
    fn carry_out(&mut self, asked: Asked) {
        let Asked {
            client,
            request,
            reply,
        } = asked;
        if self.state.link != Link::Up {
            return reply.error("the controller is lost");
        }
        let is_stopping = self.is_stopping || self.machine.stop.is_asked();
        if is_stopping && request.needs_control() {
            return reply.error(STOPPING);
        }
        if !self.machine.permits(client, &request) {
            return reply.error("take control first");
        }
        match request {
            Request::Jog { jog, axes, .. } => self.jog(client, jog, &axes, reply),
            Request::Cancel => {
                if self.current.is_some() {
                    self.machine.stop.request();
                }
                reply.ok();
            }
            Request::Home { axis } => self.home(axis, reply),
            Request::Step { move_mm, .. } => self.step(&move_mm, reply),
            Request::Goto {
                to_mm,
                frame,
                rapid,
                ..
            } => self.go(&to_mm, frame, rapid, reply),
            Request::Zero { at_mm } => self.zero(&at_mm, reply),
            Request::Touch(touch) => self.touch(&touch, reply),
            Request::Tip(tip) => self.set_tip(tip, reply),
            Request::Resume if self.routines.is_waiting() => {
                self.hands.resume();
                reply.ok();
            }
            Request::Resume => reply.error("nothing waits"),
            Request::Routine { name, text } => reply.result(Routines::checked(&name, text)),
            Request::RoutineRun { name, text, part } => self.run(&name, text, part, reply),
            Request::Measured => reply.data(self.routines.all()),
            Request::Load(_) => reply.error("a measuring machine runs routines, not programs"),
            // Who asks for what a program is checked against hears that there is no answer.
            Request::Surroundings(_) => {}
            Request::Stop | Request::Take { .. } | Request::Give | Request::Renew { .. } => {}
            Request::Release { .. } => {}
            _ => reply.error("a measuring machine has no such command"),
        }
    }

    /// Begins a stop that somebody has requested, or that is due because the operator has gone.
    fn halt(&mut self) {
        let has_left = self.machine.take_left();
        let is_asked = self.machine.stop.is_asked();
        match &self.current {
            None => {
                if is_asked {
                    self.stopped();
                }
            }
            Some((purpose, _)) => {
                let is_by_hand = !matches!(purpose, Purpose::Routine);
                let is_due = is_asked || (has_left && is_by_hand);
                if is_due && !self.is_stopping {
                    self.is_stopping = true;
                    self.machine.lease.end();
                    self.hands.stop();
                }
            }
        }
    }

    /// Nothing moves after a stop. What was asked for before, and still waits, is refused.
    fn stopped(&mut self) {
        self.is_stopping = true;
        while let Ok(asked) = self.requests.try_recv() {
            self.carry_out(asked);
        }
        self.is_stopping = false;
        self.machine.stop.clear();
        self.tell("the machine has stopped");
    }

    /// Lets the head begin something.
    fn start(&mut self, job: Job, purpose: Purpose, word: &'static str) {
        self.current = Some((purpose, word));
        // If its thread has ended, the next event tells why, and the request is answered then.
        let _ = self.jobs.send(job);
    }

    /// Whether the head may begin something.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    fn is_free(&self) -> Result<(), String> {
        match &self.current {
            None => Ok(()),
            Some((Purpose::Routine, _)) => Err("a routine runs".into()),
            Some((Purpose::Jog { .. }, _)) => Err("the machine jogs".into()),
            Some((Purpose::Asked(_), _)) => Err("the machine moves".into()),
        }
    }
}
