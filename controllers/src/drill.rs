//! The circuit-board drill: point-to-point moves, one axis at a time, and a program of records.

mod config;
mod event;
mod lease;
mod lights;
mod stroke;
mod task;

pub use config::DrillConfig;
pub use event::{DrillEvent, DrillFault, DrillInputs, DrillReport};
pub use lights::DrillLights;

use husillo_transports::drill::{Axis, Device, MachineState, Order};

use husillo_machine::StepEvent;

use crate::controller::{Controller, Timed};
use stroke::Stroke;
use task::{Next, Task};

/// Index of Z among the motors.
const Z: usize = 2;

/// The controller of the circuit-board drill: bytes in, events and bytes out. `N` is its memory in
/// bytes; the original has 8192.
///
/// | when | call |
/// | --- | --- |
/// | a byte arrives | [`push`](Drill::push) |
/// | the last event is carried out | [`next_event`](Drill::next_event), with the present switches |
/// | no byte has arrived for [`lease_us`](Drill::lease_us) | [`expire`](Drill::expire) |
/// | the transmitter is free | [`transmit`](Drill::transmit) |
/// | the button R is pressed, or power returns | [`reset`](Drill::reset) |
///
/// After a reset the drill homes Z, Y and X and sends `B`. Before Y moves, Z moves off its upper
/// sensor and finds it again. This detects an upper sensor that sticks. Such a sensor reports
/// closed even while the bit is in the board.
///
/// Positions are steps from home. X moves, then Y. Then Z drills: it moves from the upper sensor to
/// the lower one and back. A switch causes a [`DrillFault`] if it does not close within the longest
/// search, closes too early, or is open at zero. A sensor of Z causes a fault if it is closed at a
/// depth where, by the steps of Z, it must be open. After a fault the spindle stops, and nothing
/// moves until a reset. A link with extras sends `!` and then stays silent.
///
/// # Cost
/// An event takes some comparisons. A record of the program also takes two copies of bytes. The
/// size is `N` + 0.1 kB.
///
/// # Examples
///
/// ```
/// use husillo_controllers::{Drill, DrillConfig, DrillEvent, DrillInputs};
///
/// let mut drill = Drill::<64>::new(DrillConfig::FIXED);
/// let (mut z, mut said) = (5, None);
/// // Z is five steps below its sensor. X and Y move off their switches and back.
/// let (mut x, mut y) = (0, 0);
/// while said.is_none() {
///     let inputs = DrillInputs { home: [x <= 0, y <= 0], is_up: z <= 0, is_down: false };
///     if let DrillEvent::Step(step) = drill.next_event(&inputs) {
///         let [dx, dy, dz] = step.delta.map(i32::from);
///         (x, y, z) = (x + dx, y + dy, z + dz);
///     }
///     said = drill.transmit();
/// }
/// assert_eq!((said, drill.is_homed()), (Some(b'B'), true));
/// ```
#[derive(Clone, Debug)]
pub struct Drill<const N: usize> {
    config: DrillConfig,
    link: Device<N>,
    task: Task,
    place: [u16; 2],
    /// Steps from the switches to zero: 0 except after `c` away from home.
    zero: [u16; 2],
    is_homed: bool,
    /// Whether the switch of the present search has closed and has opened again.
    has_opened: bool,
    /// Whether the switches of X and Y were open at the last check.
    were_open: [bool; 2],
    /// The actual and the requested state of the spindle.
    spindle: [bool; 2],
    report: Option<DrillReport>,
    /// The sensors of Z at the last event: up, down.
    sees_z: [bool; 2],
    stroke: Stroke,
    is_homing: bool,
    /// Whether the lamp of the heartbeat is lit, and whether a wait for its change was given.
    heartbeat: bool,
    waits_for_heartbeat: bool,
}

impl<const N: usize> Controller for Drill<N> {
    type Inputs = DrillInputs;
    type Event = DrillEvent;
    type Stops = ();

    /// Takes a byte from the line. Only the button R stops this machine. A byte ends the wait of a
    /// heartbeat.
    fn receive(&mut self, byte: u8) -> bool {
        self.push(byte);
        self.waits_for_heartbeat
    }

    fn halted(&mut self) {
        self.waits_for_heartbeat = false;
    }

    fn made(&mut self, _: u8, _: usize) {
        self.heartbeat ^= core::mem::take(&mut self.waits_for_heartbeat);
    }

