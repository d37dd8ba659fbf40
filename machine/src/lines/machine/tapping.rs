//! Rigid tapping: the feed axes follow the spindle in both directions.

use husillo_backlash::BacklashModel;
use husillo_gcode::{Command, Nm, SpindleDirection};
use husillo_interp::Moves;

use super::Machine;
use crate::lines::extension::Extension;
use crate::lines::path_ramp::{MoveQueue, PathRamp};
use crate::lines::state::{Stage, Tapping};
use crate::{Alarm, Event, Output};

impl<
    const N: usize,
    P: Moves<N>,
    L: BacklashModel<N>,
    const QUEUE: usize,
    E: Extension<N>,
    R: PathRamp,
> Machine<N, P, L, QUEUE, E, R>
{
    /// Begins a tap: down to the bottom with the spindle, from its index on.
    pub(super) fn begin_tap(&mut self, bottom: [Nm; N], top: [Nm; N], lead: Nm) {
        let turns = self.config.equipment.tapping_overrun_turns.unwrap_or(0);
        let beyond = self.config.beyond(&top, &bottom, lead, turns);
        let Some(state) = self.extension.state_mut() else {
            return;
        };
        state.tapping = Some(Tapping {
            #[cfg(feature = "extended")]
            top,
            beyond,
            lead,
            stage: Stage::Down,
            last: [0; N],
        });
        self.follow_to(bottom, lead);
    }

    /// Begins the next stage of a tap when the move of the last one has ended. Returns whether
    /// there is one.
    pub(super) fn end_tap(&mut self) -> bool {
        let is_over = self.run.is_none() && self.schedule.moves.is_empty();
        let Some(state) = self.extension.state_mut() else {
            return false;
        };
        let Some(tapping) = state.tapping.as_mut().filter(|_| is_over) else {
            return false;
        };
        let (beyond, lead) = (tapping.beyond, tapping.lead);
        let (direction, milli_rpm) = state.spindle;
        let (next, direction, to) = match tapping.stage {
            Stage::Down => {
                let [below, _] = beyond;
                (Stage::Below, reversed(direction), below)
            }
            #[cfg(feature = "extended")]
            Stage::Up => {
                let [_, above] = beyond;
                (Stage::Above, direction, above)
            }
            // The spindle has not reversed.
            _ => {
                self.raise(Alarm::SpindleNotReversed);
                return true;
            }
        };
        (tapping.stage, tapping.last) = (next, [0; N]);
        let output = Output::Spindle {
            direction,
            milli_rpm,
        };
        self.signal([Some(Event::Output(output)), None]);
        self.follow_to(to, lead);
        true
    }

    /// Appends a move that follows the spindle.
    fn follow_to(&mut self, to: [Nm; N], lead: Nm) {
        let has_backlash = self.take_up.stops();
        let command = Command::Thread { to, lead };
        self.schedule.push(&self.config, &command, has_backlash);
    }

    /// Whether a tap is in progress.
    pub(super) fn is_tapping(&self) -> bool {
        let state = self.extension.state();
        state.is_some_and(|state| state.tapping.is_some())
    }

    /// Whether the spindle turns against the direction of its thread.
    pub(super) fn turns_back(&self) -> bool {
        let tapping = self.extension.state().and_then(|state| state.tapping);
        tapping.is_some_and(|tapping| !matches!(tapping.stage, Stage::Down | Stage::Below))
    }

    /// Notes a step that follows the spindle: it may be dropped.
    pub(super) fn note_followed(&mut self, delta: [i8; N]) {
        let state = self.extension.state_mut();
        if let Some(tapping) = state.and_then(|state| state.tapping.as_mut()) {
            tapping.last = delta;
        }
    }
}

/// The other direction.
const fn reversed(direction: SpindleDirection) -> SpindleDirection {
    match direction {
        SpindleDirection::Clockwise => SpindleDirection::CounterClockwise,
        SpindleDirection::CounterClockwise => SpindleDirection::Clockwise,
        SpindleDirection::Off => SpindleDirection::Off,
    }
}

#[cfg(feature = "extended")]
impl<const N: usize, P: Moves<N>, L: BacklashModel<N>, const QUEUE: usize, R: PathRamp>
    Machine<N, P, L, QUEUE, crate::Extended<N>, R>
{
    /// Whether the spindle is being reversed by a tap (G33.1), and the axes follow it until it
    /// turns back. Carry out each event before you request the next one, and call
    /// [`spindle_reversed`](Machine::spindle_reversed) when the counts go back.
    pub fn awaits_reversal(&self) -> bool {
        let tapping = self.extension.state.tapping;
        tapping.is_some_and(|tapping| matches!(tapping.stage, Stage::Below | Stage::Above))
    }

    /// The spindle has turned back. `is_made` is whether the last event was carried out: a step for
    /// which the counts did not suffice is taken back.
    ///
    /// The following steps have negative waits ([`FollowEvent`](crate::FollowEvent)) until the tap
    /// is out of the hole. Without effect unless
    /// [`awaits_reversal`](Machine::awaits_reversal).
    pub fn spindle_reversed(&mut self, is_made: bool) {
        if !self.awaits_reversal() {
            return;
        }
        let Some(tapping) = &mut self.extension.state.tapping else {
            return;
        };
        if !is_made {
            for (load, delta) in self.load.iter_mut().zip(tapping.last) {
                // The axis was there before.
                *load = load.wrapping_sub(delta.into());
            }
        }
        let is_below = tapping.stage == Stage::Below;
        tapping.stage = Stage::Up;
        let (top, lead) = (tapping.top, tapping.lead);
        self.run = None;
        self.held = None;
        let here = self.position(&self.load);
        self.schedule.clear(here, self.load);
        self.schedule.set_mode(self.mode);
        if is_below {
            self.schedule.go_on_with_thread();
            self.follow_to(top, lead);
        } else {
            self.extension.state.tapping = None;
            let has_backlash = self.take_up.stops();
            let command = Command::Rapid { to: top };
            self.schedule.push(&self.config, &command, has_backlash);
            self.refill();
        }
    }
}
