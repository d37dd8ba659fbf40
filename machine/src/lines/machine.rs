//! Lines in, events out.

mod begin;
mod direct;
mod extended;
mod fill;
mod inputs;
mod next_event;
mod tapping;

pub use fill::Filled;
use husillo_backlash::{Backlash, BacklashModel, Flank};
use husillo_gcode::{Block, Command, Modal, Nm, PathMode};
use husillo_interp::{Moves, Path, Step};
use husillo_planner::{Ramp, Timer};

use crate::lines::extension::Extension;
use crate::lines::guard::{StepGuard, longest_interval};
use crate::lines::path_ramp::{MoveQueue, PathRamp};
use crate::lines::schedule::Schedule;
use crate::lines::segment::Start;
use crate::lines::take_up::TakeUp;
use crate::{Config, Equipment, Event, MoveError, Refused, Segment};

/// Kind of motion to which the last event belongs.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Origin {
    /// No motion yet, or an output, a dwell or a pause.
    Rest,
    /// Take-up of an axis that reverses; the load stands still.
    TakeUp,
    /// A rapid move.
    Rapid,
    /// A feed move: line or arc.
    Feed,
}

/// A machine of `N` axes: takes lines, returns events, never blocks.
///
/// `P` is the interpolator and `L` the backlash model of each axis; the defaults are those of
/// husillo. `QUEUE` is the number of moves planned ahead, the executing one included; each takes
/// 208 bytes on a Cortex-M and on a 64-bit host (three axes). A new machine is at machine zero,
/// with every axis engaged on its positive flank (as pulled off its switch).
///
/// The steps of events are motor steps. Where the backlash varies with the position
/// ([`BacklashModel::follow`]), an axis occasionally needs a correction step while it moves. A path
/// step then has one motor step more, one less, or one of an axis that otherwise stands. A second
/// step of an axis is inserted before it after half the time, or after the interval of the highest
/// rate of the axis.
///
/// `E` is `()` for a machine of axes, spindle and coolant. [`Extended`](crate::Extended) adds
/// cutter compensation and the commands that need [`Equipment`].
///
/// `R` is [`Ramp`] for limited acceleration. [`SmoothRamp`](crate::SmoothRamp) limits the jerk
/// along the path as well.
///
/// The fields that each event uses come first: short instructions reach 1 kB from the address.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Machine<
    const N: usize,
    P = Path<N>,
    L: BacklashModel<N> = Backlash,
    const QUEUE: usize = 16,
    E: Extension<N> = (),
    R: PathRamp = Ramp,
> {
    run: Option<Run<P>>,
    take_up: TakeUp<N, L>,
    guard: StepGuard<N>,
    /// Steps of an axis that are farther apart than this need no check.
    longest_interval: u32,
    /// The step that waits for a take-up or for the rest of a long wait.
    held: Option<([i8; N], u64)>,
    /// Ticks of moves too short for a step, carried to the next move.
    carried_ticks: u64,
    load: [i32; N],
    origin: Origin,
    segment: Option<Segment<N>>,
    ramp: R,
    config: Config<N>,
    /// Outputs and pauses of the command begun last.
    signals: [Option<Event<N>>; 4],
    /// Path mode after the last line.
    mode: PathMode,
    has_ended: bool,
    schedule: Schedule<N, P, E::Kept, R, QUEUE>,
    modal: Modal<N>,
    /// Remaining commands of the last block.
    commands: E::Commands,
    /// Its next command, which waits for room in the queue.
    next: Option<Command<N>>,
    /// A command that acts when all moves before it have been made.
    waiting: Option<Command<N>>,
    extension: E,
}

/// The state after commands that this machine can make.
struct Accepted<const N: usize> {
    end: [Nm; N],
    /// The steps nearest to the end.
    steps: [i32; N],
    mode: PathMode,
    has_ended: bool,
}

/// The executing move.
#[derive(Clone, Debug)]
struct Run<P> {
    path: P,
    /// Timer of its steps at constant speed; `None` if the ramp times them.
    timer: Option<Timer>,
    /// Remaining events of this part of the move.
    left: u32,
    /// A step that was not made because of a hold.
    next: Option<Step>,
    /// Whether the timer counts the rotation of the spindle instead of time.
    follows: bool,
}

