//! Tasks: a line, or a mode that decides each step separately.

use husillo_backlash::Play;
use husillo_transports::micromill::{Answer, Axis};

use super::{Micromill, MicromillInputs, Next, directions::Directions, first_owed};

#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(super) enum Task {
    Idle,
    /// The move of a line.
    Line,
    Dwell {
        left_ticks: u64,
    },
    Jog {
        directions: Directions,
        hz: u16,
    },
    Run {
        directions: Directions,
        hz: u16,
    },
    /// Counted load steps; `left` remain.
    Steps {
        directions: Directions,
        left: u16,
    },
    /// Homing: moves off the switch if it is closed at the start. The later move towards the switch
    /// determines the flank.
    Leave {
        axis: Axis,
        left: u16,
    },
    /// Homing: moves towards the switch.
    Search {
        axis: Axis,
        left: u32,
    },
    /// Homing: backs off the switch; `left` load steps remain.
    BackOff {
        axis: Axis,
        left: u16,
    },
}

impl Task {
    /// Whether the task is not part of a program.
    pub(super) const fn is_manual(&self) -> bool {
        !matches!(self, Task::Idle | Task::Line | Task::Dwell { .. })
    }
}

impl<const QUEUE: usize, const AHEAD: usize, const OUT: usize> Micromill<'_, QUEUE, AHEAD, OUT> {
    /// Returns the next step of homing, a jog, a run or counted steps. All given events are made.
    pub(super) fn manual(&mut self, inputs: &MicromillInputs) -> Next {
        match self.task {
            Task::Idle | Task::Line | Task::Dwell { .. } => Next::Wait,
            Task::Leave { axis, left } => self.leave(axis, left, inputs),
            Task::Search { axis, left } => self.search(axis, left, inputs),
            Task::BackOff { axis, left } => self.back_off(axis, left, inputs),
            Task::Jog { directions, hz } | Task::Run { directions, hz } => {
                let wait_ticks = self.interval(hz);
                if self.is_at_end(directions, inputs) {
                    return self.end(Answer::Stopped);
                }
                let (delta, _) = self.owed_or(directions);
                self.give(wait_ticks, delta)
            }
            Task::Steps { left: 0, .. } => self.end(Answer::Done),
            Task::Steps { directions, left } => {
                if self.is_at_end(directions, inputs) {
                    return self.end(Answer::Stopped);
                }
                let (delta, moves) = self.owed_or(directions);
                self.task = Task::Steps {
                    directions,
                    left: left.wrapping_sub(moves.into()), // `left` is not 0
                };
                self.give(self.interval(self.config.jog_hz), delta)
            }
        }
    }

    fn leave(&mut self, axis: Axis, left: u16, inputs: &MicromillInputs) -> Next {
        if !is_closed(axis, inputs) {
            self.task = Task::Search {
                axis,
                left: self.search_steps(axis),
            };
            return Next::Again;
        }
        if left == 0 {
            return self.end(Answer::NoSwitch);
        }
        let left = left.wrapping_sub(1);
        self.task = Task::Leave { axis, left };
        self.step_alone(axis, true)
    }

    /// Returns a step of one axis at the rate of moves by hand.
    fn step_alone(&mut self, axis: Axis, forward: bool) -> Next {
        self.give(
            self.interval(self.config.jog_hz),
            Directions::one(axis, forward),
        )
    }

    fn search(&mut self, axis: Axis, left: u32, inputs: &MicromillInputs) -> Next {
        if is_closed(axis, inputs) {
            // Moving towards the switch has engaged the negative flank.
            let index = axis as usize;
            if let Some((play, backlash)) = self.plays.get_mut(index).zip(self.backlash.get(index))
            {
                play.set_backlash(*backlash);
                play.set_behind();
            }
            self.task = Task::BackOff {
                axis,
                left: self.config.back_off_steps,
            };
            return Next::Again;
        }
        if left == 0 {
            return self.end(Answer::NoSwitch);
        }
        let left = left.wrapping_sub(1);
        self.task = Task::Search { axis, left };
        self.step_alone(axis, false)
    }

    fn back_off(&mut self, axis: Axis, left: u16, inputs: &MicromillInputs) -> Next {
        if left > 0 {
            let (delta, moves) = self.owed_or(Directions::one(axis, true));
            self.task = Task::BackOff {
                axis,
                left: left.wrapping_sub(moves.into()),
            };
            return self.give(self.interval(self.config.jog_hz), delta);
        }
        if is_closed(axis, inputs) {
            return self.end(Answer::NoSwitch);
        }
        if let Some(play) = self.plays.get_mut(axis as usize) {
            play.set_zero();
        }
        let next = match axis {
            Axis::Z => Axis::X,
            Axis::X => Axis::Y,
            Axis::Y => {
                self.is_homed = true;
                return self.end(Answer::Done);
            }
        };
        self.task = Task::Leave {
            axis: next,
            left: self.config.leave_steps,
        };
        Next::Again
    }

    /// Returns the longest search for the switch of an axis: over its travel, or from its known
    /// position.
    fn search_steps(&self, axis: Axis) -> u32 {
        let index = axis as usize;
        let most = self.config.search_steps.get(index).copied().unwrap_or(0);
        match self.plays.get(index) {
            Some(play) if self.was_homed => {
                let to_zero = play.load().max(0).unsigned_abs();
                // Below 2^31 and 2^16.
                most.min(to_zero.wrapping_add(self.config.leave_steps.into()))
            }
            _ => most,
        }
    }

    /// Returns the take-up of the first axis that has one due, or the step itself. The second value
    /// is `true` for the step itself.
    fn owed_or(&self, directions: Directions) -> (Directions, bool) {
        match first_owed(&self.plays, directions) {
            Some((owed, _)) => (owed, false),
            None => (directions, true),
        }
    }

    /// Whether an axis has reached its end: the end of the travel if it is known, otherwise the
    /// switch.
    fn is_at_end(&self, directions: Directions, inputs: &MicromillInputs) -> bool {
        if directions.negative & inputs.home != 0 {
            return true;
        }
        let axes = self.config.machine.axes.iter().zip(&self.plays);
        let mut axes = axes.zip(directions.deltas());
        axes.any(|((axis, play), direction)| {
            let moves = direction != 0 && !play.owes(direction > 0);
            moves && !self.is_within(axis, play, direction.into())
        })
    }

    /// Whether this many steps end within the travel of an axis. Before homing, the travel is
    /// unknown.
    #[inline(never)]
    pub(super) fn is_within(&self, axis: &husillo_machine::Axis, play: &Play, steps: i16) -> bool {
        match axis.travel {
            Some([low, high]) if self.is_homed => {
                let to = axis
                    .scale
                    .position(play.load().saturating_add(steps.into()));
                (low.0..=high.0).contains(&to)
            }
            _ => true,
        }
    }

    /// Ends a task that decides each step separately.
    fn end(&mut self, answer: Answer) -> Next {
        self.task = Task::Idle;
        self.stand();
        self.link.answer(answer);
        Next::Again
    }

    /// Returns the ticks between steps. They are rounded up, so that the rate is never exceeded.
    fn interval(&self, hz: u16) -> u32 {
        self.config.machine.timer_hz.div_ceil(u32::from(hz).max(1))
    }
}

fn is_closed(axis: Axis, inputs: &MicromillInputs) -> bool {
    Directions::one(axis, true).axes & inputs.home != 0
}
