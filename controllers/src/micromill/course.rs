//! What goes with the path of a line: its tempo, and what comes before its steps.

use husillo_planner::Timer;

use super::ways::Ways;

/// Of a path under way.
#[derive(Clone, Debug)]
pub(super) struct Course {
    pub(super) timer: Timer,
    /// Directions in which a straight move takes up lash before it begins.
    pub(super) heading: Ways,
    /// A step of the path that something comes before, and its wait.
    pub(super) next: Option<(Ways, u64)>,
    /// Whether an axis steps in the opposite direction to before, or for the first time. Only then
    /// a take-up can be due.
    pub(super) may_owe: bool,
    /// Axes that have stepped forwards last, and in the upper byte those that have backwards.
    known: u16,
    /// What is taken up before it.
    pub(super) owed: Option<TakeUp>,
}

/// Lash that an axis takes up.
#[derive(Clone, Debug)]
pub(super) struct TakeUp {
    pub(super) way: Ways,
    /// Steps left, not 0.
    pub(super) left: u16,
    pub(super) pace: Timer,
}

impl Course {
    pub(super) const fn new(timer: Timer, heading: Ways) -> Self {
        Course {
            timer,
            heading,
            next: None,
            may_owe: true,
            known: 0,
            owed: None,
        }
    }

    /// The next step of an arc is known.
    #[inline]
    pub(super) const fn turns(&mut self, ways: Ways) {
        let both = u16::from_le_bytes([ways.axes, ways.negative]);
        let steps = both & !(both >> 8);
        if steps & !self.known != 0 {
            self.may_owe = true;
            self.known = self.known & !steps.swap_bytes() | steps;
        }
    }

    /// The next step of a take-up, of one axis, and the ticks before it.
    #[inline]
    pub(super) fn take_up(&mut self) -> Option<(Ways, u32)> {
        let owed = self.owed.as_mut()?;
        let step = (owed.way, owed.pace.wait_one() as u32); // a second at most
        owed.left = owed.left.wrapping_sub(1);
        if owed.left == 0 {
            self.owed = None;
        }
        Some(step)
    }

    /// Nothing is taken up any more.
    #[inline]
    pub(super) const fn is_even(&mut self) {
        self.may_owe = false;
        self.heading = Ways::NONE;
    }
}