impl<const N: usize, P: Moves<N>, const QUEUE: usize, E: Extension<N>, R: PathRamp>
    Machine<N, P, Backlash, QUEUE, E, R>
{
    /// Creates a machine with one backlash value per axis.
    pub fn new(config: Config<N>) -> Self {
        let backlash = config
            .axes
            .map(|axis| Backlash::new(axis.backlash_steps, Flank::Positive));
        Self::with_backlash(config, backlash)
    }
}

impl<
    const N: usize,
    P: Moves<N>,
    L: BacklashModel<N>,
    const QUEUE: usize,
    E: Extension<N>,
    R: PathRamp,
> Machine<N, P, L, QUEUE, E, R>
{
    /// Creates a machine with a custom backlash model per axis and a custom queue length.
    pub fn with_backlash(mut config: Config<N>, backlash: [L; N]) -> Self {
        const { assert!(QUEUE > 0, "the move that is executed takes a place") };
        if !E::IS_EXTENDED {
            config.equipment = Equipment::NONE;
        }
        Self {
            config,
            modal: Modal::new(config.dialect),
            commands: E::nothing(),
            next: None,
            waiting: None,
            schedule: Schedule::new(&config),
            run: None,
            ramp: R::new(config.timer_hz),
            mode: PathMode::default(),
            has_ended: false,
            segment: None,
            take_up: TakeUp::new(backlash),
            guard: StepGuard::new(),
            longest_interval: longest_interval(&config),
            held: None,
            signals: [const { None }; 4],
            carried_ticks: 0,
            load: [0; N],
            origin: Origin::Rest,
            extension: E::new(),
        }
    }

    /// Switches the take-up of backlash on (the default) or off. Call it only while the queue is
    /// empty: moves are planned with or without stops for take-up.
    pub fn set_compensation(&mut self, on: bool) {
        self.take_up.set_on(on);
    }

    /// Sets the work zero of all coordinate systems, G54 to G59.3, and the positions of the axes,
    /// both in the machine frame. Call it before the first line; a program may set a frame later.
    /// Nothing moves.
    ///
    /// # Errors
    /// [`MoveError::Reach`] if an axis is beyond 2^31 steps; the state is unchanged.
    pub fn place(&mut self, work_zero: [Nm; N], at: [Nm; N]) -> Result<(), MoveError> {
        let load = self.config.nearest_steps(&at)?;
        // Nine coordinate systems with all codes, six without.
        for system in 0..9 {
            self.modal.set_work_zero(system, work_zero);
        }
        self.modal.set_position(at);
        self.load = load;
        self.schedule.clear(at, load);
        self.extension.restart(at);
        Ok(())
    }

    /// Sets the zero of one work frame in the machine frame, 0 (G54) to 8 (G59.3), before the first
    /// line. Returns `false`, with no effect, for another number.
    pub fn set_work_zero(&mut self, system: u8, zero: [Nm; N]) -> bool {
        self.modal.set_work_zero(system, zero)
    }

    /// Takes one block of text.
    ///
    /// Everything is checked before anything moves: the words, the modal rules, and the travel of
    /// every axis along the whole path. Its moves join the queue as far as there is room. The more
    /// lines are taken before events are requested, the further ahead speeds are planned.
    ///
    /// # Errors
    /// [`Refused::Busy`] while a command of the previous block waits for room in the queue;
    /// otherwise the reason for the refusal. The state is unchanged in every case.
    pub fn line(&mut self, text: &[u8]) -> Result<(), Refused> {
        if !self.has_room() {
            return Err(Refused::Busy);
        }
        let mut block = Block::new();
        block.read(text, &self.config.dialect)?;
        self.block(&block)
    }

    /// Takes one block, as [`Machine::line`] does, for programs whose expressions were evaluated
    /// before.
    ///
    /// # Errors
    /// Those of [`Machine::line`].
    pub fn block(&mut self, block: &Block) -> Result<(), Refused> {
        if !self.has_room() {
            return Err(Refused::Busy);
        }
        let commands = &mut self.commands;
        let stage = self.extension.apply(block, &mut self.modal, commands)?;
        match self.accept(E::pending(&self.commands)) {
            Ok(accepted) => {
                self.extension.set_stage(stage);
                self.take(accepted);
                Ok(())
            }
            Err(error) => {
                E::revert(stage, &mut self.modal, &mut self.commands);
                Err(error.into())
            }
        }
    }

    /// Takes the commands of one block from a stage before the machine, all or none. They begin
    /// where the commands before them end.
    ///
    /// [`Machine::modal`] follows the position only: the modal state is that of the caller.
    ///
    /// # Errors
    /// [`Refused::Busy`] as for [`Machine::line`], or the reason for the refusal of one command.
    /// The state is unchanged.
    pub fn commands(&mut self, commands: E::Commands) -> Result<(), Refused> {
        if !self.has_room() {
            return Err(Refused::Busy);
        }
        let accepted = self.accept(E::pending(&commands))?;
        self.modal.set_position(accepted.end);
        self.extension.restart(accepted.end);
        self.commands = commands;
        self.take(accepted);
        Ok(())
    }

    /// Takes one command, as [`Machine::commands`] does. To take several only together, try them
    /// before with [`Machine::check`].
    ///
    /// # Errors
    /// Those of [`Machine::commands`].
    pub fn command(&mut self, command: &Command<N>) -> Result<(), Refused> {
        if !self.has_room() {
            return Err(Refused::Busy);
        }
        let accepted = self.accept(core::iter::once(*command))?;
        self.modal.set_position(accepted.end);
        self.extension.restart(accepted.end);
        self.has_ended = accepted.has_ended;
        self.mode = accepted.mode;
        self.schedule.expect(accepted.end, accepted.steps);
        self.next = Some(*command);
        self.refill();
        Ok(())
    }

    /// Checks that this machine can make all of these commands, after those that it has taken.
    ///
    /// # Errors
    /// The reason for the first one that it cannot make.
    pub fn check<I: IntoIterator<Item = Command<N>>>(&self, commands: I) -> Result<(), MoveError> {
        self.accept(commands.into_iter()).map(|_| ())
    }

    /// Takes the moves that wait for the end of a corner, for a text that ends with cutter
    /// compensation on and without M2.
    ///
    /// # Errors
    /// Those of [`Machine::commands`].
    pub fn finish(&mut self) -> Result<(), Refused> {
        if !self.has_room() {
            return Err(Refused::Busy);
        }
        let mut extension = self.extension.clone();
        if let Some(commands) = extension.finish() {
            let accepted = self.accept(E::pending(&commands))?;
            self.extension = extension;
            self.commands = commands;
            self.take(accepted);
        }
        Ok(())
    }

    /// Checks commands that follow those already taken.
    fn accept(&self, commands: impl Iterator<Item = Command<N>>) -> Result<Accepted<N>, MoveError> {
        let mut accepted = Accepted {
            end: self.schedule.programmed(),
            steps: self.schedule.lattice(),
            mode: self.mode,
            has_ended: false,
        };
        let mut points = None;
        for command in commands {
            let start = Start {
                at: &accepted.end,
                steps: Some(accepted.steps),
            };
            let steps = if E::IS_EXTENDED {
                let steps = self.config.check_any(start, &command)?;
                self.check_nurbs(&mut points, &accepted.end, &command)?;
                steps
            } else {
                self.config.check_moves::<P>(start, &command)?
            };
            if let Some(end) = command.end() {
                accepted.end = end;
                accepted.steps = match steps {
                    Some(steps) => steps,
                    None => self.config.nearest_steps(&end)?,
                };
            }
            if let Command::Path { mode } = command {
                accepted.mode = mode;
            }
            accepted.has_ended = matches!(command, Command::End { .. });
        }
        Ok(accepted)
    }

    /// Takes the commands that were accepted.
    fn take(&mut self, accepted: Accepted<N>) {
        self.has_ended = accepted.has_ended;
        self.mode = accepted.mode;
        self.schedule.expect(accepted.end, accepted.steps);
        self.refill();
    }

    /// Whether [`Machine::line`] would take a correct line now. Otherwise it returns
    /// [`Refused::Busy`].
    pub fn has_room(&self) -> bool {
        self.next.is_none() && !self.is_busy()
    }

    /// Whether the last line ended its program (M2, M30). The rest of the file is not part of the
    /// program.
    pub const fn has_ended(&self) -> bool {
        self.has_ended
    }

    /// Moves commands into the queue, up to one that has to wait for all moves before it.
    fn refill(&mut self) {
        loop {
            if self.next.is_none() {
                self.next = self.commands.next();
            }
            let stands = E::IS_EXTENDED && self.stands();
            if self.waiting.is_some() || self.schedule.is_full() || stands {
                return;
            }
            let has_backlash = self.take_up.stops();
            if !self.schedule.is_whole() {
                self.schedule.push_part(true, has_backlash);
                continue;
            }
            if E::IS_EXTENDED && self.push_chord(has_backlash) {
                continue;
            }
            if E::IS_EXTENDED {
                let Some(command) = self.next else { return };
                if self.take_extended(&command) {
                    self.next = None;
                    continue;
                }
            }
            match &self.next {
                None => return,
                Some(Command::Path { mode }) => self.schedule.set_mode(*mode),
                Some(command) if command.end().is_some() => {
                    self.schedule.push(&self.config, command, has_backlash);
                }
                other => {
                    self.waiting = *other;
                    self.schedule.moves.finish();
                }
            }
            self.next = None;
        }
    }

    /// Feed hold: brakes along the path within the acceleration of the axes and stops; no step is
    /// lost. Without ramps it stops at once. After the stop, events end (`None`) until
    /// [`Machine::resume`]. A take-up with ramps is finished first.
    pub fn hold(&mut self) {
        if let Some(state) = self.extension.state_mut() {
            state.operator_holds = true;
        }
        self.ramp.hold();
    }

    /// Ends a hold. An extended machine still stands while an input holds it.
    pub fn resume(&mut self) {
        match self.extension.state_mut() {
            Some(state) => {
                state.operator_holds = false;
                self.act_on_holds();
            }
            None => self.ramp.resume(),
        }
    }

    /// Whether a hold is active.
    pub fn is_held(&self) -> bool {
        self.ramp.is_held()
    }

    /// Scales the programmed feeds by 10 to 200 percent (other values are taken as the nearest of
    /// these), within the limits of the axes. Rapids are not scaled.
    ///
    /// Takes effect at the next event where there are ramps, otherwise with the next move.
    ///
    /// An extended machine keeps 100 percent while the program does not permit an override (M49,
    /// M50 P0).
    pub fn set_feed_override(&mut self, percent: u8) {
        let percent = percent.clamp(10, 200);
        match self.extension.state_mut() {
            Some(state) => {
                state.percent = percent;
                self.act_on_override();
            }
            None => self.schedule.moves.set_override(percent),
        }
    }

    /// Scales the speed of rapid moves by 1 to 100 percent. Takes effect at the next event where
    /// there are ramps; without ramps it has no effect.
    pub fn set_rapid_override(&mut self, percent: u8) {
        self.schedule.moves.set_rapid_override(percent);
    }

    /// Drops all lines and events that were not yet returned. The outputs, and their modal state,
    /// return to the safe state. Other modal words of the accepted lines (units, distance mode,
    /// feed, ...) stay.
    ///
    /// All axes stop at once, whatever their speed; use a feed hold first to brake. The abort ends
    /// the hold. The next block starts from the present positions of the axes. The rest of a
    /// take-up is made, or reversed, before that axis moves again.
    pub fn abort(&mut self) {
        self.commands = E::nothing();
        self.next = None;
        self.waiting = None;
        self.segment = None;
        self.run = None;
        self.ramp.stop();
        self.held = None;
        self.take_up.abort();
        self.carried_ticks = 0;
        self.guard.rest();
        let position = self.position(&self.load);
        self.schedule.clear(position, self.load);
        self.schedule.set_mode(self.mode);
        self.resume();
        self.modal.set_position(position);
        self.modal.stop_outputs();
        self.extension.restart(position);
        if let Some(state) = self.extension.state_mut() {
            state.abort();
        }
        self.signals = begin::safe();
    }

    /// Converts steps to positions in the machine frame.
    fn position(&self, steps: &[i32; N]) -> [Nm; N] {
        let mut position = [Nm(0); N];
        for (position, (steps, axis)) in
            position.iter_mut().zip(steps.iter().zip(&self.config.axes))
        {
            *position = Nm(axis.scale.position(*steps));
        }
        position
    }

    /// Kind of motion to which the last event belongs.
    pub fn origin(&self) -> Origin {
        self.origin
    }

    /// The executing command.
    pub fn executing(&self) -> Option<&Segment<N>> {
        self.segment.as_ref()
    }

    /// Direction and backlash of an axis for re-emitted steps: [`TakeUp::play`].
    pub(crate) fn play(&mut self, axis: usize) -> Option<(i8, u32)> {
        self.take_up.play(axis, &self.load)
    }

    /// Position of the load after the last event, in steps from machine zero.
    pub fn position_steps(&self) -> [i32; N] {
        self.load
    }

    /// The modal state after the last line.
    pub fn modal(&self) -> &Modal<N> {
        &self.modal
    }

    /// The configuration of this machine.
    pub fn config(&self) -> &Config<N> {
        &self.config
    }
}
