//! The driver of the micro mill.
//!
//! The link carries one string at a time. While a motion is made, strings keep it going: without
//! them the controller ends it after 250 ms. Each step is reported, so the place of the tool is
//! known while it moves. At rest the controller is asked where it is.

mod halting;
mod jogging;
mod moving;
mod orders;
mod place;
mod running;

use super::phase::Phase;
use super::{Desk, Drive, Port, Published};
use crate::serve::console_lines::From;
use crate::serve::machine::{Asked, Machine};
use crate::serve::machine_state::{Link, MachineState, MillState};
use crate::serve::request::Request;
use halting::Halting;
use husillo_clients::micromill::{LEASE_MS, Session};
use husillo_clients::{StopRequests, Wire};
use husillo_machine::Config;
use husillo_sim::device::micromill::Device;
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_transports::micromill::Order;
use jogging::Jogging;
use orders::Sent;
use place::Place;
use running::Running;
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::mpsc::Receiver;

/// The longest wait for a byte in one turn, us.
const TURN_US: u32 = 20_000;

/// Drives the micro mill.
#[derive(Debug)]
pub(super) struct Mill {
    file: Arc<MachineFile>,
    config: Config<3>,
    running: Running,
}

impl Mill {
    /// A mill with these steps.
    pub(super) fn new(file: Arc<MachineFile>, config: Config<3>) -> Self {
        Self {
            file,
            config,
            running: Running::default(),
        }
    }
}

impl Drive for Mill {
    fn drive(&mut self, port: &Port, desk: Desk<'_>) -> Result<(), String> {
        let wire = match port.name.as_str() {
            "sim" => Wire::paced(Device::new(port.baud), port.speed),
            name => Wire::open(name, port.baud).map_err(|error| format!("{name}: {error}"))?,
        };
        // A stop that was requested meanwhile is carried out by the driver.
        let mut session = Session::new(wire, port.baud, StopRequests::default());
        session.begin(LEASE_MS)?;
        session.order(Order::Every(1), "report of steps")?;
        let place = Place::new(session.state()?, self.config);
        session.steps.clear();
        desk.state.link = Link::Up;
        desk.state.why = None;
        desk.state.controller = Some("micro mill".into());
        desk.state.axes = vec!['X', 'Y', 'Z'];
        desk.state.mill = Some(MillState::default());
        desk.machine.tell(From::Server, "the controller answers");
        let driver = Driver {
            machine: desk.machine,
            session,
            state: desk.state,
            requests: desk.requests,
            file: &self.file,
            place,
            running: &mut self.running,
            current: None,
            waiting: VecDeque::new(),
            jogging: Jogging::default(),
            halting: None,
            published: Published::new(),
        };
        driver.drive()
    }
}

/// The driver, while its controller answers.
struct Driver<'a> {
    machine: &'a Machine,
    session: Session,
    state: &'a mut MachineState,
    requests: &'a Receiver<Asked>,
    file: &'a Arc<MachineFile>,
    place: Place,
    running: &'a mut Running,
    /// The order that is carried out.
    current: Option<Sent>,
    /// Orders that follow it.
    waiting: VecDeque<Sent>,
    jogging: Jogging,
    halting: Option<Halting>,
    published: Published,
}

impl Driver<'_> {
    /// Drives until the program ends.
    fn drive(mut self) -> Result<(), String> {
        self.begin_path();
        let ended = self.turns();
        let why = match &ended {
            Ok(()) => "this program has ended",
            Err(_) => "the controller is lost",
        };
        self.drop_orders(why);
        self.end_program(why);
        self.show();
        ended
    }

    fn turns(&mut self) -> Result<(), String> {
        loop {
            if self.machine.is_ending() {
                if !self.is_busy() {
                    return Ok(());
                }
                if self.halting.is_none() {
                    self.machine.stop.request();
                }
            }
            self.halt();
            while let Ok(asked) = self.requests.try_recv() {
                self.carry_out(asked);
            }
            self.jog();
            self.feed_program();
            self.start_next();
            let outcome = self.session.turn(TURN_US)?;
            self.follow();
            if let Some(outcome) = outcome {
                self.ended(outcome)?;
            }
            self.show();
        }
    }

    /// Whether an order is carried out or waits, or the mill is being stopped.
    fn is_busy(&self) -> bool {
        self.current.is_some() || !self.waiting.is_empty() || self.halting.is_some()
    }

    /// Publishes the state if it has changed, and not too often.
    fn show(&mut self) {
        self.state.stopping = self.halting.is_some();
        self.state.state = Some(self.word());
        self.state.jog = self.jogging.shown();
        self.state.advice = (!self.place.is_homed()).then_some(
            "the mill does not know where it is: home it before a line or a program; jogs and \
             steps are possible",
        );
        self.place.show(self.state);
        self.show_order();
        self.state.program = self.program_shown();
        self.note_run();
        self.published.update(self.machine, self.state);
    }

    /// The state as a word.
    fn word(&self) -> &'static str {
        match self.current.as_ref().map(|sent| sent.order) {
            Some(Order::Home) => "Home",
            Some(Order::Jog(_) | Order::Run(..)) => "Jog",
            Some(_) => "Run",
            None if self.running.course.phase() == Phase::Running => "Run",
            None => "Idle",
        }
    }

    /// Carries out a request of a page.
    fn carry_out(&mut self, asked: Asked) {
        let Asked {
            client,
            request,
            reply,
        } = asked;
        if self.halting.is_some() {
            return reply.error("the machine is being stopped");
        }
        if !self.machine.permits(client, &request) {
            return reply.error("take control first");
        }
        match request {
            Request::Jog { jog, axes, hz, .. } => {
                let begun = self.begin_jog(client, jog, &axes, hz);
                if begun.is_err() {
                    self.machine.lease.release(client, jog);
                }
                reply.with(begun);
            }
            Request::Pace { faster } => reply.with(self.change_pace(faster)),
            Request::Home { axis: None } => self.by_hand(vec![Order::Home], reply),
            Request::Home { .. } => reply.error("a mill homes Z, X and Y together"),
            Request::Step { move_mm, .. } => self.step(&move_mm, reply),
            Request::Steps { steps } => self.steps(&steps, reply),
            Request::Goto { to_mm, frame, .. } => self.go(&to_mm, frame, reply),
            Request::Zero { at_mm } => self.zero(&at_mm, reply),
            Request::Backlash { um } => self.backlash(&um, reply),
            Request::Line { text } => self.line(&text, reply),
            Request::Hold => reply.with(self.running.course.pause()),
            Request::Resume => reply.with(self.running.course.resume()),
            Request::Run { confirmed, from } => self.run(confirmed, from, reply),
            Request::SingleBlock { on } => {
                self.running.course.single_block = on;
                reply.ok();
            }
            Request::Breakpoints { lines } => {
                self.running.course.breakpoints = lines.into_iter().collect();
                reply.ok();
            }
            Request::Load(program) => self.load(program, reply),
            Request::Unload => self.unload(reply),
            Request::Surroundings(to) => {
                // If nobody waits any more, nobody needs them.
                let _ = to.try_send(self.surroundings());
            }
            _ => reply.error("a micro mill does not have this"),
        }
    }
}
