//! The present move: its steps, and the take-ups before them.

use husillo_interp::Interpolator;
use husillo_planner::Timer;

use super::{
    Micromill, MicromillInputs, MicromillStep, Next, course::TakeUp, directions::Directions,
    first_owed, path::Flat, task::Task,
};
use husillo_machine::MAX_WAIT_TICKS;

impl<const QUEUE: usize, const AHEAD: usize, const OUT: usize> Micromill<'_, QUEUE, AHEAD, OUT> {
    /// Returns the next step of the present move, or of the take-up before it. If something else
    /// comes first, the step is stored, and [`look`](Micromill::look) decides what comes next.
    #[inline]
    pub(super) fn step_of_path(&mut self, inputs: &MicromillInputs) -> Option<MicromillStep> {
        let course = &mut self.course;
        let next = match &mut self.path {
            Some(Flat::Arc(arc)) if course.next.is_none() => arc.next().map(|step| {
                let directions = Directions::from(step);
                course.turns(directions);
                (directions, course.timer.wait(step.sweep), arc.remaining())
            }),
            Some(Flat::Line(line)) if course.next.is_none() => line.next().map(|step| {
                (
                    Directions::from(step),
                    course.timer.wait_one(),
                    line.remaining(),
                )
            }),
            Some(_) => {
                if let Some((direction, wait_ticks)) = course.take_up() {
                    if let Some(play) = self.plays.get_mut(direction.number()) {
                        play.take_up(direction.negative == 0);
                    }
                    self.guard.stepped_aside(wait_ticks, direction.axes);
                    return Some(self.say(wait_ticks, direction, 0));
                }
                course
                    .next
                    .take()
                    .map(|(directions, wait)| (directions, wait, 0))
            }
            None => return None,
        };
        let Some((directions, wait, remaining)) = next else {
            self.end_path();
            return None;
        };
        if course.may_owe
            || wait > u64::from(MAX_WAIT_TICKS)
            || directions.negative & inputs.home != 0
        {
            course.next = Some((directions, wait));
            return None;
        }
        // No take-up is due: the step moves the loads.
        let (axes, negative) = (i32::from(directions.axes), i32::from(directions.negative));
        let [x, y, z] = &mut self.plays;
        x.carry((axes & 1).wrapping_sub((negative & 1) << 1));
        y.carry((axes >> 1 & 1).wrapping_sub(negative & 2));
        if axes & 4 != 0 {
            z.carry((axes >> 2).wrapping_sub(negative >> 1 & 2));
        }
        let mut wait = wait as u32;
        if self.guard.follows(directions.axes, remaining) {
            wait = self.guard.step(&self.config.machine, wait, directions.axes);
        } else {
            self.guard.pass(wait);
        }
        Some(self.say(wait, directions, directions.axes))
    }

    /// Handles what precedes a step of the path: a take-up or a part of its wait. A closed switch
    /// cancels the step.
    pub(super) fn precede(&mut self, inputs: &MicromillInputs) -> Next {
        let course = &mut self.course;
        let Some((directions, mut wait)) = course.next.take() else {
            return Next::Again;
        };
        if course.may_owe {
            // The first step of a move also gets the carried ticks.
            wait = wait.saturating_add(core::mem::take(&mut self.carried_ticks));
            // A straight move takes up the backlash of all its axes before it begins. An arc takes
            // up the backlash of each axis where it reverses.
            let owed = first_owed(&self.plays, course.heading);
            if let Some((direction, left)) = owed.or_else(|| first_owed(&self.plays, directions)) {
                let config = &self.config.machine;
                let hz = config
                    .axes
                    .get(direction.number())
                    .map_or(1, |axis| axis.max_rate_hz);
                let pace = Timer::new(config.timer_hz.into(), hz.max(1).into(), 1);
                course.next = Some((directions, wait));
                course.owed = Some(TakeUp {
                    direction,
                    left,
                    pace,
                });
                return Next::Again;
            }
            course.is_even();
        }
        if wait > u64::from(MAX_WAIT_TICKS) {
            course.next = Some((directions, wait.wrapping_sub(MAX_WAIT_TICKS.into())));
            return self.give(MAX_WAIT_TICKS, Directions::NONE);
        }
        if directions.negative & inputs.home != 0 {
            // No switch closes within the travel. A closed switch therefore shows that steps were
            // lost.
            self.is_homed = false;
            self.cut();
            return Next::Wait;
        }
        course.next = Some((directions, wait));
        Next::Again
    }

    /// Ends the move after its last step is given. The move is done when that step is made.
    #[inline]
    pub(super) fn end_walked(&mut self) {
        let is_walked = self.path.as_ref().is_some_and(|path| path.remaining() == 0);
        if is_walked && self.course.next.is_none() {
            self.end_path();
        }
    }

    #[inline(never)]
    fn end_path(&mut self) {
        self.path = None;
        self.task = Task::Idle;
        self.end_line();
    }
}
