//! Lines in, events out.

use husillo_backlash::{Backlash, Flank, Lash};
use husillo_gcode::{Block, Command, Commands, Modal, Nm, PathMode, SpindleDirection};
use husillo_interp::{Moves, Path, Step};
use husillo_planner::{Ramp, Timer};

use crate::{
    Config, Event, FollowEvent, MAX_WAIT_TICKS, Output, Pause, Refused, Segment, StepEvent,
    schedule::Schedule,
    take_up::{Followed, TakeUp},
};

/// What the event given last belongs to.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Nothing has moved yet, or an output, a dwell or a pause.
    Rest,
    /// Backlash of an axis that turns round; the load stands still.
    TakeUp,
    /// A rapid move.
    Rapid,
    /// A feed move: line or arc.
    Feed,
}

/// A machine of `N` axes: takes lines, gives events, never blocks.
///
/// `P` is the interpolator and `L` the lash model of each axis; the defaults are the toolkit's own. `QUEUE` moves are planned
/// ahead, the executing one included; each takes 624 bytes on a 64-bit host (three axes, `Path`).
/// It stands at machine zero when new, every axis engaged on its positive flank (it was pulled off its switch).
///
/// Steps of events are the motors'. Where the lash is another at every place ([`Lash::follow`]), an axis owes a step now and then while it
/// moves: a step of the path then carries one more, one less, or one of an axis that stands; a second step of an axis goes before it
/// in half the time, or within the axis' highest rate.
#[derive(Clone, Debug)]
pub struct Machine<const N: usize, P = Path<N>, L: Lash<N> = Backlash, const QUEUE: usize = 16> {
    config: Config<N>,
    modal: Modal<N>,
    /// What is left of the block taken last.
    commands: Option<Commands<N>>,
    /// Its next command: it waits for its place in the queue.
    next: Option<Command<N>>,
    /// A command that acts when all moves before it have been made.
    waiting: Option<Command<N>>,
    schedule: Schedule<N, P, QUEUE>,
    run: Option<Run<P>>,
    ramp: Ramp,
    /// How moves join after the line taken last.
    mode: PathMode,
    has_ended: bool,
    segment: Option<Segment<N>>,
    take_up: TakeUp<N, L>,
    /// The step that waits for the take-up, or for the rest of a long wait.
    held: Option<([i8; N], u64)>,
    /// Outputs and pauses of the command begun last.
    signals: [Option<Event<N>>; 4],
    /// Ticks of moves too short for a step: they belong to the next one.
    carried_ticks: u64,
    load: [i32; N],
    origin: Origin,
}

/// The move that is being made.
#[derive(Clone, Debug)]
struct Run<P> {
    path: P,
    /// Its steps at constant speed; without one the ramp times them.
    timer: Option<Timer>,
    /// Events of this part of it.
    left: u32,
    /// A step that was not made: the hold came before it.
    next: Option<Step>,
    /// The timer counts the spindle's turning, not time.
    follows: bool,
}

impl<const N: usize, P: Moves<N>, const QUEUE: usize> Machine<N, P, Backlash, QUEUE> {
    /// A machine with one lash value an axis.
    pub fn new(config: Config<N>) -> Self {
        let lash = config
            .axes
            .map(|axis| Backlash::new(axis.lash_steps, Flank::Positive));
        Self::with_lash(config, lash)
    }
}

impl<const N: usize, P: Moves<N>, L: Lash<N>, const QUEUE: usize> Machine<N, P, L, QUEUE> {
    /// A machine with a lash model of your own for every axis, and a queue of your own length.
    pub fn with_lash(config: Config<N>, lash: [L; N]) -> Self {
        const { assert!(QUEUE > 0, "the move that is executed takes a place") };
        Self {
            config,
            modal: Modal::new(config.dialect),
            commands: None,
            next: None,
            waiting: None,
            schedule: Schedule::new(&config),
            run: None,
            ramp: Ramp::new(config.timer_hz),
            mode: PathMode::Blend { tolerance: None },
            has_ended: false,
            segment: None,
            take_up: TakeUp::new(lash),
            held: None,
            signals: [const { None }; 4],
            carried_ticks: 0,
            load: [0; N],
            origin: Origin::Rest,
        }
    }

    /// Switches the take-up of backlash on (as it is at first) or off. While nothing is queued: moves are planned with
    /// their stops for take-up or without them.
    pub fn set_compensation(&mut self, on: bool) {
        self.take_up.set_on(on);
    }

