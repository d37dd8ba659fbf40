//! Stepping axes with encoders: what was lost is told, and given again.

use husillo_backlash::{Backlash, Lash};
use husillo_interp::{Moves, Path};
use husillo_planner::Timer;

use crate::lines::step_encoder::Watch;
use crate::{AxisEncoder, Event, MAX_WAIT_TICKS, Machine, OnLoss, StepEvent};

/// One entry of the stream of a machine with encoders.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Followed<const N: usize> {
    /// To be carried out. Steps that are given again are events like any other.
    Event(Event<N>),
    /// The motor of an axis is not where it should be.
    Lost {
        /// Number of the axis.
        axis: usize,
        /// Steps it is behind, signed: what it would have to make. Under [`OnLoss::Report`] since the last report.
        steps: i32,
    },
    /// The axis is where it should be again, and the path goes on.
    Corrected {
        /// Number of the axis.
        axis: usize,
    },
    /// Steps were given again as often as allowed, and the motor is still behind: it is blocked. Nothing moves any more.
    Stalled {
        /// Number of the axis.
        axis: usize,
        /// Steps it is behind, signed.
        steps: i32,
    },
}

/// What goes on.
#[derive(Copy, Clone, Debug)]
enum State {
    /// The path is made.
    Path,
    /// Outputs after an abort; then the axes are looked at.
    Aborted,
    /// The path comes to a stop.
    Braking,
    /// Motors have come to rest: it is seen what they lack.
    Settled,
    /// An axis is given steps again.
    Correcting(usize),
    /// Until the operator decides.
    Stopped,
}

/// A [`Machine`] some of whose axes have an encoder on their motor: every event is compared with what the motors did.
///
/// Losses come in the stream as [`Followed::Lost`], at the latest when a motor is more than `tolerance_steps` away, and whatever is
/// less when nothing is left to do. [`AxisEncoder::on_loss`] says what follows. Steps are given again one axis at a time, at its
/// `correction_rate_hz`, the path standing; against the direction of travel across its lash and back, so that the nut comes from where it
/// was. Every axis has its `attempts`, so one that is blocked ends with [`Followed::Stalled`].
///
/// A machine without encoders does not need this, and pays nothing for it. With them an event costs three multiplications of 64 bits an axis that has
/// one (where it is, where it should be, how far it may be off), and an axis takes 64 bytes at most.
#[derive(Clone, Debug)]
pub struct ClosedLoop<const N: usize, P = Path<N>, L: Lash<N> = Backlash, const QUEUE: usize = 16> {
    machine: Machine<N, P, L, QUEUE>,
    axes: [Option<Watch>; N],
    state: State,
    /// The operator's hold, beside the one for braking.
    is_held: bool,
    /// The operator has said to go on.
    is_allowed: bool,
    /// The first step after an abort: it waits until all axes are right.
    pending: Option<Event<N>>,
    /// Steps to give again: there, then back.
    legs: [i32; 2],
    timer: Timer,
}

impl<const N: usize, P: Moves<N>, L: Lash<N>, const QUEUE: usize> ClosedLoop<N, P, L, QUEUE> {
    /// A machine that stands, with the encoders its axes have. Where they are at the first event is where they should be.
    pub fn new(machine: Machine<N, P, L, QUEUE>, encoders: [Option<AxisEncoder>; N]) -> Self {
        Self {
            machine,
            axes: encoders.map(|encoder| encoder.map(Watch::new)),
            state: State::Path,
            is_held: false,
            is_allowed: false,
            pending: None,
            legs: [0; 2],
            timer: Timer::new(0, 1, 1),
        }
    }

    /// The machine, for its state.
    pub const fn machine(&self) -> &Machine<N, P, L, QUEUE> {
        &self.machine
    }

    /// The machine, for lines and overrides. Its hold, resume and abort are this one's.
    pub const fn machine_mut(&mut self) -> &mut Machine<N, P, L, QUEUE> {
        &mut self.machine
    }

    /// Feed hold, as [`Machine::hold`]. Steps that are being given again are finished first.
    pub fn hold(&mut self) {
        self.is_held = true;
        self.machine.hold();
    }

