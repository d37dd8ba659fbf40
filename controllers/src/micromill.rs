//! The micro mill: strings in, steps out.

mod config;
mod course;
mod directions;
mod entry;
mod event;
mod lines;
mod moves;
mod orders;
mod path;
mod task;

pub use config::MicromillConfig;
pub use event::{MicromillEvent, MicromillInputs, MicromillStep};

use husillo_gcode::SpindleDirection;
use husillo_planner::Timer;
use husillo_transports::micromill::{Answer, Axis, Device, Order, Stops};

use crate::controller::{Controller, StopBytes, Timed};
use crate::ring::Ring;
use course::Course;
use directions::Directions;
use entry::{Entry, Place};
use husillo_backlash::Play;
use husillo_machine::{MAX_WAIT_TICKS, StepGuard};
use path::Flat;
use task::Task;

/// An event that was given and is not yet made.
#[derive(Copy, Clone, Debug)]
struct Given {
    directions: Directions,
    /// Axes whose load it moves.
    loads: u8,
    /// Number of lines that end with it.
    ends: u8,
}

/// The controller of the micro mill: bytes of its link in, events for its motors out, in bounded
/// memory.
///
/// | when | call |
/// | --- | --- |
/// | a byte arrives | [`receive`](Micromill::receive); if it returns `true`: stop the motors, report the events made, then call [`halted`](Micromill::halted) |
/// | there is room for events | [`next_event`](Micromill::next_event) |
/// | events were made | [`made`](Micromill::made) |
/// | the transmitter is free | [`transmit`](Micromill::transmit) |
///
/// `QUEUE` lines wait for the present line. `AHEAD` events may be given before they are made. `OUT`
/// bytes wait for the transmitter; when there is no room, the steps wait. `QUEUE` and `AHEAD` are
/// powers of two. A step is reported when it is made. A stop drops the events that were not made.
///
/// The steps are those of [`Machine`](husillo_machine::Machine) for the same program. Homing, jogs
/// and counted steps are decided one step at a time, with the present switches. Before homing the
/// flanks are unknown: the controller refuses lines that move, takes up no backlash, and ends a jog
/// at a switch. After homing a jog ends at the end of the travel.
///
/// # Examples
///
/// ```
/// use husillo_controllers::{Micromill, MicromillConfig, MicromillEvent, MicromillInputs};
///
/// let mut mill: Micromill = Micromill::new(&MicromillConfig::MICROMILL);
/// for byte in *b"PY+0003;" {
///     assert!(!mill.receive(byte));
/// }
/// let mut steps = 0;
/// while let Some(MicromillEvent::Step(step)) = mill.next_event(&MicromillInputs::default()) {
///     steps += step.deltas()[1];
///     mill.made(1);
/// }
/// assert_eq!(steps, 3);
/// let said: Vec<u8> = std::iter::from_fn(|| mill.transmit()).collect();
/// assert_eq!(said, b"\x88PY+0003;\x83\x83\x83\x8f"); // ready, echo, three steps, done
/// ```
#[derive(Clone, Debug)]
pub struct Micromill<'a, const QUEUE: usize = 16, const AHEAD: usize = 8, const OUT: usize = 80> {
    config: &'a MicromillConfig,
    link: Device<OUT>,
    queue: Ring<Entry, QUEUE>,
    /// Whether the controller must still confirm the line that filled the queue.
    owes_taken: bool,
    /// End of the last accepted line, and start of the next line to execute.
    programmed: Place,
    at: Place,
    zero: Place,
    task: Task,
    /// The present move and its state.
    path: Option<Flat>,
    course: Course,
    guard: StepGuard<3>,
    /// Ticks of moves too short for a step. They are added to the next move.
    carried_ticks: u64,
    /// Motors and loads after all given events.
    plays: [Play; 3],
    backlash: [u16; 3],
    ahead: Ring<Given, AHEAD>,
    /// Number of lines that end with a given event.
    ends_ahead: u16,
    lease: Lease,
    is_homed: bool,
    /// Whether the mill was homed when the present homing began.
    was_homed: bool,
}

/// Whether a motion needs the host.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Lease {
    /// The silence was longer than this, ms. Next, the spindle is switched off.
    Over(u16),
    /// The motion needs the host. This is the longest permitted silence, ms.
    Ms(u16),
    /// The motion does not need the host.
    None,
}

/// Result of the search for the next event.
enum Next {
    Give(MicromillEvent),
    /// The state has changed: search again.
    Again,
    /// No event now.
    Wait,
}

