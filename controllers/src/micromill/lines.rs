//! Lines of the queue: each becomes an output, a dwell or a move.

use husillo_gcode::SpindleDirection;
use husillo_interp::{Interpolator, Moves};
use husillo_planner::Timer;
use husillo_transports::micromill::Answer;

use super::{
    Micromill, MicromillEvent, Next,
    course::Course,
    directions::Directions,
    entry::{Entry, Kind, Place, nm},
    path::Flat,
    task::Task,
};
use husillo_machine::{Config, MAX_WAIT_TICKS, Segment, StepGuard};

impl<const QUEUE: usize, const AHEAD: usize, const OUT: usize> Micromill<'_, QUEUE, AHEAD, OUT> {
    /// Begins the next line of the queue.
    #[inline(never)]
    pub(super) fn begin(&mut self) -> Next {
        let Some(entry) = self.queue.first() else {
            return Next::Wait;
        };
        // A command that only changes coordinates does not wait for the moves before it. `machine`
        // does the same.
        let is_nothing = entry.kind == Kind::Nothing;
        if !entry.moves() && !is_nothing && self.carried_ticks > 0 {
            self.task = Task::Idle;
            let wait_ticks = self.carried_ticks.min(MAX_WAIT_TICKS.into()) as u32;
            self.carried_ticks = self.carried_ticks.wrapping_sub(wait_ticks.into());
            return self.give(wait_ticks, Directions::NONE);
        }
        let is_output = !entry.moves() && !matches!(entry.kind, Kind::Nothing | Kind::Dwell);
        if is_output && !self.ahead.is_empty() {
            return Next::Wait; // it must happen exactly between the moves
        }
        self.queue.pop();
        if !entry.moves() && !is_nothing {
            self.guard.rest();
        }
        if core::mem::take(&mut self.owes_taken) {
            self.link.answer(Answer::Taken);
        }
        let spindle = |direction| spindle(direction, entry.value);
        let event = match entry.kind {
            Kind::Nothing => {
                self.end_line();
                return Next::Again;
            }
            Kind::Dwell => {
                let ticks =
                    // below 2^48
                    u64::from(entry.value).wrapping_mul(u64::from(self.config.machine.timer_hz));
                self.task = Task::Dwell { left_ticks: ticks };
                return Next::Again;
            }
            Kind::SpindleClockwise => spindle(SpindleDirection::Clockwise),
            Kind::SpindleCounterClockwise => spindle(SpindleDirection::CounterClockwise),
            Kind::SpindleOff | Kind::End => spindle(SpindleDirection::Off),
            Kind::Tool => MicromillEvent::Tool {
                number: entry.value as u8,
            },
            Kind::Rapid | Kind::Linear | Kind::Clockwise | Kind::CounterClockwise => {
                self.begin_move(&entry);
                return Next::Again;
            }
        };
        self.end_line();
        Next::Give(event)
    }

    #[inline(never)]
    fn begin_move(&mut self, entry: &Entry) {
        let ticks = self.set_out(entry);
        self.at = entry.to;
        if self.path.is_none() {
            self.carried_ticks = self.carried_ticks.saturating_add(ticks);
            self.end_line();
        } else {
            self.task = Task::Line;
        }
    }

    /// Creates the path of a move and returns its ticks. A move without a step of an axis has no
    /// path.
    ///
    /// This is a separate function so that the stack of a small chip holds one path at a time.
    #[inline(never)]
    fn set_out(&mut self, entry: &Entry) -> u64 {
        let start = self.plays.map(|play| play.load());
        let end = self
            .config
            .machine
            .nearest_steps(&nm(entry.to))
            .unwrap_or(start);
        // An invalid line was refused when it arrived.
        let Some(segment) = segment(entry, self.at) else {
            return 0;
        };
        lay(&mut self.path, &self.config.machine, &segment, start, end);
        let Some(path) = &self.path else { return 0 };
        let ticks = ticks(&self.config.machine, &segment, path, &mut self.guard);
        if path.remaining() == 0 {
            self.path = None;
            return ticks;
        }
        let mut heading = Directions::NONE;
        if path.radius().is_none() {
            for (axis, (start, end)) in (0..).zip(start.iter().zip(end)) {
                let direction = i8::from(end > *start).wrapping_sub(i8::from(end < *start));
                heading = heading.with(axis, direction);
            }
        }
        let (sweep, largest) = (path.total_sweep(), path.largest_sweep());
        self.course = Course::new(Timer::new(ticks, sweep, largest), heading);
        ticks
    }
}

pub(super) const fn spindle(direction: SpindleDirection, rpm: u16) -> MicromillEvent {
    MicromillEvent::Spindle { direction, rpm }
}

#[inline(never)]
fn segment(entry: &Entry, from: Place) -> Option<Segment<3>> {
    let command = entry.command(from)?;
    Some(Segment {
        from: nm(from),
        command,
    })
}

#[inline(never)]
fn lay(
    place: &mut Option<Flat>,
    machine: &Config<3>,
    segment: &Segment<3>,
    start: [i32; 3],
    end: [i32; 3],
) {
    *place = Some(machine.path(segment, start, end));
}

#[inline(never)]
fn ticks(machine: &Config<3>, segment: &Segment<3>, path: &Flat, guard: &mut StepGuard<3>) -> u64 {
    guard.begin(machine, segment, path)
}