    /// Takes one block of text.
    ///
    /// Everything is checked before anything moves: the words, the modal rules, the travel of every
    /// axis along the whole path. Its moves join the queue as far as there is room: the more lines are taken before
    /// events are asked for, the further ahead speeds are planned.
    ///
    /// # Errors
    /// [`Refused::Busy`] while a command of the block before has not found its place in the queue; otherwise what is
    /// wrong. In every case nothing has changed.
    pub fn line(&mut self, text: &[u8]) -> Result<(), Refused> {
        if !self.has_room() {
            return Err(Refused::Busy);
        }
        let mut block = Block::new();
        block.read(text, &self.config.dialect)?;
        self.block(&block)
    }

    /// Takes one block, as [`Machine::line`] does: one of a program whose expressions were worked out before.
    ///
    /// # Errors
    /// Those of [`Machine::line`].
    pub fn block(&mut self, block: &Block) -> Result<(), Refused> {
        if !self.has_room() {
            return Err(Refused::Busy);
        }
        let mut modal = self.modal.clone();
        let mut commands = Commands::new();
        modal.apply(block, &mut commands)?;
        let (mut from, mut mode, mut has_ended) = (self.modal.position(), self.mode, false);
        for command in commands.clone() {
            self.config.check(&from, &command)?;
            from = command.end().unwrap_or(from);
            if let Command::Path { mode: next } = command {
                mode = next;
            }
            has_ended = matches!(command, Command::End { .. });
        }
        self.modal = modal;
        self.has_ended = has_ended;
        self.mode = mode;
        self.commands = Some(commands);
        self.fill();
        Ok(())
    }

    /// Whether [`Machine::line`] takes a line now, if it is right; otherwise it answers [`Refused::Busy`].
    pub const fn has_room(&self) -> bool {
        self.next.is_none()
    }

    /// Whether the line taken last ended its program (M2, M30): what may follow in the file is no part of it.
    pub const fn has_ended(&self) -> bool {
        self.has_ended
    }

    /// Moves commands into the queue, up to one that has to wait for all moves before it.
    fn fill(&mut self) {
        loop {
            if self.next.is_none() {
                self.next = self.commands.as_mut().and_then(Iterator::next);
            }
            if self.waiting.is_some() || self.schedule.is_full() {
                return;
            }
            let has_lash = self.take_up.stops();
            if !self.schedule.is_whole() {
                self.schedule.push_part(None, has_lash);
                continue;
            }
            match self.next.take() {
                None => {
                    self.commands = None;
                    return;
                }
                Some(Command::Path { mode }) => self.schedule.set_mode(mode),
                Some(command) if command.end().is_some() => {
                    self.schedule.push(&self.config, command, has_lash);
                }
                other => self.waiting = other,
            }
        }
    }

    /// Feed hold: brakes along the path within the acceleration of the axes and stops; nothing is lost. Without ramps it stops
    /// at once, as it started. Events end (`None`) when it stands, until [`Machine::resume`]. A take-up with ramps is finished first.
    pub fn hold(&mut self) {
        self.ramp.hold();
    }

    /// Ends a hold.
    pub fn resume(&mut self) {
        self.ramp.resume();
    }

    /// Whether a hold is on.
    pub const fn is_held(&self) -> bool {
        self.ramp.is_held()
    }

    /// Scales the programmed feeds, 10 to 200 percent (others are taken as the nearest of these), never above what the
    /// axes can do. Rapids stay as they are.
    ///
    /// Takes effect at the next event where there are ramps, otherwise with the next move.
    pub fn set_feed_override(&mut self, percent: u8) {
        self.schedule.moves.set_override(percent);
    }

    /// The next event, or `None` when all that was taken has been given out, or under a hold.
    ///
    /// Constant time, except where a move ends and its place is taken: then an arc is walked once, 9 ns an event on a
    /// desktop, 73 instructions on a Cortex-M4F.
    #[inline]
    pub fn next_event(&mut self) -> Option<Event<N>> {
        match &mut self.run {
            Some(Run {
                path,
                timer: Some(timer),
                follows: false,
                ..
            }) if self.held.is_none()
                && !self.take_up.is_under_way()
                && !self.ramp.is_held()
                && self.carried_ticks == 0 =>
            {
                match path.next() {
                    Some(step) => {
                        let wait = timer.wait(step.sweep.into());
                        Some(self.path_step(step, wait))
                    }
                    None => {
                        self.finish();
                        self.next_unhurried()
                    }
                }
            }
            _ => self.next_unhurried(),
        }
    }