impl<'a, const QUEUE: usize, const AHEAD: usize, const OUT: usize>
    Micromill<'a, QUEUE, AHEAD, OUT>
{
    /// Creates a controller in its state after a reset: at rest, not homed.
    pub fn new(config: &'a MicromillConfig) -> Self {
        const { assert!(OUT >= 3 * AHEAD + 32, "room to report the given steps") };
        const { assert!(OUT >= 80, "room to report the state") };
        Micromill {
            config,
            link: Device::new(),
            queue: Ring::new(Entry::NOTHING),
            owes_taken: false,
            programmed: [0; 3],
            at: [0; 3],
            zero: [0; 3],
            task: Task::Idle,
            path: None,
            course: Course::new(Timer::new(0, 1, 1), Directions::NONE),
            guard: StepGuard::new(),
            carried_ticks: 0,
            plays: [Play::new(0); 3],
            backlash: config.machine.axes.map(|axis| axis.backlash_steps as u16),
            ahead: Ring::new(Given {
                directions: Directions::NONE,
                loads: 0,
                ends: 0,
            }),
            ends_ahead: 0,
            lease: Lease::None,
            is_homed: false,
            was_homed: false,
        }
    }

    /// Creates a homed controller at machine zero, with every axis engaged on its positive flank.
    /// For tests and simulations.
    pub fn homed(config: &'a MicromillConfig) -> Self {
        let mut mill = Micromill::new(config);
        for (play, backlash) in mill.plays.iter_mut().zip(mill.backlash) {
            *play = Play::new(backlash);
        }
        mill.is_homed = true;
        mill
    }

    /// Takes a byte from the line. Returns `true` if the motors must stop before the next event.
    /// The caller then reports the events that were [`made`](Micromill::made), drops the others,
    /// and calls [`halted`](Micromill::halted).
    pub fn receive(&mut self, byte: u8) -> bool {
        match self.link.push(byte) {
            None => {}
            Some(Order::Stop) => return true,
            Some(order) => self.obey(order),
        }
        self.tell_motion();
        false
    }

    /// Returns the bytes that stop the present motion. If the foreground may be late, the interrupt
    /// that receives such a byte holds the events. When the foreground takes the byte,
    /// [`receive`](Micromill::receive) requests a stop, or the events continue.
    pub const fn stops(&self) -> Stops {
        self.link.stops()
    }

    /// Returns the longest permitted silence of the line during the present motion, us. After a
    /// longer silence the caller stops the motors, as after [`receive`](Micromill::receive).
    /// `None`: nothing moves, or the host has not requested a lease.
    pub fn lease_us(&self) -> Option<u32> {
        match self.lease {
            Lease::Ms(ms) if self.is_moving() => Some(u32::from(ms).wrapping_mul(1000)), // 10 s
            _ => None,
        }
    }

    /// Ends the motion, because no byte has arrived for [`lease_us`](Micromill::lease_us). The
    /// spindle is switched off, too. The lease also applies to the next motion. The caller stops
    /// the motors and calls [`halted`](Micromill::halted).
    pub const fn expire(&mut self) -> bool {
        if let Lease::Ms(ms) = self.lease {
            self.lease = Lease::Over(ms);
        }
        true
    }

    /// Confirms that the motors have stopped. Drops the queue and undoes the events that were not
    /// made.
    pub fn halted(&mut self) {
        let answer = if self.is_moving() {
            Answer::Stopped
        } else {
            Answer::Taken
        };
        while let Some(given) = self.ahead.pop_last() {
            undo(&mut self.plays, &given);
        }
        self.drop_all();
        self.stand();
        self.link.answer(answer);
        self.tell_motion();
    }

    /// Reports that the oldest `events` events are made.
    #[inline]
    pub fn made(&mut self, events: usize) {
        if !self.reports_next() && events < self.ahead.len() {
            return self.ahead.drop_first(events);
        }
        self.report(events);
    }

    /// Sends the reports of events that were made.
    #[inline(never)]
    fn report(&mut self, events: usize) {
        for _ in 0..events {
            let Some(given) = self.ahead.pop() else {
                return;
            };
            for axis in Axis::ALL {
                let bit = Directions::one(axis, true).axes;
                if given.directions.axes & bit != 0 {
                    self.link.step(axis, given.directions.negative & bit == 0);
                }
            }
            for _ in 0..given.ends {
                self.link.answer(Answer::Done);
            }
            // `ends_ahead` already includes these lines.
            self.ends_ahead = self.ends_ahead.wrapping_sub(given.ends.into());
        }
        if self.ahead.is_empty() {
            self.tell_motion();
        }
    }

    /// Whether the controller sends a report when given events are made. A step or the end of a
    /// line causes a report. The caller then calls [`made`](Micromill::made) immediately after each
    /// event. Otherwise it may call it once for several events, at the cost of one.
    pub const fn reports_next(&self) -> bool {
        self.link.tells_steps() || self.ends_ahead > 0
    }

    /// Returns the next byte for the line.
    pub fn transmit(&mut self) -> Option<u8> {
        self.link.transmit()
    }

    /// Returns the next event for the present switches. Returns `None` if there is none now. The
    /// caller asks again after a byte has arrived, an event was made or a byte was sent.
    #[inline]
    pub fn next_event(&mut self, inputs: &MicromillInputs) -> Option<MicromillEvent> {
        while !self.ahead.is_full() && self.has_room() {
            if let Some(step) = self.step_of_path(inputs) {
                return Some(MicromillEvent::Step(step));
            }
            match self.look(inputs) {
                Next::Give(event) => return Some(event),
                Next::Again => {}
                Next::Wait => {
                    self.tell_motion();
                    return None;
                }
            }
        }
        self.end_walked();
        None
    }

    /// Whether there is room for the reports of all given events and of the next one. Each event
    /// may report three steps.
    #[inline]
    fn has_room(&self) -> bool {
        let to_tell = self.ahead.len().wrapping_mul(3).wrapping_add(3);
        // An empty queue has room for all of them.
        self.link.is_silent() || self.link.has_room(to_tell)
    }

    /// Whether a task is running or a line is queued.
    #[inline(never)] // on a small chip four copies are too many
    pub fn is_moving(&self) -> bool {
        self.task != Task::Idle || !self.ahead.is_empty() || !self.queue.is_empty()
    }

    /// Whether positions count from the home switches.
    pub const fn is_homed(&self) -> bool {
        self.is_homed
    }

    /// Returns the load steps after the events that were made. They count from machine zero. Before
    /// homing they count from the position at power-on.
    pub fn position_steps(&self) -> [i32; 3] {
        let mut plays = self.plays;
        for given in self.ahead.iter() {
            undo(&mut plays, &given);
        }
        plays.map(|play| play.load())
    }

    fn tell_motion(&mut self) {
        let is_jog = matches!(self.task, Task::Jog { .. });
        self.link.set_motion(self.is_moving(), is_jog);
    }

    /// Sets the present position to the position of the loads, computed from their steps.
    fn stand(&mut self) {
        let axes = self.config.machine.axes.iter().zip(&self.plays);
        for (at, (axis, play)) in self.at.iter_mut().zip(axes) {
            let Ok(place) = i32::try_from(axis.scale.position(play.load())) else {
                // No axis can be at this position, so the mill must home again.
                self.is_homed = false;
                continue;
            };
            *at = place;
        }
        self.programmed = self.at;
    }

    fn drop_all(&mut self) {
        self.queue.clear();
        self.ahead.clear();
        self.ends_ahead = 0;
        self.owes_taken = false;
        self.task = Task::Idle;
        self.path = None;
        self.carried_ticks = 0;
        self.guard.rest();
    }

    /// Returns the next event. The caller handles a step of a path directly if nothing precedes it.
    #[inline(never)]
    fn look(&mut self, inputs: &MicromillInputs) -> Next {
        if let Lease::Over(ms) = self.lease {
            self.lease = Lease::Ms(ms);
            return Next::Give(lines::spindle(SpindleDirection::Off, 0));
        }
        if self.path.is_some() {
            return self.precede(inputs);
        }
        if self.task == Task::Idle {
            return self.begin();
        }
        if let Task::Dwell { left_ticks } = self.task {
            let wait_ticks = left_ticks.min(MAX_WAIT_TICKS.into()) as u32;
            if wait_ticks == 0 {
                self.task = Task::Idle;
                self.end_line();
                return Next::Again;
            }
            self.task = Task::Dwell {
                left_ticks: left_ticks.wrapping_sub(wait_ticks.into()),
            };
            return self.give(wait_ticks, Directions::NONE);
        }
        // The controller decides with the switches as they are after the last step.
        if !self.ahead.is_empty() {
            return Next::Wait;
        }
        self.manual(inputs)
    }

    /// Ends the program at the present position. Events that were already given are still made.
    fn cut(&mut self) {
        self.queue.clear();
        self.owes_taken = false;
        self.task = Task::Idle;
        self.path = None;
        self.carried_ticks = 0;
        self.guard.rest();
        self.stand();
        self.link.answer(Answer::Stopped);
    }

    fn give(&mut self, wait_ticks: u32, directions: Directions) -> Next {
        let (mut loads, mut bit) = (0, 1_u8);
        for play in &mut self.plays {
            if directions.axes & bit != 0 && play.step(directions.negative & bit == 0) {
                loads |= bit;
            }
            bit = bit.wrapping_shl(1);
        }
        self.guard.stepped_aside(wait_ticks, directions.axes);
        Next::Give(MicromillEvent::Step(
            self.say(wait_ticks, directions, loads),
        ))
    }

    #[inline]
    fn say(&mut self, wait_ticks: u32, directions: Directions, loads: u8) -> MicromillStep {
        self.ahead.push(Given {
            directions,
            loads,
            ends: 0,
        });
        MicromillStep {
            wait_ticks,
            axes: directions.axes,
            negative: directions.negative,
        }
    }

    /// Ends the present line. The line is done when all given events are made.
    fn end_line(&mut self) {
        match self.ahead.last_mut() {
            // At most `QUEUE` lines end with one event.
            Some(given) => {
                if let Some(ends) = given.ends.checked_add(1) {
                    given.ends = ends;
                    self.ends_ahead = self.ends_ahead.wrapping_add(1); // at most 255 AHEAD
                }
            }
            None => self.link.answer(Answer::Done),
        }
    }
}

