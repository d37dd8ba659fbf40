//! The driver of the microfactory.
//!
//! The controller carries out one command at a time. While something moves, the question where it
//! is renews its lease of 250 ms: without it the controller ends the motion.

mod cutting;
mod following;
mod halting;
mod jogging;
mod running;

use super::phase::Phase;
use super::{Desk, Drive, Port, Published};
use crate::serve::console_lines::From;
use crate::serve::figure_program::Factory;
use crate::serve::loaded::{Surroundings, Target};
use crate::serve::machine::{Asked, Machine};
use crate::serve::machine_state::{FactoryState, Link, MachineState};
use crate::serve::reply::Reply;
use crate::serve::request::Request;
use crate::serve::tool_path::Motion as Drawn;
use following::Task;
use husillo_clients::microfactory::{Client, LEASE, Motion, length};
use husillo_clients::{StopRequests, Wire};
use husillo_gcode::Nm;
use husillo_sim::device::microfactory::{self as device, Device};
use husillo_transports::microfactory::{Report, Status};
use jogging::Held;
use running::Running;
use serde_json::json;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::Duration;

/// Wait for requests in one turn.
const TURN: Duration = Duration::from_millis(10);

/// Drives the microfactory.
#[derive(Debug)]
pub(super) struct Microfactory {
    factory: Arc<Factory>,
    running: Running,
}

impl Microfactory {
    /// A microfactory with these rates and bytes.
    pub(super) fn new(factory: Arc<Factory>) -> Self {
        Self {
            factory,
            running: Running::default(),
        }
    }
}

impl Drive for Microfactory {
    fn drive(&mut self, port: &Port, desk: Desk<'_>) -> Result<(), String> {
        let settings = &self.factory.settings;
        let wire = match port.name.as_str() {
            "sim" => {
                let (table, ticks) = (settings.table, settings.pull_out_ticks);
                let device = Device::new(settings.config, table, ticks, &[], true, port.baud, 1)?;
                Wire::paced(device, port.speed)
            }
            name => Wire::open(name, port.baud).map_err(|error| format!("{name}: {error}"))?,
        };
        // A stop that was requested meanwhile is carried out by the driver.
        let client = Client::new(wire, settings.table, true, StopRequests::default());
        let mut client = client.with_lease(LEASE).with_steps(settings.steps);
        let status = client.bring_to_rest()?;
        desk.state.link = Link::Up;
        desk.state.why = None;
        desk.state.controller = Some("microfactory".into());
        desk.state.axes = vec!['X', 'Y', 'Z'];
        desk.machine.tell(From::Server, "the controller answers");
        let mut driver = Driver {
            client,
            machine: desk.machine,
            state: desk.state,
            requests: desk.requests,
            factory: &self.factory,
            running: &mut self.running,
            status,
            asked_at: Duration::ZERO,
            task: None,
            held: None,
            has_contact: false,
            was_latched: status.report == Some(Report::Emergency),
            is_stopping: false,
            published: Published::new(),
        };
        driver.draw(Drawn::Begin);
        let ended = driver.turns();
        let why = match &ended {
            Ok(()) => "this program has ended",
            Err(_) => "the controller is lost",
        };
        driver.drop_task(why);
        driver.end_figure(why);
        driver.show();
        ended
    }
}

/// The driver, while its controller answers.
struct Driver<'a> {
    client: Client,
    machine: &'a Machine,
    state: &'a mut MachineState,
    requests: &'a Receiver<Asked>,
    factory: &'a Arc<Factory>,
    running: &'a mut Running,
    /// What the controller has told last.
    status: Status,
    asked_at: Duration,
    /// The command that is carried out.
    task: Option<Task>,
    held: Option<Held>,
    /// The tool has touched the work piece in the present or the last figure.
    has_contact: bool,
    /// An emergency stop has held when that was looked at.
    was_latched: bool,
    is_stopping: bool,
    published: Published,
}

