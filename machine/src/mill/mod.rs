//! The micro mill: its strings in, its steps out.

mod config;
mod entry;
mod event;
mod path;
mod ring;
mod task;
mod ways;

pub use config::MillConfig;
pub use event::{MillEvent, MillInputs, MillStep};

use husillo_gcode::SpindleDirection;
use husillo_interp::{Interpolator, Moves};
use husillo_planner::Timer;
use husillo_transports::micromill::{Answer, Axis, Device, Line, Order, Stops};

use crate::{Config, MAX_WAIT_TICKS, Segment, cell::play::Play, segment::lattice};
use entry::{Entry, Kind, Place, nm};
use path::Flat;
use ring::Ring;
use task::{Course, Task};
use ways::Ways;

/// An event that was given and is not made yet.
#[derive(Copy, Clone, Debug)]
struct Given {
    ways: Ways,
    /// The axes whose load it moves.
    loads: u8,
    /// Lines that are done with it.
    ends: u8,
}

/// The micro mill's controller: bytes of its link in, events for its motors out, in bounded memory.
///
/// | when | call |
/// | --- | --- |
/// | a byte arrives | [`receive`](Mill::receive); where it says so: stop the motors, tell what was made, then [`halted`](Mill::halted) |
/// | there is room for events | [`next_event`](Mill::next_event) |
/// | an event was made | [`made`](Mill::made) |
/// | the transmitter is free | [`transmit`](Mill::transmit) |
///
/// `QUEUE` lines wait for the one that is executed, `AHEAD` events may be given before they are made, `OUT` bytes wait for the transmitter: when
/// they are too many, the steps wait. A step is told when it was made, and a stop drops what was not.
///
/// Steps are those of [`Machine`](crate::Machine) for the same program. Homing, jogs and counted steps are decided one at a time, with the switches
/// as they are then. Before homing the flanks are not known: lines that move are refused, lash is not taken up, and a jog ends at a switch;
/// after it jogs end where the travel does.
///
/// ```
/// use husillo_machine::{Mill, MillConfig, MillEvent, MillInputs};
///
/// let mut mill: Mill = Mill::new(&MillConfig::MICROMILL);
/// for byte in *b"PY+0003;" {
///     assert!(!mill.receive(byte));
/// }
/// let mut steps = 0;
/// while let Some(MillEvent::Step(step)) = mill.next_event(&MillInputs::default()) {
///     steps += step.deltas()[1];
///     mill.made();
/// }
/// assert_eq!(steps, 3);
/// let said: Vec<u8> = std::iter::from_fn(|| mill.transmit()).collect();
/// assert_eq!(said, b"\x88PY+0003;\x83\x83\x83\x8f"); // ready, echo, three steps, done
/// ```
#[derive(Clone, Debug)]
pub struct Mill<'a, const QUEUE: usize = 16, const AHEAD: usize = 8, const OUT: usize = 64> {
    config: &'a MillConfig,
    link: Device<OUT>,
    queue: Ring<Entry, QUEUE>,
    /// The line that filled the queue has not been confirmed.
    owes_taken: bool,
    /// Where the last line taken ends, and where the next one to be executed begins.
    programmed: Place,
    at: Place,
    zero: Place,
    task: Task,
    /// The move under way, and what goes with it.
    path: Option<Flat>,
    course: Course,
    /// Ticks of moves too short for a step: they belong to the next one.
    carried_ticks: u64,
    /// Motors and loads after the events given.
    plays: [Play; 3],
    lash: [u16; 3],
    ahead: Ring<Given, AHEAD>,
    /// Lines that end with an event given.
    ends_ahead: u16,
    /// How long a jog lasts without being renewed.
    lease_ticks: Option<u32>,
    is_homed: bool,
}

/// What comes of looking for the next event.
enum Next {
    Give(MillEvent),
    /// Something has changed: look again.
    Again,
    /// Not now.
    Wait,
}

