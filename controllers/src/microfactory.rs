//! The desktop microfactory: three linear axes and a spindle with a stepping motor, one task at a
//! time.

mod config;
mod event;
mod figure;
mod station;
pub(crate) mod task;

pub use config::MicrofactoryConfig;
pub use event::{MicrofactoryEvent, MicrofactoryInputs};
pub use station::MicrofactoryStation;

use husillo_transports::microfactory::{Order, Report, Status, Switches};

use figure::FigureMove;
use husillo_backlash::Play;
use husillo_machine::StepEvent;
use task::{Task, Turn};

/// X, Y, Z and the spindle.
pub const MICROFACTORY_MOTORS: usize = 4;
/// Index of the spindle among the motors.
const SPINDLE: usize = 3;

/// State of the motor current.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Power {
    Off,
    /// On; RESET is due.
    Reset,
    /// On; the delay is due.
    Settle,
    On,
}

/// The controller of a microfactory: commands in, events out.
///
/// A task (homing, a jog, counted steps, a figure) begins only when no other task is running.
/// Positions are load steps from the position after homing. When an axis reverses, it first takes
/// up its backlash; these steps do not change the position. `F` stores the figure: moves in X and
/// Z, in steps (`&'static [[i16; 2]]`, an array, a `heapless::Vec`).
///
/// **Homing** ends at the same position from any start, whichever flank is engaged. If a switch is
/// closed at the start, the axis first moves off it and then searches for it. The machine is homed
/// only after all of this has succeeded.
///
/// **Switches.** The home switch of an axis may close during a jog, counted steps or a figure. The
/// axis then stops, the machine reports it, the axis backs off the switch, and the task ends. An
/// axis may move away from a switch that is already closed. An emergency stop takes effect at the
/// next event of every task and lasts until [`Microfactory::reset`].
///
/// # Cost
/// An event takes some comparisons and two additions. A move of a figure takes a square root and a
/// 64-bit division.
///
/// # Examples
///
/// ```
/// use husillo_controllers::{
///     Microfactory, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs,
/// };
/// use husillo_transports::microfactory::Order;
///
/// let mut machine = Microfactory::new(MicrofactoryConfig::ORIGINAL, [[100, 50]]);
/// machine.command(Order::Steps { motor: 1, forward: true, count: 3 });
/// let mut steps = 0;
/// loop {
///     match machine.next_event(&MicrofactoryInputs::default()) {
///         MicrofactoryEvent::Step(step) => steps += i32::from(step.delta[1]),
///         MicrofactoryEvent::Idle => break,
///         _ => {}
///     }
/// }
/// assert_eq!(steps, 3);
/// ```
#[derive(Clone, Debug)]
pub struct Microfactory<F> {
    config: MicrofactoryConfig,
    figure: F,
    task: Task,
    /// The present move of the figure.
    line: Option<FigureMove>,
    power: Power,
    plays: [Play; 3],
    spindle: i32,
    /// Ticks since the last event of an axis that were already used by steps of the spindle.
    used_ticks: u32,
    /// Ticks until the next step of a spindle that turns during a figure.
    spindle_ticks: u32,
    /// The next step of the task, while it waits for its time.
    due: Option<Due>,
    is_homed: bool,
    /// Whether RESET was pulsed since power-on. The phases are then known.
    was_reset: bool,
    report: Option<Report>,
    /// The report that ended the last task, or the last report of the present one.
    last: Option<Report>,
    /// Switches that were closed at the last step, and switches that have closed since.
    were_closed: [bool; 3],
    close: [bool; 3],
    /// Motor steps of X, Y and Z since their zeros were found. `None`: no zero was found since the
    /// reset.
    since_zero: [Option<i32>; 3],
    switches: Switches,
}

/// A step that is decided and not yet made.
#[derive(Copy, Clone, Debug)]
struct Due {
    wait_ticks: u32,
    delta: [i8; MICROFACTORY_MOTORS],
}

impl<F: AsRef<[[i16; 2]]>> Microfactory<F> {
    /// Creates a controller at rest, with the motors off, not homed.
    pub const fn new(config: MicrofactoryConfig, figure: F) -> Self {
        let [x, y, z] = config.backlash_steps;
        Self {
            config,
            figure,
            task: Task::Idle,
            line: None,
            power: Power::Off,
            plays: [Play::new(x), Play::new(y), Play::new(z)],
            spindle: 0,
            used_ticks: 0,
            spindle_ticks: 0,
            due: None,
            is_homed: false,
            was_reset: false,
            report: None,
            last: None,
            were_closed: [true; 3],
            close: [false; 3],
            since_zero: [None; 3],
            switches: Switches {
                are_compared: false,
                lost_steps: [0; 3],
            },
        }
    }