    fn stops(&self) {}

    fn lease_us(&self) -> Option<u32> {
        Drill::lease_us(self)
    }

    /// The event that was already given is still made. Its step is the last step of X and Y.
    fn expire(&mut self) -> bool {
        Drill::expire(self);
        false
    }

    fn next_event(&mut self, machine: u8, inputs: &DrillInputs) -> Option<DrillEvent> {
        if machine > 0 {
            return None;
        }
        match Drill::next_event(self, inputs) {
            DrillEvent::Idle if self.config.blinks && self.lights().is_ready => {
                if self.waits_for_heartbeat {
                    return None;
                }
                self.waits_for_heartbeat = true;
                Some(DrillEvent::Dwell {
                    wait_ticks: DrillConfig::HEARTBEAT_US,
                })
            }
            DrillEvent::Idle => None,
            event => Some(event),
        }
    }

    fn transmit(&mut self) -> Option<u8> {
        Drill::transmit(self)
    }

    fn reset(&mut self) {
        Drill::reset(self);
    }
}

impl Timed for DrillEvent {
    fn wait_ticks(&self) -> Option<u32> {
        match *self {
            DrillEvent::Step(step) => Some(step.wait_ticks),
            // Another task follows at once. Its waits continue from the end of this one.
            DrillEvent::Dwell { wait_ticks: 0 } => None,
            DrillEvent::Dwell { wait_ticks } => Some(wait_ticks),
            DrillEvent::Spindle(_) | DrillEvent::Report(_) | DrillEvent::Idle => None,
        }
    }
}

impl<const N: usize> Drill<N> {
    /// Creates a drill in its state after power-on.
    pub const fn new(config: DrillConfig) -> Self {
        Self {
            link: Device::new(config.rules),
            config,
            task: Task::Idle,
            place: [0; 2],
            zero: [0; 2],
            is_homed: false,
            has_opened: false,
            were_open: [false; 2],
            // The spindle may be on, so it is switched off first.
            spindle: [true, false],
            report: None,
            sees_z: [false; 2],
            stroke: Stroke::UNKNOWN,
            is_homing: false,
            heartbeat: false,
            waits_for_heartbeat: false,
        }
    }

    /// Resets the drill, as the button R does. This button is also the emergency stop. The present
    /// step is the last one. The program is lost, the spindle stops, and the machine homes again.
    pub fn reset(&mut self) {
        self.link = Device::new(self.config.rules);
        self.task = Task::Idle;
        self.is_homed = false;
        self.spindle = [true, false];
        self.report = None;
        self.stroke = Stroke::UNKNOWN;
        self.is_homing = false;
        self.waits_for_heartbeat = false;
    }

    /// Takes a byte from the line.
    pub fn push(&mut self, byte: u8) {
        self.link.set_machine(self.state());
        self.link.push(byte);
    }

    /// Returns the positions, the spindle and the sensors of Z.
    pub const fn state(&self) -> MachineState {
        let [is_up, is_down] = self.sees_z;
        MachineState {
            place_steps: self.place,
            zero_steps: self.zero,
            is_homed: self.is_homed,
            spindle_turns: self.spindle_turns(),
            is_up,
            is_down,
        }
    }

    /// Returns the next byte for the line.
    pub fn transmit(&mut self) -> Option<u8> {
        self.link.transmit()
    }

    /// Returns the bytes of the program in the memory.
    pub fn stored(&self) -> &[u8] {
        self.link.stored()
    }

    /// Returns the steps of X and Y from zero.
    pub const fn position_steps(&self) -> [u16; 2] {
        self.place
    }

    /// Whether positions count from the home switches.
    pub const fn is_homed(&self) -> bool {
        self.is_homed
    }

    /// Whether the drill is at work, or is stopped by a fault.
    pub fn is_working(&self) -> bool {
        self.task != Task::Idle || self.link.is_working()
    }

    /// Whether the spindle turns.
    pub const fn spindle_turns(&self) -> bool {
        let [is_on, _] = self.spindle;
        is_on
    }

