//! The thread that owns the head of the machine. Its motions last until they end, so the driver is
//! another thread, which hears of them by events.

use super::hands::{Hands, Watcher};
use super::measured::{self, Measured};
use super::{Port, paced_port::PacedPort};
use crate::measuring::memory_file::MemoryFile;
use crate::measuring::port::NetworkPort;
use crate::measuring::{Routine, sentence};
use husillo_backlash::Flank;
use husillo_metrology::Error;
use husillo_metrology::calibration::{Calibrated, Face, surface_nm};
use husillo_metrology::heads::{
    self, Approach, AxisPosition, Head, Line, Memory, Prober as _, Rejoined, Stylus,
};
use husillo_metrology::simulated::SimulatedNetwork;
use husillo_probe::UnitVector;
use serde_json::Value;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::Duration;

/// Interval of the readings at rest.
const REST: Duration = Duration::from_millis(100);

type AnyHead = Calibrated<Head<Box<dyn heads::Port>>>;

/// Where the head is.
#[derive(Debug)]
pub(super) struct Setup {
    /// Name of the machine, or path of its file.
    pub(super) name: String,
    pub(super) machine: heads::Machine,
    pub(super) network: SimulatedNetwork,
    /// The tip in use.
    pub(super) tip: Stylus,
    pub(super) port: Port,
}

/// What the head is to do. Lengths are amounts of the scale.
#[derive(Debug)]
pub(super) enum Job {
    /// Home these axes.
    Home(Vec<usize>),
    /// Move to these work coordinates, or to machine coordinates.
    GoTo {
        to: Vec<(usize, i64)>,
        is_machine: bool,
        approach: Approach,
    },
    /// The present position of these axes becomes 0.
    Zero(Vec<usize>),
    /// Touch the part, and with a face of known position calibrate the pre-travel.
    Touch {
        towards: UnitVector,
        within: u64,
        touches: u8,
        face: Option<Face>,
    },
    /// Follow the joystick.
    Steer,
    /// Use this tip.
    Tip(Box<Stylus>),
    /// Carry out a routine.
    Routine(Box<Routine>, Option<String>),
}

/// What the driver hears of the head.
#[derive(Debug)]
pub(super) enum Event {
    /// The servos are on.
    Up(Kept),
    /// A reading, also in motion: the work position, and whether the probe is pressed.
    At([i64; 3], bool),
    /// The axes at rest, and the position at which they are held.
    Axes(Vec<AxisPosition>, [i64; 3]),
    /// Bytes sent, and received then.
    Exchange((Vec<u8>, Vec<u8>)),
    /// Something for the operator.
    Note(String),
    /// A touch.
    Touched(Touched),
    /// The tip.
    Tip(Box<Stylus>),
    /// A routine begins this line.
    Line(usize),
    /// It has measured a feature.
    Feature(Value),
    /// It has ended.
    Measured(Box<Measured>),
    /// A program waits at an M0 of this line.
    Waits(Option<usize>),
    /// The job has ended. An error is a sentence. Whether the operator has stopped it.
    Ended(Result<(), String>, bool),
    /// The modules do not answer.
    Lost(String),
}

/// What the modules have kept of home and zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kept {
    /// They are as the session before has left them.
    All,
    /// They were reset or moved.
    Lost,
    /// The session before had neither, or there was none.
    NoneBefore,
}

/// A touch. Lengths are amounts of the scale.
#[derive(Clone, Debug)]
pub(super) struct Touched {
    /// The position of the tip when the contact closed.
    pub(super) trigger: [i64; 3],
    /// The point of the surface: without pre-travel and radius of the ball.
    pub(super) contact: [i64; 3],
    pub(super) pre_travel: i64,
    pub(super) touches: u8,
    pub(super) spread: i64,
    pub(super) over_travel: i64,
}

/// Owns the head until there are no more jobs.
pub(super) fn work(
    setup: &Setup,
    hands: &Arc<Hands>,
    jobs: &Receiver<Job>,
    events: &Sender<Event>,
) {
    let mut worker = Worker {
        setup,
        memory: MemoryFile::at(&setup.name, &setup.port.name, &setup.machine),
        hands,
        events,
        tip: setup.tip,
    };
    let begun = worker.begin();
    let ended = begun.and_then(|head| worker.turns(head, jobs));
    if let Err(why) = ended {
        worker.tell(Event::Lost(why));
    }
}