    /// Takes a command from the link. Returns whether it is carried out.
    ///
    /// A task begins only if no other task is running. With a dead-man's time, a command that
    /// repeats the present jog renews it. The owner carries out commands for the stored figure
    /// ([`Order::Clear`] and the like): see [`Microfactory::figure_mut`].
    pub fn command(&mut self, command: Order) -> bool {
        if self.task == Task::Emergency {
            return false;
        }
        match command {
            Order::Emergency => {
                self.task = Task::Emergency;
                self.due = None;
                // The axes were stopped without deceleration, so their position is not certain.
                self.is_homed = false;
                self.report_now(Report::Emergency);
                return true;
            }
            Order::Stop => {
                // The decided step is not made.
                self.due = None;
                match self.task {
                    Task::Idle => {}
                    // A status request still reports the switch that ended the task.
                    Task::BackOff { homes: false, .. } => self.report = Some(Report::Stopped),
                    _ => self.report_now(Report::Stopped),
                }
                self.task = Task::Idle;
                return true;
            }
            _ => {}
        }
        let Some(task) = Task::of(command, &self.config) else {
            return false;
        };
        let is_said_again = match (self.task, task) {
            (Task::Jog { turn, .. }, Task::Jog { turn: again, .. }) => turn == again,
            _ => false,
        };
        if is_said_again {
            self.task = task;
            return true;
        }
        if self.task != Task::Idle {
            return false;
        }
        if command == Order::Figure && self.figure.as_ref().is_empty() {
            self.report_now(Report::NoFigure);
            return false;
        }
        if command == Order::Home {
            if self.is_homed {
                // If a homing does not end, the next one adds its steps to those already found.
                self.switches = Switches {
                    are_compared: true,
                    ..Switches::default()
                };
            }
            // The machine is homed again when all of homing has succeeded.
            self.is_homed = false;
        }
        self.task = task;
        self.last = None;
        // A switch that is already closed does not count as closing.
        self.were_closed = [true; 3];
        true
    }

    /// Resets the machine, as its panel or power-up does. This ends an emergency stop. The machine
    /// is then not homed, the motors are off, and positions count from the present position of the
    /// axes.
    pub fn reset(&mut self) {
        let [x, y, z] = self.config.backlash_steps;
        self.plays = [Play::new(x), Play::new(y), Play::new(z)];
        self.spindle = 0;
        self.line = None;
        self.task = Task::Idle;
        self.power = Power::Off;
        self.due = None;
        self.is_homed = false;
        self.was_reset = false;
        self.report = None;
        self.last = None;
        self.since_zero = [None; 3];
        self.switches = Switches::default();
    }

    /// Ends a task because the host is silent. The machine reports it, and its position stays
    /// known.
    pub fn expire(&mut self) {
        if self.is_moving() {
            self.due = None;
            self.task = Task::Idle;
            self.report_now(Report::DeadMan);
        }
    }

    /// Whether a task is running.
    pub fn is_moving(&self) -> bool {
        !matches!(self.task, Task::Idle | Task::Emergency)
    }

    /// Whether positions count from the home switches.
    pub const fn is_homed(&self) -> bool {
        self.is_homed
    }

    /// Returns load steps of X, Y and Z, and steps of the spindle.
    pub fn position_steps(&self) -> [i32; MICROFACTORY_MOTORS] {
        let [x, y, z] = self.plays.map(|play| play.load());
        [x, y, z, self.spindle]
    }

    /// Returns the end of the last task and the position of the axes. This is the answer to
    /// [`Order::Ask`].
    pub fn status(&self) -> Status {
        Status {
            report: self.last,
            is_moving: self.is_moving(),
            is_homed: self.is_homed,
            position_steps: self.position_steps(),
        }
    }

    /// Returns where the home switches closed at the last homing, compared with the homing before.
    /// This is the answer to [`Order::Switches`].
    pub const fn switches(&self) -> Switches {
        self.switches
    }

    /// Returns the figure.
    pub const fn figure(&self) -> &F {
        &self.figure
    }

    /// Returns the figure for replacement or editing. Returns `None` while a figure is cut.
    pub const fn figure_mut(&mut self) -> Option<&mut F> {
        if matches!(self.task, Task::Figure { .. } | Task::Approach { .. }) {
            return None;
        }
        Some(&mut self.figure)
    }

