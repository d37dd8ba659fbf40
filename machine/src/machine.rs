//! Lines in, events out.

use husillo_backlash::{Backlash, Compensator, Flank, Lash};
use husillo_gcode::{Block, Command, Commands, Modal, Nm, SpindleDirection};
use husillo_interp::{Moves, Path, Step};
use husillo_planner::Timer;

use crate::{
    Config, Event, MAX_WAIT_TICKS, Output, Pause, Refused, Segment, StepEvent, segment::lattice,
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
/// `P` is the interpolator and `L` the lash model of each axis; the defaults are the toolkit's own.
/// It stands at machine zero when new, every axis engaged on its positive flank (it was pulled off its switch).
#[derive(Clone, Debug)]
pub struct Machine<const N: usize, P = Path<N>, L: Lash = Backlash> {
    config: Config<N>,
    modal: Modal<N>,
    commands: Option<Commands<N>>,
    segment: Option<Segment<N>>,
    path: Option<(P, Timer)>,
    compensator: Compensator<N, L>,
    is_compensating: bool,
    /// Motor steps of take-up still to make, signed, and the timer of the axis that makes them.
    owed: [i32; N],
    /// What an abort left of a take-up: motor steps that this axis has not made, signed.
    unfinished: Option<[i32; N]>,
    take_up_timer: Option<Timer>,
    /// The step that waits for the take-up, or for the rest of a long wait.
    held: Option<([i8; N], u64)>,
    /// Outputs and pauses of the command begun last.
    signals: [Option<Event<N>>; 4],
    /// Ticks of moves too short for a step: they belong to the next one.
    carried_ticks: u64,
    load: [i32; N],
    programmed: [Nm; N],
    origin: Origin,
}

impl<const N: usize, P: Moves<N>> Machine<N, P, Backlash> {
    /// A machine with one lash value an axis.
    pub fn new(config: Config<N>) -> Self {
        let lash = config
            .axes
            .map(|axis| Backlash::new(axis.lash_steps, Flank::Positive));
        Self::with_lash(config, lash)
    }
}

impl<const N: usize, P: Moves<N>, L: Lash> Machine<N, P, L> {
    /// A machine with a lash model of your own for every axis.
    pub fn with_lash(config: Config<N>, lash: [L; N]) -> Self {
        Self {
            config,
            modal: Modal::new(config.dialect),
            commands: None,
            segment: None,
            path: None,
            compensator: Compensator::new(lash),
            is_compensating: true,
            owed: [0; N],
            unfinished: None,
            take_up_timer: None,
            held: None,
            signals: [const { None }; 4],
            carried_ticks: 0,
            load: [0; N],
            programmed: [Nm(0); N],
            origin: Origin::Rest,
        }
    }

    /// Switches the take-up of backlash on (as it is at first) or off.
    pub fn set_compensation(&mut self, on: bool) {
        self.is_compensating = on;
    }

    /// Takes one block of text.
    ///
    /// Everything is checked before anything moves: the words, the modal rules, the travel of every
    /// axis along the whole path. One block may wait while another is being executed.
    ///
    /// # Errors
    /// [`Refused::Busy`] while the block before has not begun its last command; otherwise what is
    /// wrong. In every case nothing has changed.
    pub fn line(&mut self, text: &[u8]) -> Result<(), Refused> {
        if self.is_waiting() {
            return Err(Refused::Busy);
        }
        let block = Block::parse(text, &self.config.dialect)?;
        let (modal, commands) = self.modal.plan(&block)?;
        let mut from = self.modal.position();
        for command in commands.clone() {
            self.config.check(&from, &command)?;
            from = target(&command).unwrap_or(from);
        }
        self.modal = modal;
        self.commands = Some(commands);
        Ok(())
    }

    /// Whether a block still waits to begin; [`Machine::line`] would answer [`Refused::Busy`].
    fn is_waiting(&self) -> bool {
        self.commands
            .as_ref()
            .is_some_and(|commands| commands.clone().next().is_some())
    }

    /// The next event, or `None` when all that was taken has been given out.
    ///
    /// Constant time, except where a move begins: an arc is walked once at its beginning, some 5 ns an event on a
    /// desktop, some 100 instructions on a Cortex-M4.
    #[inline]
    pub fn next_event(&mut self) -> Option<Event<N>> {
        match &mut self.path {
            Some((path, timer)) if self.held.is_none() => match path.next() {
                Some(step) => {
                    let wait = timer.wait(step.sweep.into());
                    Some(self.path_step(step, wait))
                }
                None => {
                    self.path = None;
                    self.next_unhurried()
                }
            },
            _ => self.next_unhurried(),
        }
    }

    /// A step of the path, unless an axis turns round and must be taken up first.
    #[inline]
    fn path_step(&mut self, step: Step, wait: u64) -> Event<N> {
        let delta = step.deltas();
        let may_owe = self.is_compensating
            && (self.unfinished.is_some() || !self.compensator.is_straight_on(&delta));
        let take_up = if may_owe {
            self.turn_round(&delta, wait)
        } else {
            None
        };
        match take_up {
            Some(event) => event,
            None => self.give(delta, wait),
        }
    }

    /// The first step of take-up before `delta`, if an axis owes any.
    #[cold]
    fn turn_round(&mut self, delta: &[i8; N], wait: u64) -> Option<Event<N>> {
        let lash = self.compensator.before(delta, self.load);
        let mut unfinished = self.unfinished.take().unwrap_or([0; N]);
        let axes = self
            .owed
            .iter_mut()
            .zip(&mut unfinished)
            .zip(delta.iter().zip(lash));
        for ((owed, rest), (delta, lash)) in axes {
            let direction = i32::from(*delta);
            if direction != 0 {
                // Back again from a take-up cut short owes only what that one had made: the rest has
                // the other sign. Lash and rest are below 2^31.
                let lash = i32::try_from(lash).unwrap_or(i32::MAX);
                *owed = direction.wrapping_mul(lash).saturating_add(*rest);
                *rest = 0;
            }
        }
        self.unfinished = unfinished
            .iter()
            .any(|rest| *rest != 0)
            .then_some(unfinished);
        let event = self.take_up_step()?;
        self.held = Some((*delta, wait));
        Some(event)
    }

    /// A step of the path that nothing stands before any more.
    #[inline]
    fn give(&mut self, delta: [i8; N], wait: u64) -> Event<N> {
        if wait > u64::from(MAX_WAIT_TICKS) {
            self.held = Some((delta, wait.wrapping_sub(u64::from(MAX_WAIT_TICKS))));
            return Event::Dwell {
                wait_ticks: MAX_WAIT_TICKS,
            };
        }
        for (load, delta) in self.load.iter_mut().zip(delta) {
            // Every end was checked to be within 31 bits, and the path stays next to it.
            *load = load.wrapping_add(i32::from(delta));
        }
        self.origin = match &self.segment {
            Some(Segment {
                command: Command::Rapid { .. },
                ..
            }) => Origin::Rapid,
            _ => Origin::Feed,
        };
        Event::Step(StepEvent {
            wait_ticks: wait as u32,
            delta,
        })
    }

    /// One motor step of take-up: X before Y before Z, each at its highest rate.
    fn take_up_step(&mut self) -> Option<Event<N>> {
        let axes = self.owed.iter_mut().zip(&self.config.axes).enumerate();
        let (number, (owed, axis)) = axes.into_iter().find(|(_, (owed, _))| **owed != 0)?;
        let timer = self.take_up_timer.get_or_insert_with(|| {
            Timer::new(
                u64::from(self.config.timer_hz),
                u64::from(axis.max_rate_hz),
                1,
            )
        });
        let wait = timer.wait(1).min(u64::from(MAX_WAIT_TICKS));
        let direction = owed.signum();
        *owed = owed.wrapping_sub(direction);
        if *owed == 0 {
            self.take_up_timer = None;
        }
        let mut delta = [0; N];
        if let Some(delta) = delta.get_mut(number) {
            *delta = direction as i8;
        }
        self.origin = Origin::TakeUp;
        Some(Event::Step(StepEvent {
            wait_ticks: wait as u32,
            delta,
        }))
    }

    /// Everything but the next step of a path under way.
    #[cold]
    fn next_unhurried(&mut self) -> Option<Event<N>> {
        loop {
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
            if let Some((path, timer)) = &mut self.path {
                let Some(step) = path.next() else {
                    self.path = None;
                    continue;
                };
                let wait = timer
                    .wait(step.sweep.into())
                    .saturating_add(self.carried_ticks);
                self.carried_ticks = 0;
                return Some(self.path_step(step, wait));
            }
            if self.carried_ticks >= u64::from(MAX_WAIT_TICKS) {
                self.carried_ticks = self.carried_ticks.wrapping_sub(u64::from(MAX_WAIT_TICKS));
                self.origin = Origin::Rest;
                return Some(Event::Dwell {
                    wait_ticks: MAX_WAIT_TICKS,
                });
            }
            let Some(command) = self.commands.as_mut().and_then(Iterator::next) else {
                self.segment = None;
                return None;
            };
            self.begin(command);
        }
    }

    fn begin(&mut self, command: Command<N>) {
        let segment = Segment {
            from: self.programmed,
            command,
        };
        self.segment = Some(segment);
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
            _ => {
                if let Some(to) = target(&command) {
                    self.begin_move(&segment, to);
                }
            }
        }
    }

    fn begin_move(&mut self, segment: &Segment<N>, to: [Nm; N]) {
        // `line` has checked that every position has its step.
        let end = lattice(&self.config.axes, &to).unwrap_or(self.load);
        let (path, ticks, timer) = self.config.begin::<P>(segment, self.load, end);
        self.programmed = to;
        match timer {
            Some(timer) => self.path = Some((path, timer)),
            None => self.carried_ticks = self.carried_ticks.saturating_add(ticks),
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
    /// The next block starts from where the axes stand. What was left of a take-up is made, or
    /// given back, before that axis moves again.
    pub fn abort(&mut self) {
        self.commands = None;
        self.segment = None;
        self.path = None;
        self.held = None;
        if self.owed.iter().any(|owed| *owed != 0) {
            let mut unfinished = self.unfinished.unwrap_or([0; N]);
            for (rest, owed) in unfinished.iter_mut().zip(self.owed) {
                *rest = rest.saturating_add(owed);
            }
            self.unfinished = Some(unfinished);
        }
        self.owed = [0; N];
        self.take_up_timer = None;
        self.carried_ticks = 0;
        for ((programmed, load), axis) in self
            .programmed
            .iter_mut()
            .zip(self.load)
            .zip(&self.config.axes)
        {
            *programmed = axis.scale.position(load);
        }
        self.modal.set_position(self.programmed);
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

/// Where a command ends, if it moves.
pub(crate) fn target<const N: usize>(command: &Command<N>) -> Option<[Nm; N]> {
    match command {
        Command::Rapid { to } | Command::Linear { to, .. } => Some(*to),
        Command::Arc { arc, .. } => Some(arc.to),
        _ => None,
    }
}
