//! Stepping axes with encoders: lost steps are reported and re-emitted.

use husillo_backlash::{Backlash, BacklashModel};
use husillo_interp::{Moves, Path};
use husillo_planner::{Ramp, Timer};

use crate::lines::extension::Extension;
use crate::lines::path_ramp::PathRamp;
use husillo_encoder::StepWatch;

use crate::{AxisEncoder, Event, MAX_WAIT_TICKS, Machine, OnLoss, StepEvent};

/// One entry of the stream of a machine with encoders.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Followed<const N: usize> {
    /// An event to be carried out. Re-emitted steps are ordinary events.
    Event(Event<N>),
    /// The motor of an axis is not at its expected position.
    Lost {
        /// Index of the axis.
        axis: usize,
        /// Signed number of steps that the axis still has to make. With [`OnLoss::Report`], the
        /// steps lost since the last report.
        steps: i32,
    },
    /// The axis is at its expected position again, and the path continues.
    Corrected {
        /// Index of the axis.
        axis: usize,
    },
    /// Steps were re-emitted as often as permitted, and the motor is still behind: it is blocked.
    /// All motion has stopped.
    Stalled {
        /// Index of the axis.
        axis: usize,
        /// Signed number of steps by which the axis is behind.
        steps: i32,
    },
}

/// Current activity.
#[derive(Copy, Clone, Debug)]
enum State {
    /// The path is executed.
    Path,
    /// The outputs of an abort are made; the axes are checked afterwards.
    Aborted,
    /// The path brakes to a stop.
    Braking,
    /// The motors are at rest and are checked.
    Settled,
    /// Steps of this axis are re-emitted.
    Correcting(usize),
    /// All motion waits for the operator.
    Stopped,
}

/// A [`Machine`] with motor encoders on some axes. Every event is compared with the motion of the
/// motors.
///
/// Losses appear in the stream as [`Followed::Lost`], at the latest when a motor is more than
/// `tolerance_steps` off; smaller losses appear when the motion ends. A motor at rest is then at
/// its expected position: exactly where a count is no longer than a step, within two counts
/// otherwise. [`AxisEncoder::on_loss`] selects the reaction. Steps are re-emitted one axis at a
/// time at its `correction_rate_hz` while the path stands. Steps against the direction of travel
/// cross the backlash and return, so that the nut approaches from the same side as before. Every
/// axis has a number of `attempts`; a blocked axis ends with [`Followed::Stalled`].
///
/// # Cost
/// None for a machine without encoders, which does not use this type. With them, an event takes
/// three 64-bit multiplications per axis with an encoder (actual position, expected position,
/// tolerance). An axis takes at most 64 bytes.
///
/// The machine comes last: short instructions reach 1 kB from the address.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct ClosedLoop<
    const N: usize,
    P = Path<N>,
    L: BacklashModel<N> = Backlash,
    const QUEUE: usize = 16,
    E: Extension<N> = (),
    R: PathRamp = Ramp,
> {
    axes: [Option<StepWatch>; N],
    state: State,
    /// Hold by the operator, independent of the hold for braking.
    is_held: bool,
    /// Whether the operator has permitted the correction.
    is_allowed: bool,
    /// First step after an abort; it waits until all axes are at their expected positions.
    pending: Option<Event<N>>,
    /// Steps to re-emit: the first leg, then the return leg.
    legs: [i32; 2],
    timer: Timer,
    machine: Machine<N, P, L, QUEUE, E, R>,
}

impl<
    const N: usize,
    P: Moves<N>,
    L: BacklashModel<N>,
    const QUEUE: usize,
    E: Extension<N>,
    R: PathRamp,