    /// Returns the next event for the present switches.
    pub fn next_event(&mut self, inputs: &MicrofactoryInputs) -> MicrofactoryEvent {
        if let Some(report) = self.report.take() {
            return MicrofactoryEvent::Report(report);
        }
        if !self.is_moving() {
            if self.power == Power::Off {
                return MicrofactoryEvent::Idle;
            }
            self.power = Power::Off;
            return MicrofactoryEvent::Enable(false);
        }
        if let Some(event) = self.wake() {
            return event;
        }
        if self.due.is_none() {
            self.due = self.decide(inputs);
        }
        match self.due {
            Some(due) => MicrofactoryEvent::Step(self.merged(due)),
            // The task has ended or changed, perhaps with a report.
            None => match self.report.take() {
                Some(report) => MicrofactoryEvent::Report(report),
                None => MicrofactoryEvent::Dwell { wait_ticks: 0 },
            },
        }
    }

    /// Returns the event that switches on the current, pulses RESET, or waits for the delay. All of
    /// them come before the first step of a task.
    fn wake(&mut self) -> Option<MicrofactoryEvent> {
        let (next, event) = match self.power {
            Power::On => return None,
            Power::Off => {
                // After power-on the phases are unknown, so RESET loses nothing.
                let resets = self.config.resets_before_moves || !self.was_reset;
                let next = if resets { Power::Reset } else { Power::Settle };
                (next, MicrofactoryEvent::Enable(true))
            }
            Power::Reset => {
                self.was_reset = true;
                let ticks = self.config.reset_ticks;
                (Power::Settle, MicrofactoryEvent::Reset { ticks })
            }
            Power::Settle => (
                Power::On,
                MicrofactoryEvent::Dwell {
                    wait_ticks: self.config.settle_ticks,
                },
            ),
        };
        self.power = next;
        self.used_ticks = 0;
        self.spindle_ticks = self.config.spindle_interval();
        Some(event)
    }

    /// Reports now. The answer to a later status request contains the same report.
    fn report_now(&mut self, report: Report) {
        self.report = Some(report);
        self.last = Some(report);
    }

    /// Returns the next step of the task. Returns `None` if the task ends or changes.
    fn decide(&mut self, inputs: &MicrofactoryInputs) -> Option<Due> {
        for ((close, was), is) in (self.close.iter_mut().zip(self.were_closed)).zip(inputs.home) {
            *close = is && !was;
        }
        self.were_closed = inputs.home;
        match self.task {
            Task::Idle | Task::Emergency => None,
            Task::Jog { turn, left_ticks } => {
                let interval = self.config.interval(turn.motor);
                let left_ticks = match left_ticks {
                    Some(left) if left < interval => {
                        return self.end(Report::DeadMan);
                    }
                    left => left.map(|left| left.wrapping_sub(interval)),
                };
                self.task = Task::Jog { turn, left_ticks };
                self.one_step(turn, inputs).map(|(due, _)| due)
            }
            Task::Steps { turn, left } => {
                if left == 0 {
                    return self.end(Report::Done);
                }
                let (due, counts) = self.one_step(turn, inputs)?;
                let left = left.wrapping_sub(u8::from(counts));
                self.task = Task::Steps { turn, left };
                Some(due)
            }
            Task::Look { axis } => {
                self.begin_search(axis, inputs);
                None
            }
            Task::Leave { axis, left } => self.leave(axis, left, inputs),
            Task::Home { axis, left } => self.search(axis, left, inputs),
            Task::BackOff { axis, left, homes } => self.back_off(axis, left, homes, inputs),
            Task::Approach { left } => {
                if inputs.contact {
                    self.begin_move(0);
                    self.report_now(Report::Contact);
                    return None;
                }
                if left == 0 {
                    return self.end(Report::NoContact);
                }
                let turn = Turn {
                    motor: 1,
                    forward: true,
                };
                let (due, counts) = self.one_step(turn, inputs)?;
                self.task = Task::Approach {
                    left: left.wrapping_sub(u32::from(counts)),
                };
                Some(due)
            }
            Task::Figure { index } => self.cut(index, inputs),
        }
    }

    /// Ends the task.
    fn end(&mut self, report: Report) -> Option<Due> {
        self.task = Task::Idle;
        self.report_now(report);
        None
    }