    /// Returns the next event for the present switches.
    pub fn next_event(&mut self, inputs: &DrillInputs) -> DrillEvent {
        self.sees_z = [inputs.is_up, inputs.is_down];
        if let Some(report) = self.report.take() {
            return DrillEvent::Report(report);
        }
        let [is_on, should_be_on] = self.spindle;
        if is_on != should_be_on {
            self.spindle = [should_be_on; 2];
            return DrillEvent::Spindle(should_be_on);
        }
        if self.task == Task::Idle {
            match self.link.take() {
                Some(order) => self.begin(order),
                None => return DrillEvent::Idle,
            }
        }
        match self.go_on(inputs) {
            Some(event) => event,
            // The task has changed: the next call returns an event, unless there is a report.
            None => match self.report.take() {
                Some(report) => DrillEvent::Report(report),
                None => DrillEvent::Dwell { wait_ticks: 0 },
            },
        }
    }

    fn begin(&mut self, order: Order) {
        self.task = match order {
            Order::Home => {
                (self.is_homed, self.is_homing) = (false, true);
                self.raise(Next::Home)
            }
            Order::Zero => {
                for (zero, place) in self.zero.iter_mut().zip(self.place) {
                    *zero = zero.saturating_add(place);
                }
                self.place = [0; 2];
                Task::Settle
            }
            Order::Move(Axis::Z, _) => Task::Settle, // no record moves Z
            Order::Move(axis, to) => self.record(number(axis), to),
            Order::Drill(0) => Task::Down {
                left: self.config.stroke_steps,
                is_whole: true,
            },
            Order::Drill(depth) => Task::Down {
                left: depth,
                is_whole: false,
            },
            Order::Jog(Axis::Z, steps) => Task::JogZ { left: steps },
            Order::Jog(axis, steps) => self.jog(number(axis), steps),
            Order::Teach => {
                self.link.teach(self.place);
                self.report = Some(DrillReport::Taught { at: self.place });
                Task::Settle
            }
            Order::Spindle(on) => {
                let [is_on, _] = self.spindle;
                self.spindle = [is_on, on];
                Task::Settle
            }
        };
    }

    fn raise(&self, next: Next) -> Task {
        Task::Up {
            left: self.config.stroke_steps,
            next,
        }
    }

    /// Begins a move of the program.
    fn record(&mut self, axis: u8, to: u16) -> Task {
        if to > self.last_step(axis) {
            return self.fault(DrillFault::OffTable { axis });
        }
        if self.config.raises_first {
            self.raise(Next::Go { axis, to })
        } else {
            Task::Go { axis, to }
        }
    }

    /// Returns the last step of the table, relative to zero.
    fn last_step(&self, axis: u8) -> u16 {
        let index = usize::from(axis);
        match (self.config.travel_steps.get(index), self.zero.get(index)) {
            (Some(&u16::MAX), _) | (None, _) => u16::MAX,
            (Some(last), zero) => last.saturating_sub(zero.copied().unwrap_or_default()),
        }
    }

    /// Begins a jog. It ends at zero and at the end of the table, and the link reports this.
    fn jog(&mut self, axis: u8, steps: i16) -> Task {
        let from = self.place.get(usize::from(axis));
        let from = from.copied().unwrap_or_default();
        // Before homing, the axis may be beyond the end of the table. In that case a forward jog
        // must not move it backwards.
        let last = self.last_step(axis).max(from);
        let to = from.saturating_add_signed(steps).min(last);
        if i32::from(to) != i32::from(from).wrapping_add(i32::from(steps)) {
            self.link.cut_short();
        }
        Task::Go { axis, to }
    }

    /// Returns the next step of the task. Returns `None` if the task ends or changes.
    fn go_on(&mut self, inputs: &DrillInputs) -> Option<DrillEvent> {
        match self.task {
            Task::Idle => None,
            Task::Fault => Some(DrillEvent::Idle),
            Task::Settle => {
                self.task = Task::Idle;
                self.is_homing = false;
                self.link.done();
                Some(DrillEvent::Dwell {
                    wait_ticks: self.config.settle_ticks,
                })
            }
            Task::Leave { axis, left } => self.leave(axis, left, inputs),
            Task::Search { axis, left } => self.search(axis, left, inputs),
            Task::Open { axis, left } => self.open(axis, left, inputs),
            Task::Go { axis, to } => self.walk(axis, to, inputs),
            Task::Beyond { axis, gone } => self.look_beyond(axis, gone, inputs),
            Task::Return { axis, left } => {
                let Some(left) = left.checked_sub(1) else {
                    self.task = Task::Settle;
                    return None;
                };
                self.task = Task::Return { axis, left };
                self.step(usize::from(axis), 1)
            }
            Task::Down { left, is_whole } => self.lower(left, is_whole, inputs),
            Task::Up { left, next } => self.lift(left, next, inputs),
            Task::OpenUp { left, next } => self.open_up(left, next, inputs),
            Task::JogZ { left } => self.jog_z(left, inputs),
        }
    }