impl<const QUEUE: usize, const AHEAD: usize, const OUT: usize> Controller
    for Micromill<'_, QUEUE, AHEAD, OUT>
{
    type Inputs = MicromillInputs;
    type Event = MicromillEvent;
    type Stops = Stops;

    const AHEAD: usize = AHEAD;

    fn receive(&mut self, byte: u8) -> bool {
        Micromill::receive(self, byte)
    }

    fn stops(&self) -> Stops {
        Micromill::stops(self)
    }

    fn halted(&mut self) {
        Micromill::halted(self);
    }

    fn lease_us(&self) -> Option<u32> {
        Micromill::lease_us(self)
    }

    fn expire(&mut self) -> bool {
        Micromill::expire(self)
    }

    #[inline(always)]
    fn next_event(&mut self, machine: u8, inputs: &MicromillInputs) -> Option<MicromillEvent> {
        if machine > 0 {
            return None;
        }
        Micromill::next_event(self, inputs)
    }

    fn made(&mut self, _: u8, events: usize) {
        Micromill::made(self, events);
    }

    fn reports_next(&self) -> bool {
        Micromill::reports_next(self)
    }

    fn transmit(&mut self) -> Option<u8> {
        Micromill::transmit(self)
    }

    fn reset(&mut self) {
        *self = Micromill::new(self.config);
    }
}