    /// A step of the path, unless an axis turns round and must be taken up first.
    #[inline]
    fn path_step(&mut self, step: Step, wait: u64) -> Event<N> {
        let delta = step.deltas();
        if self.take_up.may_owe(step) {
            self.take_up.turn(&delta, self.load, &self.config);
            if let Some(event) = self.take_up_step() {
                self.held = Some((delta, wait));
                return event;
            }
        }
        self.give(delta, wait)
    }

    /// A step of the path that nothing stands before any more.
    #[inline]
    fn give(&mut self, delta: [i8; N], wait: u64) -> Event<N> {
        let follows = self.is_following();
        if wait > u64::from(MAX_WAIT_TICKS) {
            self.held = Some((delta, wait.wrapping_sub(u64::from(MAX_WAIT_TICKS))));
            return if follows {
                Event::Follow(FollowEvent {
                    wait_counts_q16: MAX_WAIT_TICKS,
                    delta: [0; N],
                })
            } else {
                Event::Dwell {
                    wait_ticks: MAX_WAIT_TICKS,
                }
            };
        }
        let mut to = self.load;
        for (to, delta) in to.iter_mut().zip(delta) {
            // Every end was checked to be within 31 bits, and the path stays next to it.
            *to = to.wrapping_add(i32::from(delta));
        }
        if !L::VARIES {
            self.load = to;
            return self.timed(delta, wait, follows);
        }
        self.give_followed(delta, to, wait, follows)
    }

    /// The step, with those that the lash at its end owes.
    fn give_followed(
        &mut self,
        delta: [i8; N],
        to: [i32; N],
        wait: u64,
        follows: bool,
    ) -> Event<N> {
        match self.take_up.follow(delta, &to, &self.config) {
            Followed::One(motor) => {
                self.load = to;
                self.timed(motor, wait, follows)
            }
            Followed::Two {
                first,
                interval_ticks,
            } => {
                // Half of the time each. Where that would be too fast the path waits; a spindle's turns cannot wait.
                let least = if follows {
                    0
                } else {
                    u64::from(interval_ticks)
                };
                let half = wait >> 1;
                self.held = Some((delta, wait.wrapping_sub(half).max(least)));
                let half = half.max(least).min(MAX_WAIT_TICKS.into());
                self.timed(first, half, follows)
            }
            Followed::Stop => {
                self.held = Some((delta, wait));
                self.take_up_step()
                    .unwrap_or(Event::Dwell { wait_ticks: 0 })
            }
        }
    }

    /// Motor steps of the path, after a wait of [`MAX_WAIT_TICKS`] at most.
    #[inline]
    fn timed(&mut self, delta: [i8; N], wait: u64, follows: bool) -> Event<N> {
        self.origin = match &self.segment {
            Some(Segment {
                command: Command::Rapid { .. },
                ..
            }) => Origin::Rapid,
            _ => Origin::Feed,
        };
        if follows {
            return Event::Follow(FollowEvent {
                wait_counts_q16: wait as u32,
                delta,
            });
        }
        Event::Step(StepEvent {
            wait_ticks: wait as u32,
            delta,
        })
    }

    /// One motor step of take-up, while any is owed.
    fn take_up_step(&mut self) -> Option<Event<N>> {
        let step = self.take_up.step(&self.config)?;
        self.origin = Origin::TakeUp;
        Some(Event::Step(step))
    }

    /// Everything but the next step of a path at constant speed.
    #[cold]
    fn next_unhurried(&mut self) -> Option<Event<N>> {
        loop {
            // An axis with a ramp that is taken up cannot stop at once.
            let stops_at_once = !self.take_up.is_under_way() || !self.schedule.has_ramps();
            // What follows the spindle cannot stop without it.
            let stops_at_once = stops_at_once && !self.is_following() && !self.goes_on_threading();
            if self.ramp.is_held() && stops_at_once && self.ramp.speed_nm_per_s() == 0 {
                return None;
            }
            if let Some(event) = self.take_up_step() {
                return Some(event);
            }
            if let Some((delta, wait)) = self.held.take() {
                return Some(self.give(delta, wait));
            }
            if let Some(signal) = self.signals.iter_mut().find_map(Option::take) {
                self.origin = Origin::Rest;
                return Some(signal);
            }
            if self.run.is_some() {
                match self.run_step()? {
                    Some(event) => return Some(event),
                    None => continue,
                }
            }
            if self.carried_ticks >= u64::from(MAX_WAIT_TICKS) {
                self.carried_ticks = self.carried_ticks.wrapping_sub(u64::from(MAX_WAIT_TICKS));
                self.origin = Origin::Rest;
                return Some(Event::Dwell {
                    wait_ticks: MAX_WAIT_TICKS,
                });
            }
            if self.schedule.moves.front().is_some() {
                self.begin_move()?;
            } else if let Some(command) = self.waiting.take() {
                self.begin(command);
                self.fill();
            } else {
                self.segment = None;
                return None;
            }
        }
    }