impl<'a, const QUEUE: usize, const AHEAD: usize, const OUT: usize> Mill<'a, QUEUE, AHEAD, OUT> {
    /// After a reset: at rest, not homed.
    pub fn new(config: &'a MillConfig) -> Self {
        const { assert!(QUEUE > 0 && AHEAD > 0, "places for a line and an event") };
        const { assert!(OUT >= 3 * AHEAD + 32, "room to tell the steps given") };
        Mill {
            config,
            link: Device::new(),
            queue: Ring::new(Entry::NOTHING),
            owes_taken: false,
            programmed: [0; 3],
            at: [0; 3],
            zero: [0; 3],
            task: Task::Idle,
            path: None,
            course: Course::new(Timer::new(0, 1, 1), Ways::NONE),
            carried_ticks: 0,
            plays: [Play::new(0); 3],
            lash: config.machine.axes.map(|axis| axis.lash_steps as u16),
            ahead: Ring::new(Given {
                ways: Ways::NONE,
                loads: 0,
                ends: 0,
            }),
            ends_ahead: 0,
            lease_ticks: None,
            is_homed: false,
        }
    }

    /// A controller that has been homed: it stands at machine zero, every axis engaged on its positive flank. For tests and simulations.
    pub fn homed(config: &'a MillConfig) -> Self {
        let mut mill = Mill::new(config);
        for (play, lash) in mill.plays.iter_mut().zip(mill.lash) {
            *play = Play::new(lash);
        }
        mill.is_homed = true;
        mill
    }

    /// Takes a byte of the line. `true`: stop the motors before the next event, say [`made`](Mill::made) for every event that was, drop the others,
    /// and call [`halted`](Mill::halted).
    pub fn receive(&mut self, byte: u8) -> bool {
        match self.link.push(byte) {
            None => {}
            Some(Order::Stop) => return true,
            Some(order) => self.obey(order),
        }
        self.tell_motion();
        false
    }

    /// Which bytes stop what moves now. Where the foreground may be late, the interrupt that hears one of them holds the events back at once;
    /// when it is taken, [`receive`](Mill::receive) says that it stops, or they go on.
    pub const fn stops(&self) -> Stops {
        self.link.stops()
    }

    /// The motors have stopped: what was queued is dropped, and the events that were not made have not been.
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

    /// The oldest event that was given has been made.
    #[inline]
    pub fn made(&mut self) {
        let Some(given) = self.ahead.pop() else {
            return;
        };
        if self.link.tells_steps() || given.ends > 0 || self.ahead.is_empty() {
            self.tell(&given);
        }
    }

    /// What there is to say of an event that was made.
    #[inline(never)]
    fn tell(&mut self, given: &Given) {
        for axis in Axis::ALL {
            let bit = Ways::one(axis, true).axes;
            if given.ways.axes & bit != 0 {
                self.link.step(axis, given.ways.negative & bit == 0);
            }
        }
        for _ in 0..given.ends {
            self.link.answer(Answer::Done);
        }
        self.ends_ahead = self.ends_ahead.wrapping_sub(given.ends.into()); // they were counted
        if self.ahead.is_empty() {
            self.tell_motion();
        }
    }

    /// Whether something is told when events that were given have been made, steps or that a line is done: then [`made`](Mill::made) should be said of each at
    /// once. Otherwise the foreground may wait until some have been made.
    pub const fn will_tell(&self) -> bool {
        self.link.tells_steps() || self.ends_ahead > 0
    }

    /// The next byte for the line.
    pub fn transmit(&mut self) -> Option<u8> {
        self.link.transmit()
    }