> ClosedLoop<N, P, L, QUEUE, E, R>
{
    /// Wraps a machine at standstill with the encoders of its axes. The encoder positions at the
    /// first event are the expected ones.
    pub fn new(machine: Machine<N, P, L, QUEUE, E, R>, encoders: [Option<AxisEncoder>; N]) -> Self {
        Self {
            machine,
            axes: encoders.map(|encoder| encoder.map(StepWatch::new)),
            state: State::Path,
            is_held: false,
            is_allowed: false,
            pending: None,
            legs: [0; 2],
            timer: Timer::new(0, 1, 1),
        }
    }

    /// The machine, for its state.
    pub const fn machine(&self) -> &Machine<N, P, L, QUEUE, E, R> {
        &self.machine
    }

    /// The machine, for lines and overrides. For hold, resume and abort use the methods of this
    /// type.
    pub const fn machine_mut(&mut self) -> &mut Machine<N, P, L, QUEUE, E, R> {
        &mut self.machine
    }

    /// Feed hold, as [`Machine::hold`]. Steps that are being re-emitted are finished first.
    pub fn hold(&mut self) {
        self.is_held = true;
        self.machine.hold();
    }

    /// Ends a hold or a stop. After a stop the missing steps are re-emitted first.
    pub fn resume(&mut self) {
        self.is_held = false;
        match self.state {
            State::Path | State::Aborted => self.machine.resume(),
            State::Stopped => self.restart(State::Settled),
            State::Braking | State::Settled | State::Correcting(_) => {}
        }
    }

    /// Drops all lines and events that were not yet returned, as [`Machine::abort`]. Missing steps
    /// are re-emitted before the next motion.
    pub fn abort(&mut self) {
        self.machine.abort();
        self.is_held = false;
        self.pending = None;
        self.restart(State::Aborted);
    }

    /// Whether motion has stopped because of a loss, until [`resume`](Self::resume) or
    /// [`abort`](Self::abort).
    pub const fn is_stopped(&self) -> bool {
        matches!(self.state, State::Stopped)
    }

    /// Whether the last step was a re-emitted one.
    pub const fn is_correcting(&self) -> bool {
        matches!(self.state, State::Correcting(_))
    }

    /// Continues on request of the operator and permits the correction.
    fn restart(&mut self, state: State) {
        for watch in self.axes.iter_mut().flatten() {
            watch.attempts = 0;
        }
        self.legs = [0; 2];
        self.is_allowed = true;
        self.state = state;
    }

    /// Returns the next entry. Call it after the previous events were carried out, with the
    /// encoders at `counts` (`husillo_encoder::Extended::position`); the entry of an axis without
    /// encoder is ignored. Returns `None` when all events were returned, under a hold, or when
    /// [stopped](Self::is_stopped).
    ///
    /// # Cost
    /// Constant time, as [`Machine::next_event`].
    pub fn next_event(&mut self, counts: &[i64; N]) -> Option<Followed<N>> {
        match self.state {
            State::Path => self.path(counts),
            State::Aborted => Some(self.outputs()),
            State::Braking => Some(self.brake(counts)),
            State::Settled => self.settled(counts),
            State::Correcting(axis) => Some(self.correct(axis)),
            State::Stopped => None,
        }
    }

    /// Returns an event of the path, unless steps are lost.
    fn path(&mut self, counts: &[i64; N]) -> Option<Followed<N>> {
        if let Some(lost) = self.find(counts, StepWatch::is_tolerable) {
            return Some(lost);
        }
        let event = self.pending.take().or_else(|| self.machine.next_event());
        if let Some(event) = event {
            return Some(self.give(event));
        }
        // At rest, losses below the tolerance count as well.
        let is_there = |(watch, counts): (&mut StepWatch, i64)| {
            let behind = watch.behind(counts);
            watch.is_there(behind)
        };
        if self.is_held || self.watched(counts).all(is_there) {
            return None;
        }
        Some(self.settle())
    }

    /// The axes with encoders, and the counts of these.
    fn watched(&mut self, counts: &[i64; N]) -> impl Iterator<Item = (&mut StepWatch, i64)> {
        let axes = self.axes.iter_mut().zip(counts);
        axes.filter_map(|(watch, counts)| Some((watch.as_mut()?, *counts)))
    }

    /// Passes on an event of the machine.
    fn give(&mut self, event: Event<N>) -> Followed<N> {
        let delta = match event {
            Event::Step(step) => step.delta,
            Event::Follow(follow) => follow.delta,
            _ => [0; N],
        };
        for (watch, delta) in self.axes.iter_mut().zip(delta) {
            if let Some(watch) = watch {
                watch.step(delta);
            }
        }
        Followed::Event(event)
    }

    /// Returns the outputs that an abort switches off. A step has to wait.
    fn outputs(&mut self) -> Followed<N> {
        match self.machine.next_event() {
            Some(event @ (Event::Step(_) | Event::Follow(_) | Event::Index)) => {
                self.pending = Some(event);
                self.machine.hold();
                self.settle()
            }
            Some(event) => self.give(event),
            None => self.settle(),
        }
    }

    /// Brakes the path to a stop.
    fn brake(&mut self, counts: &[i64; N]) -> Followed<N> {
        if let Some(lost) = self.find(counts, StepWatch::is_tolerable) {
            return lost;
        }
        match self.machine.next_event() {
            Some(event) => self.give(event),
            None => self.settle(),
        }
    }

    /// Waits for the motors to come to rest; they are checked afterwards.
    fn settle(&mut self) -> Followed<N> {
        self.state = State::Settled;
        let axes = self.axes.iter().flatten();
        let ticks = axes.map(|watch| watch.encoder.settle_ticks).max();
        let wait_ticks = ticks.unwrap_or(0).min(MAX_WAIT_TICKS);
        Followed::Event(Event::Dwell { wait_ticks })
    }

    /// Finds the first axis with a loss to report. The path brakes, unless losses are only
    /// reported.
    fn find(
        &mut self,
        counts: &[i64; N],
        is_right: impl Fn(&StepWatch, i64) -> bool,
    ) -> Option<Followed<N>> {
        let axes = (0..N).zip(&mut self.axes).zip(counts);
        for ((axis, watch), counts) in axes {
            let Some(watch) = watch else { continue };
            let behind = watch.behind(*counts);
            if watch.is_lost || is_right(watch, behind) {
                continue;
            }
            let steps = watch.steps(behind);
            if watch.encoder.on_loss == OnLoss::Report {
                watch.accept(steps);
            } else {
                watch.is_lost = true;
                if matches!(self.state, State::Path) {
                    self.machine.hold();
                    self.state = State::Braking;
                }
            }
            return Some(Followed::Lost { axis, steps });
        }
        None
    }

    /// With the motors at rest: reports losses and corrections, re-emits steps, and then continues
    /// the path.
    fn settled(&mut self, counts: &[i64; N]) -> Option<Followed<N>> {
        if let Some(lost) = self.find(counts, StepWatch::is_there) {
            return Some(lost);
        }
        let lost = (0..N).zip(&mut self.axes).zip(counts);
        let mut lost = lost.filter_map(|((axis, watch), counts)| {
            let watch = watch.as_mut().filter(|watch| watch.is_lost)?;
            let behind = watch.behind(*counts);
            Some((axis, watch, behind))
        });
        if let Some((axis, watch, behind)) = lost.next() {
            if watch.is_there(behind) {
                watch.is_lost = false;
                watch.attempts = 0;
                return Some(Followed::Corrected { axis });
            }
            if watch.encoder.on_loss == OnLoss::Stop && !self.is_allowed {
                self.state = State::Stopped;
                return None;
            }
            if watch.attempts >= watch.encoder.attempts {
                self.state = State::Stopped;
                self.is_allowed = false;
                let steps = watch.steps(behind);
                return Some(Followed::Stalled { axis, steps });
            }
            watch.attempts = watch.attempts.saturating_add(1);
            self.legs = match self.machine.play(axis) {
                Some((heading, backlash)) => watch.legs(behind, heading, backlash),
                // Without take-up the screw still has its backlash.
                None => {
                    let facts = self.machine.config().axes.get(axis);
                    let backlash = facts.map_or(0, |facts| facts.backlash_steps);
                    watch.legs(behind, watch.heading, backlash)
                }
            };
            let timer_hz = self.machine.config().timer_hz;
            let rate_hz = watch.encoder.correction_rate_hz.max(1);
            self.timer = Timer::new(timer_hz.into(), rate_hz.into(), 1);
            self.state = State::Correcting(axis);
            return Some(self.correct(axis));
        }
        self.is_allowed = false;
        self.state = State::Path;
        if !self.is_held {
            self.machine.resume();
        }
        self.path(counts)
    }

    /// Re-emits one step.
    fn correct(&mut self, axis: usize) -> Followed<N> {
        let Some(leg) = self.legs.iter_mut().find(|leg| **leg != 0) else {
            return self.settle();
        };
        let direction = leg.signum();
        *leg = leg.wrapping_sub(direction);
        let mut delta = [0; N];
        if let Some(delta) = delta.get_mut(axis) {
            *delta = direction as i8;
        }
        let wait = self.timer.wait(1).min(MAX_WAIT_TICKS.into());
        Followed::Event(Event::Step(StepEvent {
            wait_ticks: wait as u32,
            delta,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_takes_64_bytes_at_most() {
        assert!(size_of::<Option<StepWatch>>() <= 64);
        let size = size_of::<ClosedLoop<3>>() - size_of::<Machine<3>>();
        assert!(size <= 3 * 64 + 80, "{size}");
    }
}
