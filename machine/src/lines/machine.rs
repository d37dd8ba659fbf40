//! Lines in, events out.

mod begin;
mod give;

use husillo_backlash::{Backlash, Flank, Lash};
use husillo_gcode::{Block, Command, Commands, Modal, Nm, PathMode};
use husillo_interp::{Moves, Path, Step};
use husillo_planner::{Ramp, Timer};

use crate::lines::guard::StepGuard;
use crate::lines::schedule::Schedule;
use crate::lines::take_up::TakeUp;
use crate::{Config, Event, MoveError, Refused, Segment};

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
    guard: StepGuard<N>,
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
            guard: StepGuard::new(),
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

    /// Says where the work zeros lie, of G54 to G59.3 alike, and where the axes stand: both in the
    /// machine frame. Before the first line; programs that set a frame themselves do so later.
    /// Nothing moves.
    ///
    /// # Errors
    /// [`MoveError::Reach`]: the axes stand beyond 2^31 steps. Nothing has changed.
    pub fn place(&mut self, work_zero: [Nm; N], at: [Nm; N]) -> Result<(), MoveError> {
        let load = self.config.nearest_steps(&at)?;
        // Nine frames with all codes, six without.
        for system in 0..9 {
            self.modal.set_work_zero(system, work_zero);
        }
        self.modal.set_position(at);
        self.load = load;
        self.schedule.clear(at, load);
        Ok(())
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
        self.guard.rest();
        let mut position = [Nm(0); N];
        for (position, (load, axis)) in position
            .iter_mut()
            .zip(self.load.iter().zip(&self.config.axes))
        {
            *position = Nm(axis.scale.position(*load));
        }
        self.schedule.clear(position, self.load);
        self.schedule.set_mode(self.mode);
        self.resume();
        self.modal.set_position(position);
        self.modal.stop_outputs();
        self.signals = begin::safe();
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