    /// What happens next, with the switches as they are now. `None`: nothing now; ask again when a byte has come, an event was made or a byte sent.
    #[inline]
    pub fn next_event(&mut self, inputs: &MillInputs) -> Option<MillEvent> {
        loop {
            // Every event given may tell three steps, and so may the next one.
            let to_tell = self.ahead.len().wrapping_mul(3).wrapping_add(3);
            if self.ahead.is_full() || !self.link.has_room(to_tell) {
                return None;
            }
            if let Some(step) = self.step_of_path(inputs) {
                return Some(MillEvent::Step(step));
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
    }

    /// Whether anything is under way or queued.
    pub fn is_moving(&self) -> bool {
        self.task != Task::Idle || !self.ahead.is_empty() || !self.queue.is_empty()
    }

    /// Whether positions count from the home switches.
    pub const fn is_homed(&self) -> bool {
        self.is_homed
    }

    /// Load steps from machine zero after the events that were made; from where it was switched on before homing.
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

    /// The place of the loads, as steps have it.
    fn stand(&mut self) {
        let axes = self.config.machine.axes.iter().zip(&self.plays);
        for (at, (axis, play)) in self.at.iter_mut().zip(axes) {
            let Ok(place) = i32::try_from(axis.scale.position(play.load()).0) else {
                // Farther than any axis goes: home again.
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
    }

    fn answer(&mut self, is_obeyed: bool, answer: Answer) {
        self.link
            .answer(if is_obeyed { answer } else { Answer::Refused });
    }

    fn obey(&mut self, order: Order) {
        let is_free = !self.is_moving();
        match order {
            Order::Line(line) => self.take(line),
            Order::Faster => self.change_jog(1),
            Order::Slower => self.change_jog(-1),
            Order::Renew => {
                if let Task::Jog { left_ticks, .. } = &mut self.task {
                    *left_ticks = self.lease_ticks;
                }
            }
            // 9999 ms of a timer of 4 GHz saturate: below its 2^32 ticks all the same.
            Order::Lease(ms) => {
                let ticks = (self.config.machine.timer_hz / 1000).saturating_mul(ms.into());
                self.lease_ticks = (ms != 0).then_some(ticks);
                self.link.answer(Answer::Taken);
            }
            _ if !is_free => self.link.answer(Answer::Refused),
            Order::Jog(ways) => {
                self.task = Task::Jog {
                    ways: Ways::of(ways),
                    hz: self.config.jog_hz,
                    left_ticks: self.lease_ticks,
                };
            }
            Order::Run(axis, hz) => {
                let is_right = hz.unsigned_abs() <= self.config.top_hz;
                if is_right {
                    self.task = Task::Run {
                        ways: Ways::one(axis, hz > 0),
                        hz: hz.unsigned_abs(),
                    };
                } else {
                    self.link.answer(Answer::Refused);
                }
            }
            Order::Steps(axis, steps) => {
                if self.reaches(axis, steps) {
                    self.task = Task::Steps {
                        ways: Ways::one(axis, steps > 0),
                        left: steps.unsigned_abs(),
                    };
                } else {
                    self.link.answer(Answer::Refused);
                }
            }
            Order::Backlash(axis, um) => self.set_lash(axis, um),
            Order::Home => {
                self.is_homed = false;
                for play in &mut self.plays {
                    play.set_lash(0);
                }
                self.task = Task::Leave {
                    axis: Axis::Z,
                    left: self.config.search_steps,
                };
            }
            Order::Zero => {
                if self.is_homed {
                    self.zero = self.programmed;
                }
                self.answer(self.is_homed, Answer::Done);
            }
            Order::Stop | Order::Stream(_) | Order::Every(_) => {}
        }
    }

    /// A line: refused, or in the queue.
    fn take(&mut self, line: Line) {
        let is_streaming = self.link.is_streaming();
        let is_free = if is_streaming {
            !self.owes_taken && !self.task.is_manual()
        } else {
            !self.is_moving()
        };
        let entry = if is_free { self.check(line) } else { None };
        let Some(entry) = entry else {
            return self.link.answer(Answer::Refused);
        };
        self.programmed = entry.to;
        if line == Line::Zero {
            self.zero = self.programmed;
        }
        self.queue.push(entry);
        if is_streaming {
            if self.queue.is_full() {
                self.owes_taken = true;
            } else {
                self.link.answer(Answer::Taken);
            }
        }
    }

    /// The line, if it can be made.
    #[inline(never)]
    fn check(&self, line: Line) -> Option<Entry> {
        let entry = Entry::new(line, self.programmed, self.zero)?;
        let needs_home = entry.moves() || line == Line::Zero;
        if needs_home && !self.is_homed {
            return None;
        }
        if entry.moves() {
            let command = entry.command(self.programmed)?;
            let from = nm(self.programmed);
            let machine = &self.config.machine;
            machine.check_arcs(&from, &command, Flat::fits).ok()?;
        }
        Some(entry)
    }

    fn change_jog(&mut self, way: i16) {
        if let Task::Jog { hz, .. } = &mut self.task {
            let change = self.config.jog_change_hz;
            let top = self.config.top_hz.max(1);
            *hz = if way > 0 {
                hz.saturating_add(change).min(top)
            } else {
                hz.saturating_sub(change).max(change.max(1)).min(top)
            };
        }
    }

    fn set_lash(&mut self, axis: Axis, um: u16) {
        let axes = Axis::ALL.into_iter().zip(&self.config.machine.axes);
        let axes = axes.zip(self.lash.iter_mut().zip(&mut self.plays));
        for ((other, config), (lash, play)) in axes {
            if other == axis {
                let way = husillo_gcode::Nm(i64::from(um).wrapping_mul(1000));
                let steps = config.scale.nearest(way).unwrap_or(0);
                *lash = steps.clamp(0, u16::MAX.into()) as u16;
                if self.is_homed {
                    play.set_lash(*lash);
                }
            }
        }
        self.link.answer(Answer::Done);
    }

    /// Whether an axis may go so many steps further.
    fn reaches(&self, axis: Axis, steps: i16) -> bool {
        let axes = Axis::ALL.into_iter().zip(&self.config.machine.axes);
        axes.zip(&self.plays).all(|((other, config), play)| {
            let travel = if self.is_homed { config.travel } else { None };
            match travel {
                Some([low, high]) if other == axis => {
                    let to = config
                        .scale
                        .position(play.load().saturating_add(steps.into()));
                    (low..=high).contains(&to)
                }
                _ => true,
            }
        })
    }

    /// What comes next where it is no step of a path that nothing stands before.
    #[inline(never)]
    fn look(&mut self, inputs: &MillInputs) -> Next {
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
            return self.give(wait_ticks, Ways::NONE);
        }
        // With the switches as they are after the last step.
        if !self.ahead.is_empty() {
            return Next::Wait;
        }
        self.manual(inputs)
    }

    /// Begins the next line of the queue.
    #[inline(never)]
    fn begin(&mut self) -> Next {
        let Some(entry) = self.queue.first() else {
            return Next::Wait;
        };
        // As the machine has it: what only changes coordinates does not wait for the moves before it.
        let is_nothing = entry.kind == Kind::Nothing;
        if !entry.moves() && !is_nothing && self.carried_ticks > 0 {
            self.task = Task::Idle;
            let wait_ticks = self.carried_ticks.min(MAX_WAIT_TICKS.into()) as u32;
            self.carried_ticks = self.carried_ticks.wrapping_sub(wait_ticks.into());
            return self.give(wait_ticks, Ways::NONE);
        }
        let is_output = !entry.moves() && !matches!(entry.kind, Kind::Nothing | Kind::Dwell);
        if is_output && !self.ahead.is_empty() {
            return Next::Wait; // exactly between the moves
        }
        self.queue.pop();
        if core::mem::take(&mut self.owes_taken) {
            self.link.answer(Answer::Taken);
        }
        let spindle = |direction| MillEvent::Spindle {
            direction,
            rpm: entry.value,
        };
        let event = match entry.kind {
            Kind::Nothing => {
                self.end_line();
                return Next::Again;
            }
            Kind::Dwell => {
                let ticks =
                    u64::from(entry.value).wrapping_mul(u64::from(self.config.machine.timer_hz)); // below 2^48
                self.task = Task::Dwell { left_ticks: ticks };
                return Next::Again;
            }
            Kind::SpindleClockwise => spindle(SpindleDirection::Clockwise),
            Kind::SpindleCounterClockwise => spindle(SpindleDirection::CounterClockwise),
            Kind::SpindleOff | Kind::End => spindle(SpindleDirection::Off),
            Kind::Tool => MillEvent::Tool {
                number: entry.value as u8,
            },
            Kind::Rapid | Kind::Linear | Kind::Clockwise | Kind::CounterClockwise => {
                self.begin_move(&entry);
                return Next::Again;
            }
        };
        self.end_line();
        Next::Give(event)
    }

    #[inline(never)]
    fn begin_move(&mut self, entry: &Entry) {
        let ticks = self.set_out(entry);
        self.at = entry.to;
        if self.path.is_none() {
            self.carried_ticks = self.carried_ticks.saturating_add(ticks);
            self.end_line();
        } else {
            self.task = Task::Line;
        }
    }

    /// Makes the path of a move; its ticks. Without a step of an axis there is none.
    ///
    /// Apart from its caller and from what it calls: on a small chip the stack holds one path at a time.
    #[inline(never)]
    fn set_out(&mut self, entry: &Entry) -> u64 {
        let start = self.plays.map(|play| play.load());
        let end = lattice(&self.config.machine.axes, &nm(entry.to)).unwrap_or(start);
        // A line that is none was refused when it came.
        let Some(segment) = segment(entry, self.at) else {
            return 0;
        };
        lay(&mut self.path, &self.config.machine, &segment, start, end);
        let Some(path) = &self.path else { return 0 };
        let ticks = ticks(&self.config.machine, &segment, path);
        if path.remaining() == 0 {
            self.path = None;
            return ticks;
        }
        let mut heading = Ways::NONE;
        if path.radius().is_none() {
            for (axis, (start, end)) in (0..).zip(start.iter().zip(end)) {
                let way = i8::from(end > *start).wrapping_sub(i8::from(end < *start));
                heading = heading.with(axis, way);
            }
        }
        let (sweep, largest) = (path.total_sweep(), path.largest_sweep());
        self.course = Course::new(Timer::new(ticks, sweep, largest.into()), heading);
        ticks
    }

    /// The next step of the move under way, unless something comes before it: then that step is kept, and [`look`](Mill::look) decides.
    #[inline]
    fn step_of_path(&mut self, inputs: &MillInputs) -> Option<MillStep> {
        let (path, course) = (self.path.as_mut()?, &mut self.course);
        let (ways, wait) = match course.next {
            Some(next) => {
                course.next = None;
                next
            }
            None => {
                let Some(step) = path.next() else {
                    self.end_path();
                    return None;
                };
                let ways = Ways {
                    axes: step.axes,
                    negative: step.negative,
                };
                let wait = match path {
                    Flat::Line(_) => course.timer.wait_one(),
                    Flat::Arc(_) => {
                        course.turns(ways);
                        course.timer.wait(step.sweep.into())
                    }
                };
                (ways, wait)
            }
        };
        if course.may_owe || wait > u64::from(MAX_WAIT_TICKS) || ways.negative & inputs.home != 0 {
            course.next = Some((ways, wait));
            return None;
        }
        let is_last = path.remaining() == 0;
        // It owes nothing: it moves loads.
        let (axes, negative) = (i32::from(ways.axes), i32::from(ways.negative));
        let [x, y, z] = &mut self.plays;
        x.carry((axes & 1).wrapping_sub((negative & 1) << 1));
        y.carry((axes >> 1 & 1).wrapping_sub(negative & 2));
        z.carry((axes >> 2).wrapping_sub(negative >> 1 & 2));
        let step = self.say(wait as u32, ways, ways.axes);
        if is_last {
            self.end_path();
        }
        Some(step)
    }

    /// What comes before a step of the path: a take-up, or a part of its wait; or it does not come.
    fn precede(&mut self, inputs: &MillInputs) -> Next {
        let course = &mut self.course;
        let Some((ways, mut wait)) = course.next.take() else {
            return Next::Again;
        };
        if course.may_owe {
            // At the first step of a move, too.
            wait = wait.saturating_add(core::mem::take(&mut self.carried_ticks));
            // A straight move takes up all its axes before it begins, an arc each where it turns round.
            let owed = owed(&self.plays, course.heading);
            if let Some(owed) = owed.or_else(|| self::owed(&self.plays, ways)) {
                course.next = Some((ways, wait));
                return self.take_up(owed);
            }
            course.is_even();
        }
        if wait > u64::from(MAX_WAIT_TICKS) {
            course.next = Some((ways, wait.wrapping_sub(MAX_WAIT_TICKS.into())));
            return self.give(MAX_WAIT_TICKS, Ways::NONE);
        }
        if ways.negative & inputs.home != 0 {
            // Within the travel no switch closes: steps were lost.
            self.is_homed = false;
            self.cut();
            return Next::Wait;
        }
        course.next = Some((ways, wait));
        Next::Again
    }

    #[inline(never)]
    fn end_path(&mut self) {
        self.path = None;
        self.task = Task::Idle;
        self.end_line();
    }

    /// A step of an axis that moves no load.
    #[inline(never)]
    fn take_up(&mut self, owed: Ways) -> Next {
        let number = usize::from(owed.axes >> 1); // of the bits 1, 2 and 4
        let axis = self.config.machine.axes.get(number);
        let hz = axis.map_or(1, |axis| axis.max_rate_hz);
        let wait_ticks = self.course.pace(number, self.config.machine.timer_hz, hz);
        self.give(wait_ticks, owed)
    }

    /// Ends everything where it is; what was given is still made.
    fn cut(&mut self) {
        self.queue.clear();
        self.owes_taken = false;
        self.task = Task::Idle;
        self.path = None;
        self.carried_ticks = 0;
        self.stand();
        self.link.answer(Answer::Stopped);
    }

    fn give(&mut self, wait_ticks: u32, ways: Ways) -> Next {
        let (mut loads, mut bit) = (0, 1_u8);
        for play in &mut self.plays {
            if ways.axes & bit != 0 && play.step(ways.negative & bit == 0) {
                loads |= bit;
            }
            bit = bit.wrapping_shl(1);
        }
        Next::Give(MillEvent::Step(self.say(wait_ticks, ways, loads)))
    }

    #[inline]
    fn say(&mut self, wait_ticks: u32, ways: Ways, loads: u8) -> MillStep {
        self.ahead.push(Given {
            ways,
            loads,
            ends: 0,
        });
        MillStep {
            wait_ticks,
            axes: ways.axes,
            negative: ways.negative,
        }
    }

    /// The line is done when all that was given has been made.
    fn end_line(&mut self) {
        match self.ahead.last_mut() {
            // `QUEUE` lines at most end with one event.
            Some(given) => {
                if let Some(ends) = given.ends.checked_add(1) {
                    given.ends = ends;
                    self.ends_ahead = self.ends_ahead.wrapping_add(1); // 255 AHEAD at most
                }
            }
            None => self.link.answer(Answer::Done),
        }
    }
}

#[inline(never)]
fn segment(entry: &Entry, from: Place) -> Option<Segment<3>> {
    let command = entry.command(from)?;
    Some(Segment {
        from: nm(from),
        command,
    })
}

#[inline(never)]
fn lay(
    place: &mut Option<Flat>,
    machine: &Config<3>,
    segment: &Segment<3>,
    start: [i32; 3],
    end: [i32; 3],
) {
    *place = Some(machine.path(segment, start, end));
}

#[inline(never)]
fn ticks(machine: &Config<3>, segment: &Segment<3>, path: &Flat) -> u64 {
    machine.tempo(segment, path).ticks(100)
}

/// The first axis that goes a way which it takes up lash for.
fn owed(plays: &[Play; 3], ways: Ways) -> Option<Ways> {
    let mut bit = 1_u8;
    for play in plays {
        let negative = ways.negative & bit;
        if ways.axes & bit != 0 && play.owes(negative == 0) {
            return Some(Ways {
                axes: bit,
                negative,
            });
        }
        bit = bit.wrapping_shl(1);
    }
    None
}

/// As if an event, the last one of those given, had not been.
fn undo(plays: &mut [Play; 3], given: &Given) {
    let mut bit = 1_u8;
    for play in plays {
        if given.ways.axes & bit != 0 {
            play.undo(given.ways.negative & bit == 0, given.loads & bit != 0);
        }
        bit = bit.wrapping_shl(1);
    }
}
