//! Assigns steps to programmed moves, and finds where moves and take-ups begin and end.

use crate::geometry::nurbs::NurbsPath;
use crate::geometry::path::Path;
use crate::observers::{AXES, Begun};
use husillo_gcode::{Command, Nm};
use husillo_machine::{Config, Origin, Segment, StepEvent};
use std::collections::VecDeque;

/// The move under execution.
#[derive(Debug)]
pub struct Moves {
    half_step_nm: f64,
    /// Programmed spindle speed in thousandths of a turn per minute; 0 if the spindle is off.
    pub milli_rpm: u64,
    segment: Option<Segment<AXES>>,
    target: [i32; AXES],
    is_arrived: bool,
    origin: Origin,
    take_up_axis: Option<usize>,
    /// The curves of several commands that are not begun yet. The segment of such a curve only has
    /// its end.
    curves: VecDeque<NurbsPath>,
}

/// A move with its path.
#[derive(Debug)]
pub struct Move {
    segment: Segment<AXES>,
    to: [Nm; AXES],
    path: Path,
    milli_rpm: u64,
}

impl Move {
    /// The move as observers receive it.
    pub const fn begun(&self) -> Begun<'_> {
        Begun {
            segment: &self.segment,
            to: self.to,
            path: &self.path,
            milli_rpm: self.milli_rpm,
        }
    }
}

impl Moves {
    /// Starts at rest at zero. `half_step_nm` decides whether an arc is a circle or a spiral, as in
    /// [`Path::programmed`].
    pub fn new(half_step_nm: f64) -> Self {
        Self {
            half_step_nm,
            milli_rpm: 0,
            segment: None,
            target: [0; AXES],
            is_arrived: true,
            origin: Origin::Rest,
            take_up_axis: None,
            curves: VecDeque::new(),
        }
    }

    /// Sets the curves of several commands (G5.2, G5.3) in the order in which they are made.
    pub fn set_curves(&mut self, curves: Vec<NurbsPath>) {
        self.curves = curves.into();
    }

    /// Puts the tool at these steps before the run.
    pub const fn start_at(&mut self, tool: [i32; AXES]) {
        self.target = tool;
    }

    /// Whether a step with this origin is the first of a move or of a take-up, or the first after a
    /// take-up.
    #[inline]
    pub fn is_turn(&self, origin: Origin) -> bool {
        self.is_arrived || origin != self.origin
    }

    /// Takes the move that the machine is executing. Call it if [`is_turn`](Self::is_turn). Returns
    /// the programmed move if a new one begins.
    #[cold]
    pub fn turn(
        &mut self,
        executing: Option<Segment<AXES>>,
        config: &Config<AXES>,
        origin: Origin,
    ) -> Option<Move> {
        let is_other = executing != self.segment;
        self.segment = executing;
        self.is_arrived = false;
        if origin != Origin::TakeUp {
            self.take_up_axis = None;
        }
        self.origin = origin;
        let segment = executing.filter(|_| is_other)?;
        let path = match segment.command {
            Command::NurbsEnd { .. } => self.curves.pop_front().map(Path::Nurbs)?,
            _ => Path::programmed(segment.from, &segment.command, self.half_step_nm)?,
        };
        let to = segment.command.end().unwrap_or(segment.from);
        for (axis, target) in self.target.iter_mut().enumerate() {
            let scale = config.axes[axis].scale;
            *target = scale.nearest(to[axis].0).unwrap_or(0);
        }
        Some(Move {
            segment,
            to,
            path,
            milli_rpm: self.milli_rpm,
        })
    }

    /// Takes a step of a take-up. Returns whether the take-up of its axis begins with this step.
    pub fn takes_up(&mut self, step: &StepEvent<AXES>) -> bool {
        let axis = step.delta.iter().position(|delta| *delta != 0);
        let begins = axis != self.take_up_axis;
        self.take_up_axis = axis;
        begins
    }

    /// Takes the commanded position of the tool in steps.
    #[inline]
    pub fn sent(&mut self, position: [i32; AXES]) {
        self.is_arrived = position == self.target;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_take_up_begins_once_for_each_axis() {
        let mut moves = Moves::new(70.0);
        let step = |delta| StepEvent {
            wait_ticks: 1,
            delta,
        };
        let [x, y] = [step([-1, 0, 0, 0, 0, 0]), step([0, 1, 0, 0, 0, 0])];
        assert_eq!(
            [x, x, y, y].map(|step| moves.takes_up(&step)),
            [true, false, true, false]
        );
    }

    #[test]
    fn a_move_begins_after_its_target_or_with_another_origin() {
        let mut moves = Moves::new(70.0);
        moves.start_at([2, 0, 0, 0, 0, 0]);
        assert!(moves.is_turn(Origin::Rest));
        moves.sent([1, 0, 0, 0, 0, 0]);
        assert!(!moves.is_turn(Origin::Rest) && moves.is_turn(Origin::Feed));
        moves.sent([2, 0, 0, 0, 0, 0]);
        assert!(moves.is_turn(Origin::Rest));
    }
}