    /// Returns a step of one motor, and whether it moves the load. At a home switch the task
    /// becomes a back-off.
    fn one_step(&mut self, turn: Turn, inputs: &MicrofactoryInputs) -> Option<(Due, bool)> {
        let direction: i8 = if turn.forward { 1 } else { -1 };
        if self.stops_at(turn, inputs) {
            return None;
        }
        let mut delta = [0; MICROFACTORY_MOTORS];
        if let Some(place) = delta.get_mut(usize::from(turn.motor)) {
            *place = direction;
        }
        let play = self.plays.get(usize::from(turn.motor));
        let counts = !play.is_some_and(|play| play.owes(turn.forward));
        let due = Due {
            wait_ticks: self.config.interval(turn.motor),
            delta,
        };
        Some((due, counts))
    }

    /// Whether an axis must stop, because it moves towards its closed switch, or because its switch
    /// has closed during the task. The axis then backs off.
    fn stops_at(&mut self, turn: Turn, inputs: &MicrofactoryInputs) -> bool {
        let axis = turn.motor;
        // The contact may bounce while the axis moves off its switch.
        let has_closed = self.close.get(usize::from(axis)) == Some(&true)
            && !matches!(self.task, Task::BackOff { .. } | Task::Leave { .. });
        let stops = has_closed || (!turn.forward && inputs.is_home(axis));
        if stops {
            if !self.is_homed {
                // The engaged flank is unknown, so the back-off is the longer one.
                self.engage_negative(axis);
            }
            self.task = Task::BackOff {
                axis,
                left: self.config.back_off_steps,
                homes: false,
            };
            self.report_now(Report::Switch { axis });
        }
        stops
    }

    /// Marks the negative flank as engaged, because the last move in this direction moved the load.
    fn engage_negative(&mut self, axis: u8) {
        if let Some(play) = self.plays.get_mut(usize::from(axis)) {
            play.set_behind();
        }
    }

    /// Homing: moves off a switch that is already closed, or searches for the switch.
    fn begin_search(&mut self, axis: u8, inputs: &MicrofactoryInputs) {
        let backlash = self.config.backlash_steps.get(usize::from(axis));
        self.task = if inputs.is_home(axis) {
            Task::Leave {
                axis,
                // This is at least the back-off from either flank. The sum of two u16 fits.
                left: u32::from(backlash.copied().unwrap_or_default())
                    .wrapping_add(u32::from(self.config.back_off_steps)),
            }
        } else {
            Task::Home {
                axis,
                left: self.config.search_steps,
            }
        };
    }

    /// Homing: moves off a switch that was closed at the start. The switch then always closes at
    /// the same position.
    fn leave(&mut self, axis: u8, left: u32, inputs: &MicrofactoryInputs) -> Option<Due> {
        let Some(left) = left.checked_sub(1) else {
            if inputs.is_home(axis) {
                return self.end(Report::StillClosed { axis });
            }
            self.begin_search(axis, inputs);
            return None;
        };
        self.task = Task::Leave { axis, left };
        let turn = Turn {
            motor: axis,
            forward: true,
        };
        self.one_step(turn, inputs).map(|(due, _)| due)
    }

    /// Homing: moves towards the switch.
    fn search(&mut self, axis: u8, left: u32, inputs: &MicrofactoryInputs) -> Option<Due> {
        if inputs.is_home(axis) {
            // The switch was open before. So moving in this direction has moved the load, whichever
            // flank was engaged.
            self.engage_negative(axis);
            self.compare(axis);
            self.task = Task::BackOff {
                axis,
                left: self.config.back_off_steps,
                homes: true,
            };
            return None;
        }
        if left == 0 {
            return self.end(Report::NoSwitch { axis });
        }
        self.task = Task::Home {
            axis,
            left: left.wrapping_sub(1),
        };
        let turn = Turn {
            motor: axis,
            forward: false,
        };
        self.one_step(turn, inputs).map(|(due, _)| due)
    }

    /// Homing: compares the step at which a switch has closed with the step at which it closed
    /// before. From this step to zero the motor takes up the configured backlash and backs off. The
    /// real backlash does not matter.
    fn compare(&mut self, axis: u8) {
        let index = usize::from(axis);
        let since_zero = self.since_zero.get(index).copied().flatten();
        let backlash = self.config.backlash_steps.get(index).copied();
        let lost = self.switches.lost_steps.get_mut(index);
        let (Some(since_zero), Some(backlash), Some(lost)) = (since_zero, backlash, lost) else {
            return;
        };
        // The sum of two u16 fits. The steps wrap as the positions do.
        let back = i32::from(backlash).wrapping_add(i32::from(self.config.back_off_steps));
        *lost = lost.wrapping_sub(since_zero).wrapping_sub(back);
    }