    /// The next step of the path: `None` under a hold, `Some(None)` when the move has ended.
    fn run_step(&mut self) -> Option<Option<Event<N>>> {
        let Some(run) = &mut self.run else {
            return Some(None);
        };
        let step = match run.next.take() {
            Some(step) => Some(step),
            None if run.left == 0 => None,
            None => run.path.next(),
        };
        let Some(step) = step else {
            self.finish();
            return Some(None);
        };
        if let (true, Some(timer)) = (run.follows, &mut run.timer) {
            run.left = run.left.wrapping_sub(1);
            let wait = timer.wait(step.sweep.into());
            return Some(Some(self.path_step(step, wait)));
        }
        let wait = match &mut run.timer {
            Some(timer) => timer.wait(step.sweep.into()),
            None => match self.ramp.wait(step.sweep, self.schedule.moves.limits()) {
                Some(wait) => wait,
                None => {
                    run.next = Some(step);
                    return None;
                }
            },
        };
        run.left = run.left.wrapping_sub(1);
        let wait = wait.saturating_add(self.carried_ticks);
        self.carried_ticks = 0;
        Some(Some(self.path_step(step, wait)))
    }

    /// Whether the move under way follows the spindle.
    fn is_following(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.follows)
    }

    /// Whether the next move is another one of the thread that is being cut.
    fn goes_on_threading(&self) -> bool {
        let next = self.schedule.moves.front();
        next.is_some_and(|(_, work)| {
            let is_thread = matches!(work.segment.command, Command::Thread { .. });
            is_thread && !work.is_indexed
        })
    }

    /// The move, or the part of an arc, has ended: its place is free.
    fn finish(&mut self) {
        self.schedule.moves.pop();
        self.fill();
        let goes_on = match self.schedule.moves.front() {
            Some((stretch, work)) if work.path.is_none() => Some((*stretch, work)),
            _ => None,
        };
        match (goes_on, &mut self.run) {
            (Some((stretch, work)), Some(run)) => {
                run.left = work.events;
                self.ramp
                    .begin(&stretch, work.sweep, work.largest_sweep, work.ticks_q16);
            }
            _ => self.run = None,
        }
    }

    /// Begins the first move of the queue. `None` under a hold, when it is too short for a step.
    fn begin_move(&mut self) -> Option<()> {
        let (stretch, work) = self.schedule.moves.front()?;
        let (stretch, events) = (*stretch, work.events);
        self.segment = Some(work.segment);
        let heading = work.heading;
        let ticks = work.tempo.ticks(self.schedule.moves.percent());
        if self.schedule.has_ramps() && stretch.length_nm != 0 {
            let sweep = work.sweep.max(1);
            let largest_sweep = work.largest_sweep.max(1);
            self.ramp
                .begin(&stretch, sweep, largest_sweep, work.ticks_q16);
            if events == 0 {
                let wait = self.ramp.wait(1, self.schedule.moves.limits())?;
                self.carried_ticks = self.carried_ticks.saturating_add(wait);
            }
        } else if events == 0 {
            self.ramp.stop();
            self.carried_ticks = self.carried_ticks.saturating_add(ticks);
        }
        let timed = match work.counts_q16 {
            None => (!self.schedule.has_ramps()).then_some(ticks),
            counts => counts,
        };
        let is_indexed = work.is_indexed;
        self.run = work.path.clone().map(|path| Run {
            path,
            timer: timed.map(|whole| Timer::new(whole, work.sweep, work.largest_sweep.into())),
            left: events,
            next: None,
            follows: work.counts_q16.is_some(),
        });
        if self.is_following() {
            self.signal([is_indexed.then_some(Event::Index), None]);
        }
        self.take_up.turn(&heading, self.load, &self.config);
        Some(())
    }

    /// A command that is no move; all moves before it have been made.
    fn begin(&mut self, command: Command<N>) {
        let from = self.schedule.programmed();
        self.segment = Some(Segment { from, command });
        self.ramp.stop();
        self.schedule.end_thread();
        match command {
            Command::Dwell { micros } => {
                // A dwell of 2^64 us lasts half a million years: saturating is long enough.
                let ticks =
                    crate::duration::mul_div(micros, u64::from(self.config.timer_hz), 1_000_000);
                self.carried_ticks = self.carried_ticks.saturating_add(ticks);
                self.flush_wait();
            }
            Command::Spindle {
                direction,
                milli_rpm,
            } => {
                self.signal([
                    Some(Event::Output(Output::Spindle {
                        direction,
                        milli_rpm,
                    })),
                    None,
                ]);
            }
            Command::Coolant { mist, flood } => {
                self.signal([Some(Event::Output(Output::Coolant { mist, flood })), None]);
            }
            Command::Drill => self.signal([Some(Event::Output(Output::Drill)), None]),
            Command::Tool { number } => self.signal([
                Some(Event::Pause(Pause::ToolChange)),
                Some(Event::Output(Output::Tool { number })),
            ]),
            Command::Stop { optional: false } => {
                self.signal([Some(Event::Pause(Pause::Program)), None])
            }
            Command::Stop { optional: true } => {
                self.signal([Some(Event::Pause(Pause::Optional)), None])
            }
            Command::End { rewind } => {
                self.signals = safe();
                if let Some(last) = self.signals.last_mut() {
                    *last = Some(Event::Pause(Pause::End { rewind }));
                }
                self.flush_wait();
            }
            _ => {}
        }
    }

    /// Signals act when all time before them has passed.
    fn signal(&mut self, [first, second]: [Option<Event<N>>; 2]) {
        self.signals = [None, first, second, None];
        self.flush_wait();
    }

    /// Turns carried time, which is below [`MAX_WAIT_TICKS`] or a dwell's, into a wait of its own.
    fn flush_wait(&mut self) {
        let short = self.carried_ticks % u64::from(MAX_WAIT_TICKS);
        match self.signals.first_mut() {
            Some(first) if short > 0 => {
                self.carried_ticks = self.carried_ticks.wrapping_sub(short);
                *first = Some(Event::Dwell {
                    wait_ticks: short as u32,
                });
            }
            _ => {}
        }
    }

    /// Drops all that was taken and not yet given out; the outputs go to their safe state, in the modal state too.
    /// Other modal words (units, distance mode, feed, ...) of the lines that were taken stay.
    ///
    /// All axes stop at once, whatever their speed: a feed hold before it brakes. The hold ends with the abort. The next
    /// block starts from where the axes stand. What was left of a take-up is made, or
    /// given back, before that axis moves again.
    pub fn abort(&mut self) {
        self.commands = None;
        self.next = None;
        self.waiting = None;
        self.segment = None;
        self.run = None;
        self.ramp.stop();
        self.held = None;
        self.take_up.abort();
        self.carried_ticks = 0;
        let mut position = [Nm(0); N];
        for (position, (load, axis)) in position
            .iter_mut()
            .zip(self.load.iter().zip(&self.config.axes))
        {
            *position = axis.scale.position(*load);
        }
        self.schedule.clear(position, self.load);
        self.schedule.set_mode(self.mode);
        self.resume();
        self.modal.set_position(position);
        self.modal.stop_outputs();
        self.signals = safe();
    }

    /// What the event given last belongs to.
    pub fn origin(&self) -> Origin {
        self.origin
    }

    /// The command being executed.
    pub fn executing(&self) -> Option<&Segment<N>> {
        self.segment.as_ref()
    }

    /// Direction and lash of an axis for steps that are given again: [`TakeUp::play`].
    pub(crate) fn play(&mut self, axis: usize) -> Option<(i8, u32)> {
        self.take_up.play(axis, &self.load)
    }

    /// Where the load stands after the event given last, in steps from machine zero.
    pub fn position_steps(&self) -> [i32; N] {
        self.load
    }

    /// The modal state after the line taken last.
    pub fn modal(&self) -> &Modal<N> {
        &self.modal
    }

    /// The facts of this machine.
    pub fn config(&self) -> &Config<N> {
        &self.config
    }
}

/// Spindle and coolant off.
fn safe<const N: usize>() -> [Option<Event<N>>; 4] {
    [
        None,
        Some(Event::Output(Output::Spindle {
            direction: SpindleDirection::Off,
            milli_rpm: 0,
        })),
        Some(Event::Output(Output::Coolant {
            mist: false,
            flood: false,
        })),
        None,
    ]
}
