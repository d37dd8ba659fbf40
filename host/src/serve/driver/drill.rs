//! The driver of the circuit-board drill.
//!
//! The link carries one step at a time: a key of the manual mode, or a program of one record. While
//! something moves, questions keep it going: without them the controller ends the motion after
//! 250 ms. STOP is silence until then. A program is sent record by record, so it can wait after
//! each hole, and what is drilled is known.

mod bench;
mod halting;
mod jogging;
mod moving;
mod placing;
mod running;
mod stepping;

use super::{Desk, Drive, Port, Published};
use crate::serve::console_lines::From;
use crate::serve::machine::Asked;
use crate::serve::machine_state::{DrillState, Link};
use crate::serve::request::Request;
use bench::Bench;
use husillo_clients::drill::{Client, ClientError, LEASE_MS};
use husillo_clients::{StopRequests, Wire};
use husillo_sim::device::drill::Device;
use jogging::Jogging;
use running::Running;
use std::time::Duration;
use stepping::Trouble;

/// Wait for requests while nothing moves.
const REST: Duration = Duration::from_millis(20);
/// Interval of the questions to a drill at rest.
const HEARTBEAT: Duration = Duration::from_secs(1);

/// Drives the drill.
#[derive(Debug, Default)]
pub(super) struct Drill {
    running: Running,
}

impl Drive for Drill {
    fn drive(&mut self, port: &Port, desk: Desk<'_>) -> Result<(), String> {
        let wire = match port.name.as_str() {
            "sim" => Wire::paced(Device::new(port.baud, false), port.speed),
            name => Wire::open(name, port.baud).map_err(|error| format!("{name}: {error}"))?,
        };
        // A stop that was requested meanwhile is carried out by the driver.
        let client = Client::new(wire, port.baud, StopRequests::default());
        let mut client = client.with_lease(LEASE_MS);
        client.reach().map_err(|error| match error {
            ClientError::NoLease => {
                "the controller confirms no lease, so it would go on when this program is gone: \
                 an original drill is driven by `husillo send` and `husillo jog`"
                    .into()
            }
            error => error.unreached(),
        })?;
        desk.state.link = Link::Up;
        desk.state.why = None;
        desk.state.controller = Some("drill".into());
        desk.state.axes = vec!['X', 'Y', 'Z'];
        desk.state.drill = Some(DrillState::default());
        desk.machine.tell(From::Server, "the controller answers");
        let mut driver = Driver {
            client,
            bench: Bench::new(desk.machine, desk.state, desk.requests, &mut self.running),
        };
        let ended = driver.drive();
        let why = match &ended {
            Ok(()) => "this program has ended",
            Err(_) => "the controller is lost",
        };
        driver.bench.drop_placing(why);
        driver.bench.end_program(why);
        driver.bench.show();
        ended
    }
}

/// The driver, while its controller answers.
struct Driver<'a> {
    client: Client,
    bench: Bench<'a>,
}

impl Driver<'_> {
    /// Drives until the program ends.
    fn drive(&mut self) -> Result<(), String> {
        let ended = self.begin().and_then(|()| self.turns());
        match ended {
            Err(_) if self.bench.machine.is_ending() => Ok(()),
            ended => ended.map_err(Trouble::text),
        }
    }

    /// Finds out where the drill is. A spindle that an earlier program has left on is switched off.
    fn begin(&mut self) -> Result<(), Trouble> {
        self.read_place()?;
        self.spindle(false).or_else(Trouble::unless_lost)?;
        self.bench.begin_path();
        Ok(())
    }

    fn turns(&mut self) -> Result<(), Trouble> {
        let mut asked_at = self.client.elapsed();
        loop {
            self.bench.now = self.client.elapsed();
            if self.bench.machine.is_ending() {
                return self.leave();
            }
            if self.bench.must_halt() {
                self.halt()?;
            }
            while let Ok(asked) = self.bench.requests.try_recv() {
                self.carry_out(asked)?;
            }
            self.bench.finish_placing();
            let has_moved = self.jog()? || self.feed_program()?;
            if !has_moved {
                self.client.rest(REST).map_err(Trouble::lost)?;
                if self.client.elapsed() >= asked_at + HEARTBEAT {
                    asked_at = self.client.elapsed();
                    self.ask_state()?;
                    self.bench.heartbeats += 1;
                }
            }
            self.bench.show();
        }
    }

    /// Leaves the drill as the next client expects it: idle, with the spindle off.
    fn leave(&mut self) -> Result<(), Trouble> {
        self.bench.jogging = Jogging::default();
        self.spindle(false)?;
        self.idle()
    }

    /// Carries out a request of a page, while nothing moves.
    ///
    /// # Errors
    ///
    /// Only that the controller is lost. Others are the answer.
    fn carry_out(&mut self, asked: Asked) -> Result<(), Trouble> {
        let Asked {
            client,
            request,
            reply,
        } = asked;
        if self.bench.must_halt() {
            reply.error("the machine is being stopped");
            return Ok(());
        }
        if !self.bench.machine.permits(client, &request) {
            reply.error("take control first");
            return Ok(());
        }
        let done = match request {
            Request::Jog { jog, axes, .. } => {
                let begun = self.bench.begin_jog(client, jog, &axes);
                reply.with(begun);
                return Ok(());
            }
            Request::Load(program) => {
                reply.with(self.bench.load(program));
                return Ok(());
            }
            Request::Run { confirmed, from } => {
                let begun = self.run(confirmed, from);
                return finish(reply, begun);
            }
            Request::Unload => self.bench.unload(),
            Request::Place { placing } => {
                self.bench.place_board(placing, reply);
                return Ok(());
            }
            Request::Taught => {
                let loaded = self.load_taught();
                return finish(reply, loaded);
            }
            Request::LinkTest => {
                let tested = self.test_link();
                return finish(reply, tested);
            }
            Request::Home { axis: None } => self.home(),
            Request::Home { .. } => Err(Trouble::refused("a drill homes Z, Y and X together")),
            Request::Manual { on } => self.manual(on),
            Request::Step { move_mm, .. } => self.step_mm(&move_mm),
            Request::Steps { steps } => self.steps(&steps),
            Request::Goto { to_mm, frame, .. } => self.go(&to_mm, frame),
            Request::Zero { at_mm } => self.zero(&at_mm),
            Request::Spindle { on } => self.switch_spindle(on),
            Request::Teach => self.teach(),
            request => {
                self.bench.settle(request, reply);
                return Ok(());
            }
        };
        finish(reply, done.map(|()| serde_json::Value::Null))
    }
}

/// Answers a request. That the controller is lost is passed on.
fn finish(
    reply: crate::serve::reply::Reply,
    done: Result<serde_json::Value, Trouble>,
) -> Result<(), Trouble> {
    match done {
        Ok(data) => reply.data(data),
        Err(Trouble::Lost(why)) => {
            reply.error(&why);
            return Err(Trouble::Lost(why));
        }
        Err(trouble) => reply.error(trouble.text()),
    }
    Ok(())
}
