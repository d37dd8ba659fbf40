//! State of a path: its timing, and the take-ups before its steps.

use husillo_planner::Timer;

use super::directions::Directions;

/// State of the present path.
#[derive(Clone, Debug)]
pub(super) struct Course {
    pub(super) timer: Timer,
    /// Directions in which a straight move takes up backlash before it begins.
    pub(super) heading: Directions,
    /// The next step of the path and its wait, while a take-up or a part of the wait precedes it.
    pub(super) next: Option<(Directions, u64)>,
    /// Whether an axis steps for the first time, or in the opposite direction to its last step.
    /// Only then can a take-up be due.
    pub(super) may_owe: bool,
    /// Last directions of the axes: the lower byte marks forward steps, the upper byte backward
    /// steps.
    known: u16,
    /// The take-up before the next step.
    pub(super) owed: Option<TakeUp>,
}

/// A take-up of one axis.
#[derive(Clone, Debug)]
pub(super) struct TakeUp {
    pub(super) direction: Directions,
    /// Steps left, not 0.
    pub(super) left: u16,
    pub(super) pace: Timer,
}

impl Course {
    pub(super) const fn new(timer: Timer, heading: Directions) -> Self {
        Course {
            timer,
            heading,
            next: None,
            may_owe: true,
            known: 0,
            owed: None,
        }
    }

    /// Registers the directions of the next step of an arc.
    #[inline]
    pub(super) const fn turns(&mut self, directions: Directions) {
        let both = u16::from_le_bytes([directions.axes, directions.negative]);
        let steps = both & !(both >> 8);
        if steps & !self.known != 0 {
            self.may_owe = true;
            self.known = self.known & !steps.swap_bytes() | steps;
        }
    }

    /// Returns the next step of a take-up of one axis, and the ticks before it.
    #[inline]
    pub(super) fn take_up(&mut self) -> Option<(Directions, u32)> {
        let owed = self.owed.as_mut()?;
        let step = (owed.direction, owed.pace.wait_one() as u32); // at most a second
        owed.left = owed.left.wrapping_sub(1);
        if owed.left == 0 {
            self.owed = None;
        }
        Some(step)
    }

    /// Marks that no take-up is left.
    #[inline]
    pub(super) const fn is_even(&mut self) {
        self.may_owe = false;
        self.heading = Directions::NONE;
    }
}