    /// Ends a hold, or a stop: then what is missing is given again first.
    pub fn resume(&mut self) {
        self.is_held = false;
        match self.state {
            State::Path | State::Aborted => self.machine.resume(),
            State::Stopped => self.restart(State::Settled),
            State::Braking | State::Settled | State::Correcting(_) => {}
        }
    }

    /// Drops all that was taken and not yet given out, as [`Machine::abort`]. What is missing is given again before anything moves.
    pub fn abort(&mut self) {
        self.machine.abort();
        self.is_held = false;
        self.pending = None;
        self.restart(State::Aborted);
    }

    /// Whether it stands because of a loss, until [`resume`](Self::resume) or [`abort`](Self::abort).
    pub const fn is_stopped(&self) -> bool {
        matches!(self.state, State::Stopped)
    }

    /// Whether the step given last was one that is given again.
    pub const fn is_correcting(&self) -> bool {
        matches!(self.state, State::Correcting(_))
    }

    /// Goes on by the operator's word: what is missing is given again.
    fn restart(&mut self, state: State) {
        for watch in self.axes.iter_mut().flatten() {
            watch.attempts = 0;
        }
        self.legs = [0; 2];
        self.is_allowed = true;
        self.state = state;
    }

    /// The next entry, when the events before it have been carried out and the encoders are at `counts`
    /// (`husillo_encoder::Extended::position`; of an axis without one it is not looked at). `None` when all has been given out, under a
    /// hold, or when it [stopped](Self::is_stopped).
    ///
    /// Constant time as [`Machine::next_event`].
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

    /// An event of the path, unless something is lost.
    fn path(&mut self, counts: &[i64; N]) -> Option<Followed<N>> {
        if let Some(lost) = self.find(counts, Watch::is_tolerable) {
            return Some(lost);
        }
        let event = self.pending.take().or_else(|| self.machine.next_event());
        if let Some(event) = event {
            return Some(self.give(event));
        }
        // What is less than the tolerance counts at rest.
        let is_there = |(watch, counts): (&mut Watch, i64)| {
            let behind = watch.behind(counts);
            watch.is_there(behind)
        };
        if self.is_held || self.watched(counts).all(is_there) {
            return None;
        }
        Some(self.settle())
    }

    /// The axes with encoders, and where these are.
    fn watched(&mut self, counts: &[i64; N]) -> impl Iterator<Item = (&mut Watch, i64)> {
        let axes = self.axes.iter_mut().zip(counts);
        axes.filter_map(|(watch, counts)| Some((watch.as_mut()?, *counts)))
    }

    /// An event of the machine.
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

    /// What an abort leaves to do: switching off. A step waits.
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

    /// The path comes to a stop.
    fn brake(&mut self, counts: &[i64; N]) -> Followed<N> {
        if let Some(lost) = self.find(counts, Watch::is_tolerable) {
            return lost;
        }
        match self.machine.next_event() {
            Some(event) => self.give(event),
            None => self.settle(),
        }
    }

    /// A rest, after which the motors are looked at.
    fn settle(&mut self) -> Followed<N> {
        self.state = State::Settled;
        let axes = self.axes.iter().flatten();
        let ticks = axes.map(|watch| watch.encoder.settle_ticks).max();
        let wait_ticks = ticks.unwrap_or(0).min(MAX_WAIT_TICKS);
        Followed::Event(Event::Dwell { wait_ticks })
    }

    /// The first axis that is told as lost now. The path brakes, unless it is only to be told.
    fn find(
        &mut self,
        counts: &[i64; N],
        is_right: impl Fn(&Watch, i64) -> bool,
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

    /// The motors rest: what is lost, what is right again, what is given again, and then the path.
    fn settled(&mut self, counts: &[i64; N]) -> Option<Followed<N>> {
        if let Some(lost) = self.find(counts, Watch::is_there) {
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
                Some((heading, lash)) => watch.legs(behind, heading, lash),
                // Not taken up: the lash is there all the same.
                None => {
                    let facts = self.machine.config().axes.get(axis);
                    let lash = facts.map_or(0, |facts| facts.lash_steps);
                    watch.legs(behind, watch.heading, lash)
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

    /// A step that is given again.
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
        assert!(size_of::<Option<Watch>>() <= 64);
        let size = size_of::<ClosedLoop<3>>() - size_of::<Machine<3>>();
        assert!(size <= 3 * 64 + 80, "{size}");
    }
}