impl Driver<'_> {
    /// Drives until the program ends.
    fn turns(&mut self) -> Result<(), String> {
        loop {
            if self.machine.is_ending() {
                self.client.halt()?;
                return Ok(());
            }
            self.stop_if_due()?;
            while let Ok(asked) = self.requests.try_recv() {
                self.carry_out(asked)?;
            }
            self.jog()?;
            self.store()?;
            self.follow()?;
            self.look_at_latch()?;
            self.client.wait(TURN)?;
            for line in self.client.take_reports() {
                self.machine.tell(From::Controller, line);
            }
            self.show();
        }
    }

    /// Whether something is carried out for a page.
    const fn is_at_work(&self) -> bool {
        self.task.is_some() || self.held.is_some()
    }

    /// Whether an order by hand may be carried out.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    fn is_free(&self) -> Result<(), String> {
        if self.is_latched() {
            return Err("the emergency stop holds: reset the machine at its panel".into());
        }
        if self.running.course.is_active() {
            return Err("a figure is cut".into());
        }
        match self.is_at_work() || self.status.is_moving {
            true => Err("the machine moves".into()),
            false => Ok(()),
        }
    }

    /// Carries out a request of a page.
    ///
    /// # Errors
    ///
    /// The controller is lost: a sentence.
    fn carry_out(&mut self, asked: Asked) -> Result<(), String> {
        let Asked {
            client,
            request,
            reply,
        } = asked;
        if self.is_halting() && request.needs_control() {
            reply.error("the machine is being stopped");
            return Ok(());
        }
        if !self.machine.permits(client, &request) {
            reply.error("take control first");
            return Ok(());
        }
        match request {
            Request::Reset => return self.reset(reply),
            Request::Jog { jog, axes, .. } => {
                let begun = self.begin_jog(client, jog, &axes);
                if begun.is_err() {
                    self.machine.lease.release(client, jog);
                }
                reply.with(begun);
            }
            Request::Home { axis: None } => return self.by_hand(Motion::Home, reply),
            Request::Home { .. } => reply.error("a microfactory homes X, Y and Z together"),
            Request::Steps { steps } => return self.steps(&steps, reply),
            Request::Run { from: Some(_), .. } => {
                reply.error("a figure is cut from its begin to its end");
            }
            Request::Run {
                confirmed,
                from: None,
            } => self.run(confirmed, reply),
            Request::Load(program) => reply.with(self.load(program)),
            Request::Unload => reply.with(self.unload()),
            Request::Hold | Request::Resume => {
                reply.error("a figure cannot be held: its controller has no pause. STOP ends it");
            }
            Request::Surroundings(to) => {
                let around = Surroundings {
                    target: Target::Microfactory(Arc::clone(self.factory)),
                    zero_mm: Vec::new(),
                    at_mm: Vec::new(),
                };
                // If nobody waits any more, nobody needs them.
                let _ = to.try_send(around);
            }
            _ => reply.error("a microfactory does not have this"),
        }
        Ok(())
    }

    /// Presses the reset of a simulated panel.
    fn reset(&mut self, reply: Reply) -> Result<(), String> {
        if self.is_at_work() || self.running.course.is_active() {
            reply.error("the machine moves: stop it first");
            return Ok(());
        }
        if !self.client.press_reset() {
            reply.error("press the reset of the panel at the machine");
            return Ok(());
        }
        self.begin_again()?;
        reply.ok();
        Ok(())
    }

    /// The device was reset: it has forgotten its home and its lease.
    fn begin_again(&mut self) -> Result<(), String> {
        self.status = self.client.bring_to_rest()?;
        self.was_latched = self.is_latched();
        self.has_contact = false;
        self.draw(Drawn::Begin);
        self.machine.tell(From::Server, "the controller was reset");
        Ok(())
    }

    /// Publishes the state if it has changed, and not too often.
    fn show(&mut self) {
        let status = self.status;
        let is_latched = self.is_latched();
        self.state.stopping = self.is_stopping;
        self.state.state = Some(self.word());
        self.state.alarm = is_latched.then(|| {
            json!({
                "number": 0,
                "text": "emergency stop: nothing moves until the reset of the panel",
            })
        });
        self.state.jog = self.held.as_ref().map(Held::shown);
        self.state.advice = match (is_latched, status.is_homed) {
            (true, _) => Some("find the reason, then press the reset of the panel"),
            (_, false) => Some(
                "the machine is not homed: it counts from where it was switched on; home it first",
            ),
            _ => None,
        };
        let [at, zero] = [status.position_steps, self.zero_steps()];
        let work = std::array::from_fn(|axis| {
            let part = |steps: [i32; 4]| steps.get(axis).copied().unwrap_or_default();
            part(at).wrapping_sub(part(zero))
        });
        let mm = |steps| {
            let mm = self.in_nm(steps).map(|nm| nm as f64 / 1e6);
            status.is_homed.then(|| mm.to_vec())
        };
        [
            self.state.machine_mm,
            self.state.work_mm,
            self.state.zero_mm,
        ] = [at, work, zero].map(mm);
        let motion = match (&self.task, &self.held) {
            (Some(task), _) => Some(task.motion),
            (None, held) => held.map(|held| held.motion()),
        };
        self.state.factory = Some(FactoryState {
            is_homed: status.is_homed,
            is_latched,
            steps: status.position_steps,
            contact: self.has_contact,
            report: status.report.map(device::text),
            motion: motion.map(|motion| motion.to_string()),
            line: self.running.line(),
            stored: self.running.stored(),
        });
        self.state.program = self.figure_shown();
        self.note_run();
        self.published.update(self.machine, self.state);
    }

    /// The state as a word.
    fn word(&self) -> &'static str {
        match self.task.as_ref().map(|task| task.motion) {
            _ if self.is_latched() => "Alarm",
            _ if self.held.is_some() => "Jog",
            Some(Motion::Home) => "Home",
            Some(_) => "Run",
            None if self.status.is_moving || self.running.course.is_active() => "Run",
            None => "Idle",
        }
    }

    /// The zero of the work: where the figure begins. A figure that is loaded begins where the
    /// machine stands.
    fn zero_steps(&self) -> [i32; 4] {
        match self.running.course.phase() {
            _ if self.running.course.program().is_none() => [0; 4],
            Phase::Loaded => self.status.position_steps,
            _ => self.running.begin_steps(),
        }
    }

    /// Steps of the axes as lengths, nm.
    fn in_nm(&self, steps: [i32; 4]) -> [i64; 3] {
        let axes = steps.into_iter().zip(self.factory.settings.steps);
        let mut at = [0; 3];
        for (at, (steps, step)) in at.iter_mut().zip(axes) {
            let Nm(nm) = length(steps.into(), step);
            *at = nm;
        }
        at
    }

    /// Draws the way to the present position, from home or from where the machine was switched on.
    fn draw(&self, motion: Drawn) {
        let at = self.in_nm(self.status.position_steps);
        if self.machine.path.to(motion, at) {
            self.machine.drawn();
        }
    }

    /// Whether an emergency stop holds until the reset of the panel.
    fn is_latched(&self) -> bool {
        self.status.report == Some(Report::Emergency)
    }
}