    /// Backs off a switch. In homing the next axis follows.
    fn back_off(
        &mut self,
        axis: u8,
        left: u16,
        homes: bool,
        inputs: &MicrofactoryInputs,
    ) -> Option<Due> {
        if left > 0 {
            let turn = Turn {
                motor: axis,
                forward: true,
            };
            let (due, counts) = self.one_step(turn, inputs)?;
            self.task = Task::BackOff {
                axis,
                left: left.wrapping_sub(u16::from(counts)),
                homes,
            };
            return Some(due);
        }
        if inputs.is_home(axis) {
            return self.end(Report::StillClosed { axis });
        }
        if !homes {
            // A status request still reports the switch that ended the task.
            self.task = Task::Idle;
            self.report = Some(Report::Done);
            return None;
        }
        if let Some(play) = self.plays.get_mut(usize::from(axis)) {
            play.set_zero();
        }
        if let Some(since_zero) = self.since_zero.get_mut(usize::from(axis)) {
            *since_zero = Some(0);
        }
        if axis < 2 {
            self.task = Task::Look {
                axis: axis.wrapping_add(1),
            };
            return None;
        }
        self.is_homed = true;
        self.end(Report::Homed)
    }

    /// Returns a step of the figure.
    fn cut(&mut self, index: usize, inputs: &MicrofactoryInputs) -> Option<Due> {
        let Some(([x, z], wait_ticks)) = self.line.as_ref().and_then(FigureMove::peek) else {
            // The index is below the length of a slice, so the sum does not wrap.
            let next = index.wrapping_add(1);
            if next >= self.figure.as_ref().len() {
                return self.end(Report::Done);
            }
            self.begin_move(next);
            return None;
        };
        for (motor, direction) in [(0, x), (2, z)] {
            let turn = Turn {
                motor,
                forward: direction > 0,
            };
            if direction != 0 && self.stops_at(turn, inputs) {
                return None;
            }
        }
        // Both axes take up their backlash before the tool moves on.
        let [play_x, _, play_z] = &self.plays;
        let [owes_x, owes_z] = [x != 0 && play_x.owes(x > 0), z != 0 && play_z.owes(z > 0)];
        let (x, z, wait_ticks) = if owes_x || owes_z {
            let only = |owes, direction| if owes { direction } else { 0 };
            (only(owes_x, x), only(owes_z, z), self.config.interval(0))
        } else {
            if let Some(line) = &mut self.line {
                line.advance();
            }
            (x, z, wait_ticks)
        };
        Some(Due {
            wait_ticks,
            delta: [x, 0, z, 0],
        })
    }

    fn begin_move(&mut self, index: usize) {
        let figure = self.figure.as_ref();
        let move_steps = figure.get(index).copied().unwrap_or_default();
        self.line = Some(FigureMove::new(move_steps, &self.config));
        self.task = Task::Figure { index };
    }

    /// Returns a step of the task, or a step of the spindle that is due earlier.
    fn merged(&mut self, due: Due) -> StepEvent<MICROFACTORY_MOTORS> {
        let left = due.wait_ticks.saturating_sub(self.used_ticks);
        let turns_along = self.config.spindle_turns_in_figures
            && matches!(self.task, Task::Figure { .. } | Task::Approach { .. });
        if turns_along && self.spindle_ticks <= left {
            let wait_ticks = self.spindle_ticks;
            // The wait is at most `left`, so the sum is at most the wait of the step.
            self.used_ticks = self.used_ticks.wrapping_add(wait_ticks);
            self.spindle_ticks = self.config.spindle_interval();
            return self.made(wait_ticks, [0, 0, 0, 1]);
        }
        // If the spindle turns, the ticks are above `left`. Otherwise they restart.
        self.spindle_ticks = if turns_along {
            self.spindle_ticks.wrapping_sub(left)
        } else {
            self.config.spindle_interval()
        };
        self.used_ticks = 0;
        self.due = None;
        self.made(left, due.delta)
    }

    /// Makes a step and updates the positions.
    fn made(
        &mut self,
        wait_ticks: u32,
        delta: [i8; MICROFACTORY_MOTORS],
    ) -> StepEvent<MICROFACTORY_MOTORS> {
        for (play, direction) in self.plays.iter_mut().zip(delta) {
            if direction != 0 {
                play.step(direction > 0);
            }
        }
        for (since_zero, direction) in self.since_zero.iter_mut().zip(delta) {
            *since_zero = since_zero.map(|steps| steps.wrapping_add(direction.into()));
        }
        let [.., turn] = delta;
        // At 64 steps per second, 2^32 steps take more than two years.
        self.spindle = self.spindle.wrapping_add(i32::from(turn));
        StepEvent { wait_ticks, delta }
    }
}