    /// Moves off a switch that was closed when homing began.
    fn leave(&mut self, axis: u8, left: u16, inputs: &DrillInputs) -> Option<DrillEvent> {
        let Some(left) = left.checked_sub(1) else {
            self.task = if is_home(inputs, axis) {
                self.fault(DrillFault::StillClosed { axis })
            } else {
                Task::Search {
                    axis,
                    left: self.config.search_steps,
                }
            };
            return None;
        };
        self.task = Task::Leave { axis, left };
        self.step(usize::from(axis), 1)
    }

    fn search(&mut self, axis: u8, left: u32, inputs: &DrillInputs) -> Option<DrillEvent> {
        if is_home(inputs, axis) {
            if self.config.switch_play_steps.is_some() && !self.has_opened {
                self.task = Task::Open {
                    axis,
                    left: self.config.back_off_steps,
                };
                return None;
            }
            let index = usize::from(axis);
            if let (Some(place), Some(zero)) = (self.place.get_mut(index), self.zero.get_mut(index))
            {
                (*place, *zero) = (0, 0);
            }
            if let Some(was_open) = self.were_open.get_mut(index) {
                *was_open = false;
            }
            if axis > 0 {
                self.begin_search(0, inputs);
            } else {
                self.is_homed = true;
                self.report = Some(DrillReport::Homed);
                self.task = Task::Settle;
            }
            return None;
        }
        let Some(left) = left.checked_sub(1) else {
            self.task = self.fault(DrillFault::NoSwitch { axis });
            return None;
        };
        self.task = Task::Search { axis, left };
        self.step(usize::from(axis), -1)
    }

    /// Moves off a switch that has closed, until it opens.
    fn open(&mut self, axis: u8, left: u16, inputs: &DrillInputs) -> Option<DrillEvent> {
        if !is_home(inputs, axis) {
            self.has_opened = true;
            self.task = Task::Search {
                axis,
                left: self.config.back_off_steps.into(),
            };
            return None;
        }
        let Some(left) = left.checked_sub(1) else {
            self.task = self.fault(DrillFault::StillClosed { axis });
            return None;
        };
        self.task = Task::Open { axis, left };
        self.step(usize::from(axis), 1)
    }

    fn begin_search(&mut self, axis: u8, inputs: &DrillInputs) {
        self.has_opened = false;
        self.task = if is_home(inputs, axis) {
            Task::Leave {
                axis,
                left: self.config.back_off_steps,
            }
        } else {
            Task::Search {
                axis,
                left: self.config.search_steps,
            }
        };
    }

    fn walk(&mut self, axis: u8, to: u16, inputs: &DrillInputs) -> Option<DrillEvent> {
        let index = usize::from(axis);
        let zero = self.zero.get(index).copied()?;
        let place = self.place.get_mut(index)?;
        let at = *place;
        let play = self.config.switch_play_steps.filter(|_| self.is_homed);
        let was_open = self.were_open.get_mut(index)?;
        let is_closed = is_home(inputs, axis);
        let has_closed = core::mem::replace(was_open, !is_closed) && is_closed;
        // A switch closes at a known position. It opens again at a position that is not known
        // exactly.
        let is_lost = play.is_some_and(|play| {
            let limit = if has_closed {
                play
            } else {
                self.config.back_off_steps.max(play)
            };
            is_closed && at.saturating_add(zero) > limit
        });
        if is_lost {
            self.task = self.fault(DrillFault::LostSteps { axis });
            return None;
        }
        if at == to {
            let is_at_switch = to == 0 && zero == 0 && play.is_some();
            self.task = if is_at_switch && !is_closed {
                Task::Beyond { axis, gone: 0 }
            } else {
                Task::Settle
            };
            return None;
        }
        let is_forward = at < to;
        *place = if is_forward {
            at.wrapping_add(1)
        } else {
            at.wrapping_sub(1)
        };
        self.step(index, if is_forward { 1 } else { -1 })
    }