struct Worker<'a> {
    setup: &'a Setup,
    /// Homes and zeros for the next session. A simulated machine has none.
    memory: Option<MemoryFile>,
    hands: &'a Arc<Hands>,
    events: &'a Sender<Event>,
    tip: Stylus,
}

impl Worker<'_> {
    fn tell(&self, event: Event) {
        // Without a driver the next job does not come, and the thread ends.
        let _ = self.events.send(event);
    }

    /// Switches the servos on, and goes on with homes and zeros of a session before.
    fn begin(&self) -> Result<AnyHead, String> {
        let Setup { network, port, .. } = self.setup;
        let open: Box<dyn heads::Port> = match port.name.as_str() {
            "sim" => Box::new(PacedPort::new(network.clone(), port.speed)),
            name => {
                let opened = NetworkPort::open(name);
                Box::new(opened.map_err(|error| format!("{name}: {error}"))?)
            }
        };
        let operator = Watcher::new(Arc::clone(self.hands), self.events.clone());
        let line = Line::new(open).with_operator(operator);
        let (mut head, kept) = self.start(line).map_err(|error| sentence(&error))?;
        self.keep(&mut head, true);
        self.tell(Event::Tip(Box::new(self.tip)));
        // The page gets the positions with the first state.
        self.show(&mut head)?;
        self.tell(Event::Up(kept));
        Ok(head)
    }

    fn start(&self, mut line: Line<Box<dyn heads::Port>>) -> Result<(AnyHead, Kept), Error> {
        let machine = &self.setup.machine;
        let errors = || machine.errors.clone();
        let mut kept = Kept::NoneBefore;
        if let Some(mut memory) = self.memory.as_ref().and_then(MemoryFile::read) {
            match Head::rejoin(line, machine, 1, &memory)? {
                Rejoined::AsLeft(head) => {
                    if memory.in_use {
                        let axes = memory.axes.iter_mut();
                        axes.for_each(|axis| axis.flank = Flank::Unknown);
                    }
                    let mut head = Calibrated::new(*head, errors());
                    head.recall(&memory);
                    return Ok((head, Kept::All));
                }
                Rejoined::Changed(same) => line = *same,
            }
            if memory
                .axes
                .iter()
                .any(|axis| axis.is_homed || axis.zero != 0)
            {
                kept = Kept::Lost;
            }
        }
        let head = Head::start(line, machine, 1)?;
        if let Some(memory) = &self.memory {
            memory.forget();
        }
        Ok((Calibrated::new(head, errors()), kept))
    }

    fn turns(&mut self, mut head: AnyHead, jobs: &Receiver<Job>) -> Result<(), String> {
        loop {
            match jobs.recv_timeout(REST) {
                Ok(job) => {
                    let done = self.carry_out(job, &mut head);
                    let is_stopped = self.hands.take_stopped();
                    let done = done.map_err(Trouble::text);
                    // The axes brake: they stand before the job has ended.
                    let done = match head.inner().come_to_rest() {
                        Ok(()) | Err(Error::Interrupted) => done,
                        Err(error @ Error::StillMoving { .. }) => {
                            let why = done.err().map(|why| format!("{why}; "));
                            Err(why.unwrap_or_default() + &sentence(&error))
                        }
                        Err(error) => return Err(sentence(&error)),
                    };
                    self.show(&mut head)?;
                    self.keep(&mut head, true);
                    self.tell(Event::Ended(done, is_stopped));
                }
                Err(RecvTimeoutError::Timeout) => self.show(&mut head)?,
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        self.keep(&mut head, false);
        Ok(())
    }

    /// Reads the axes at rest.
    ///
    /// # Errors
    ///
    /// The modules do not answer.
    fn show(&self, head: &mut AnyHead) -> Result<(), String> {
        match head.inner().read_at_rest() {
            Err(error @ (Error::Port(_) | Error::Link { .. })) => return Err(sentence(&error)),
            Err(Error::Interrupted) | Ok(()) => {}
            Err(fault) => self.tell(Event::Note(sentence(&fault))),
        }
        // An axis that somebody pushes has no two equal readings.
        if let Ok(axes) = head.axis_positions() {
            let mut held = head.held();
            if head.inner().is_astray() {
                for axis in &axes {
                    if let Some(held) = held.get_mut(axis.coordinate) {
                        *held = axis.work;
                    }
                }
            }
            self.tell(Event::Axes(axes, held));
        }
        Ok(())
    }

    /// Keeps homes and zeros for the next session.
    fn keep(&self, head: &mut AnyHead, in_use: bool) {
        if let Some(file) = &self.memory {
            if let Ok(memory) = head.memory() {
                // Without the file the next session homes again.
                let _ = file.write(&Memory { in_use, ..memory });
            }
        }
    }

    fn carry_out(&mut self, job: Job, head: &mut AnyHead) -> Result<(), Trouble> {
        match job {
            Job::Home(axes) => axes.into_iter().try_for_each(|axis| head.home(axis))?,
            Job::Zero(axes) => axes.into_iter().try_for_each(|axis| head.set_zero(axis))?,
            Job::GoTo {
                to,
                is_machine,
                approach,
            } => self.go(&to, is_machine, approach, head)?,
            Job::Touch {
                towards,
                within,
                touches,
                face,
            } => {
                head.inner().set_touches(touches);
                let measured = head.measure(&towards, within)?;
                if let Some(face) = face {
                    let over_travel = head.inner().probe().over_travel;
                    let scale = self.setup.machine.scale;
                    self.tip = face.calibrate(self.tip, &measured, scale, over_travel)?;
                    self.tell(Event::Tip(Box::new(self.tip)));
                }
                self.tell(Event::Touched(Touched {
                    trigger: measured.touch.position,
                    contact: surface_nm(&self.tip, &measured),
                    pre_travel: self.tip.pre_travel.along(&towards).into(),
                    touches: measured.touches,
                    spread: measured.spread,
                    over_travel: measured.over_travel,
                }));
            }
            Job::Steer => {
                let hands = Arc::clone(self.hands);
                head.steer(|| hands.joystick())?;
            }
            Job::Tip(tip) => {
                self.tip = *tip;
                self.tell(Event::Tip(tip));
            }
            Job::Routine(routine, part) => {
                head.inner().set_touches(1);
                // One before it has spoiled nothing that is measured now.
                head.inner().forget_collisions();
                let (title, hands) = (&self.setup.machine.title, self.hands);
                let tell = |event| self.tell(event);
                measured::run(
                    &routine,
                    part.as_deref(),
                    title,
                    head,
                    self.tip,
                    hands,
                    tell,
                )?;
            }
        }
        Ok(())
    }

    fn go(
        &self,
        to: &[(usize, i64)],
        is_machine: bool,
        approach: Approach,
        head: &mut AnyHead,
    ) -> Result<(), Trouble> {
        // An axis without a goal stays where it is, also after a stop.
        let mut goal = head.hold()?;
        let axes = head.axis_positions()?;
        for (axis, amount) in to {
            let zero = match (is_machine, axes.iter().find(|one| one.coordinate == *axis)) {
                (false, _) => 0,
                (true, Some(axis)) => match axis.machine {
                    Some(machine) => machine - axis.work,
                    None => return Err(Trouble::Text("home the axis first".into())),
                },
                (true, None) => return Err(Trouble::Text("there is no such axis".into())),
            };
            if let Some(goal) = goal.get_mut(*axis) {
                *goal = amount.saturating_sub(zero);
            }
        }
        match approach {
            Approach::Rapid => head.go_to(goal)?,
            Approach::Guarded => head.guarded_to(goal)?,
        };
        Ok(())
    }
}

/// Why a job has failed.
#[derive(Debug)]
pub(super) enum Trouble {
    Machine(Error),
    Text(String),
}

impl Trouble {
    fn text(self) -> String {
        match self {
            Self::Machine(Error::Interrupted) => "stopped".into(),
            Self::Machine(error) => sentence(&error),
            Self::Text(text) => text,
        }
    }
}

impl From<Error> for Trouble {
    fn from(error: Error) -> Self {
        Self::Machine(error)
    }
}
