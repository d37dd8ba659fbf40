//! Generation of events: steps of a move, of the take-up before it, and the time between them.

use husillo_backlash::BacklashModel;
use husillo_gcode::Command;
use husillo_interp::{Moves, Step};

use super::{Machine, Origin, Run};
use crate::lines::extension::Extension;
use crate::lines::guard::bits;
use crate::lines::kept::Kept;
use crate::lines::path_ramp::{MoveQueue, PathRamp};
use crate::lines::schedule::Figure;
use crate::lines::take_up::Followed;
use crate::{Event, FollowEvent, MAX_WAIT_TICKS, Segment, StepEvent};

impl<
    const N: usize,
    P: Moves<N>,
    L: BacklashModel<N>,
    const QUEUE: usize,
    E: Extension<N>,
    R: PathRamp,
> Machine<N, P, L, QUEUE, E, R>
{
    /// Returns the next event, or `None` when all events were returned or under a hold.
    ///
    /// # Cost
    /// Constant time, except where a move ends and another one takes its place in the queue. If
    /// that is an arc it is walked once: 9 ns per event on a desktop, 73 instructions on a
    /// Cortex-M4F.
    #[inline]
    pub fn next_event(&mut self) -> Option<Event<N>> {
        if E::IS_EXTENDED {
            if let Some(event) = self.surface_event() {
                return Some(event);
            }
        }
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
                        let wait = timer.wait(step.sweep);
                        Some(self.path_step(step, wait))
                    }
                    None => {
                        self.end_move();
                        self.next_unhurried()
                    }
                }
            }
            _ => self.next_unhurried(),
        }
    }

    /// Makes a path step, unless an axis reverses and must be taken up first.
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

    /// Makes a path step that needs no take-up before it.
    #[inline]
    fn give(&mut self, delta: [i8; N], wait: u64) -> Event<N> {
        let follows = self.is_following();
        if wait > u64::from(MAX_WAIT_TICKS) {
            self.held = Some((delta, wait.wrapping_sub(u64::from(MAX_WAIT_TICKS))));
            return if follows {
                self.followed(MAX_WAIT_TICKS, [0; N])
            } else {
                self.guard.stepped(MAX_WAIT_TICKS, 0);
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

    /// Makes the step together with the correction steps for the backlash at its end.
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
                // Each takes half the time. Where that is too fast the path waits; a spindle cannot
                // wait.
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

    /// Makes motor steps of the path, after a wait of at most [`MAX_WAIT_TICKS`].
    #[inline]
    fn timed(&mut self, delta: [i8; N], wait: u64, follows: bool) -> Event<N> {
        self.origin = match &self.segment {
            Some(Segment {
                command: Command::Rapid { .. },
                ..
            }) => Origin::Rapid,
            _ => Origin::Feed,
        };
        let axes = bits(&delta);
        if follows {
            self.guard.stepped_aside(0, axes);
            return self.followed(wait as u32, delta);
        }
        let mut wait_ticks = wait as u32;
        if self.guard.watches(axes) {
            let longest = self.longest_interval;
            wait_ticks = self
                .guard
                .step_beyond(longest, &self.config, wait_ticks, axes);
        } else {
            self.guard.stepped(wait_ticks, axes);
        }
        Event::Step(StepEvent { wait_ticks, delta })
    }

    /// A step that follows the spindle.
    #[inline]
    fn followed(&mut self, wait_counts_q16: u32, delta: [i8; N]) -> Event<N> {
        if E::IS_EXTENDED {
            self.note_followed(delta);
        }
        Event::Follow(FollowEvent {
            wait_counts_q16,
            delta,
            turns_back: E::IS_EXTENDED && self.turns_back(),
        })
    }

    /// Makes one motor step of take-up, while any remains.
    fn take_up_step(&mut self) -> Option<Event<N>> {
        let step = self.take_up.step(&self.config)?;
        self.guard.stepped_aside(step.wait_ticks, bits(&step.delta));
        self.origin = Origin::TakeUp;
        Some(Event::Step(step))
    }

    /// Handles everything except the next step of a path at constant speed.
    #[cold]
    fn next_unhurried(&mut self) -> Option<Event<N>> {
        loop {
            let event = self.next_of_queue();
            // A probing move, or a stage of a tap, has ended where there is no other event.
            if !E::IS_EXTENDED || event.is_some() || !(self.end_probe() || self.end_tap()) {
                return event;
            }
        }
    }

    /// The next event of the move, of the queue, or of the command after it.
    fn next_of_queue(&mut self) -> Option<Event<N>> {
        loop {
            // A take-up of an axis with a ramp cannot stop at once.
            let stops_at_once = !self.take_up.is_under_way() || !self.schedule.has_ramps();
            // A move that follows the spindle cannot stop without it.
            let stops_at_once = stops_at_once && !self.is_following() && !self.goes_on_threading();
            let stops_at_once = stops_at_once && !(E::IS_EXTENDED && self.is_tapping());
            if self.ramp.is_held() && stops_at_once && self.ramp.is_at_rest(&self.schedule.moves) {
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
                if let Event::Dwell { wait_ticks } = signal {
                    self.guard.stepped(wait_ticks, 0);
                }
                return Some(signal);
            }
            if E::IS_EXTENDED && self.is_awaiting() {
                return None;
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
                self.guard.stepped(MAX_WAIT_TICKS, 0);
                return Some(Event::Dwell {
                    wait_ticks: MAX_WAIT_TICKS,
                });
            }
            if self.schedule.moves.front().is_some() {
                if E::IS_EXTENDED {
                    if let Some(output) = self.output_due() {
                        self.origin = Origin::Rest;
                        return Some(output);
                    }
                }
                self.begin_move()?;
            } else if let Some(command) = self.waiting.take() {
                self.begin(command);
                self.refill();
            } else {
                self.segment = None;
                return None;
            }
        }
    }

    /// Returns the next step of the path: `None` under a hold, `Some(None)` when the move has
    /// ended.
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
            self.carry_short_move()?;
            self.end_move();
            return Some(None);
        };
        if let (true, Some(timer)) = (run.follows, &mut run.timer) {
            run.left = run.left.wrapping_sub(1);
            let wait = timer.wait(step.sweep);
            return Some(Some(self.path_step(step, wait)));
        }
        let wait = match &mut run.timer {
            Some(timer) => timer.wait(step.sweep),
            None => match self.ramp.wait(step.sweep, &mut self.schedule.moves) {
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

    /// Carries the time of a move without a step to the next move. Returns `None` under a hold.
    #[cold]
    #[inline(never)]
    fn carry_short_move(&mut self) -> Option<()> {
        let front = self.schedule.moves.front();
        let is_short =
            front.is_some_and(|(stretch, work)| stretch.length_nm != 0 && work.events == 0);
        if is_short && self.schedule.has_ramps() {
            let wait = self.ramp.wait(1, &mut self.schedule.moves)?;
            self.carried_ticks = self.carried_ticks.saturating_add(wait);
        }
        Some(())
    }

    /// Whether the executing move follows the spindle.
    pub(super) fn is_following(&self) -> bool {
        self.run.as_ref().is_some_and(|run| run.follows)
    }

    /// Whether the next move belongs to the thread in progress.
    fn goes_on_threading(&self) -> bool {
        let next = self.schedule.moves.front();
        next.is_some_and(|(_, work)| work.kept.is_thread() && !work.is_indexed)
    }

    /// The move, or the part of an arc, has ended: frees its entry in the queue.
    fn end_move(&mut self) {
        self.schedule.moves.pop();
        if let Some(state) = self.extension.state_mut() {
            state.count();
        }
        self.refill();
        let goes_on = match self.schedule.moves.front() {
            Some((stretch, work)) if work.figure == Figure::Continued => Some((*stretch, work)),
            _ => None,
        };
        match (goes_on, &mut self.run) {
            (Some((stretch, work)), Some(run)) => {
                run.left = work.events;
                let sweeps = [work.sweep, work.largest_sweep.into()];
                let time_q16 = work.time_q16;
                self.ramp
                    .begin(&stretch, sweeps, time_q16, &self.schedule.moves);
            }
            _ => {
                self.run = None;
                if let Some(end) = self.segment.and_then(|segment| segment.command.end()) {
                    self.schedule.set_start(end);
                }
            }
        }
    }
}