    /// Searches for a switch beyond zero. A switch that closes slightly later than before is
    /// accepted. A switch that closes much later shows that steps were lost. The position stays
    /// zero.
    fn look_beyond(&mut self, axis: u8, gone: u16, inputs: &DrillInputs) -> Option<DrillEvent> {
        if is_home(inputs, axis) {
            self.task = Task::Return { axis, left: gone };
            return None;
        }
        if gone >= self.config.switch_play_steps.unwrap_or_default() {
            self.task = self.fault(DrillFault::LostSteps { axis });
            return None;
        }
        self.task = Task::Beyond {
            axis,
            gone: gone.wrapping_add(1), // it is below the play
        };
        self.step(usize::from(axis), -1)
    }

    /// Moves down to the depth or the lower sensor, whichever comes first.
    fn lower(&mut self, left: u16, is_whole: bool, inputs: &DrillInputs) -> Option<DrillEvent> {
        if self.finds_stuck_sensor(inputs, false) || self.switch_by_hole(true) {
            return None;
        }
        let is_deep = left == 0 && !is_whole;
        if inputs.is_down || is_deep {
            self.task = self.raise(Next::Drilled);
            return None;
        }
        let Some(left) = left.checked_sub(1) else {
            self.task = self.fault(DrillFault::NotDown);
            return None;
        };
        self.task = Task::Down { left, is_whole };
        self.step_z(1)
    }

    fn lift(&mut self, left: u16, next: Next, inputs: &DrillInputs) -> Option<DrillEvent> {
        if self.finds_stuck_sensor(inputs, true) {
            return None;
        }
        if next == Next::Home && self.switch_by_hole(false) {
            return None;
        }
        if inputs.is_up && self.doubts_upper_sensor() {
            self.task = Task::OpenUp {
                left: self.config.upper_opens_steps,
                next,
            };
            return None;
        }
        if inputs.is_up {
            match next {
                Next::Home => self.begin_search(1, inputs),
                Next::Go { axis, to } => self.task = Task::Go { axis, to },
                Next::Rest => self.task = Task::Settle,
                Next::Drilled => {
                    self.switch_by_hole(false);
                    self.report = Some(DrillReport::Drilled { at: self.place });
                    self.task = Task::Settle;
                }
            }
            return None;
        }
        let Some(left) = left.checked_sub(1) else {
            self.task = self.fault(DrillFault::NotUp);
            return None;
        };
        self.task = Task::Up { left, next };
        self.step_z(-1)
    }

    /// Switches the spindle if the controller is responsible for it. Returns `true` if the next
    /// event switches it.
    fn switch_by_hole(&mut self, on: bool) -> bool {
        let [is_on, _] = self.spindle;
        let is_due = self.config.spindle_by_hole && is_on != on;
        if is_due {
            self.spindle = [is_on, on];
        }
        is_due
    }

    /// Jogs Z between the sensors.
    fn jog_z(&mut self, left: i16, inputs: &DrillInputs) -> Option<DrillEvent> {
        if self.finds_stuck_sensor(inputs, left < 0) {
            return None;
        }
        let is_at_end = match left.signum() {
            1 => inputs.is_down,
            -1 => inputs.is_up,
            _ => true,
        };
        if is_at_end {
            if left != 0 {
                self.link.cut_short();
            }
            self.task = Task::Settle;
            return None;
        }
        // The count moves towards zero, so it does not overflow.
        let direction = left.signum();
        self.task = Task::JogZ {
            left: left.wrapping_sub(direction),
        };
        self.step_z(if direction > 0 { 1 } else { -1 })
    }

    fn step(&self, axis: usize, direction: i8) -> Option<DrillEvent> {
        let mut delta = [0; 3];
        *delta.get_mut(axis)? = direction;
        Some(DrillEvent::Step(StepEvent {
            wait_ticks: self.config.interval(axis),
            delta,
        }))
    }

    fn fault(&mut self, fault: DrillFault) -> Task {
        self.report = Some(DrillReport::Fault(fault));
        let [is_on, _] = self.spindle;
        self.spindle = [is_on, false];
        // The positions of the axes are no longer certain.
        (self.is_homed, self.is_homing) = (false, false);
        self.link.fail();
        Task::Fault
    }
}

const fn number(axis: Axis) -> u8 {
    match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }
}

/// Whether the home switch of X or Y is closed.
fn is_home(inputs: &DrillInputs, axis: u8) -> bool {
    inputs.home.get(usize::from(axis)) == Some(&true)
}