impl StopBytes for Stops {
    const NONE: Self = Stops::Nothing;

    fn takes(self, byte: u8) -> bool {
        Stops::takes(self, byte)
    }
}

impl Timed for MicromillEvent {
    fn wait_ticks(&self) -> Option<u32> {
        match *self {
            MicromillEvent::Step(step) => Some(step.wait_ticks),
            MicromillEvent::Spindle { .. } | MicromillEvent::Tool { .. } => None,
        }
    }
}

/// Returns the first axis that steps in a direction with backlash to take up, and the steps left of
/// its take-up.
fn first_owed(plays: &[Play; 3], directions: Directions) -> Option<(Directions, u16)> {
    let mut bit = 1_u8;
    for play in plays {
        let negative = directions.negative & bit;
        if directions.axes & bit != 0 && play.owes(negative == 0) {
            let direction = Directions {
                axes: bit,
                negative,
            };
            return Some((direction, play.owed(negative == 0)));
        }
        bit = bit.wrapping_shl(1);
    }
    None
}

/// Undoes an event, the last one given.
fn undo(plays: &mut [Play; 3], given: &Given) {
    let mut bit = 1_u8;
    for play in plays {
        if given.directions.axes & bit != 0 {
            play.undo(given.directions.negative & bit == 0, given.loads & bit != 0);
        }
        bit = bit.wrapping_shl(1);
    }
}
