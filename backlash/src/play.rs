//! An axis whose nut has backlash on its screw.

use crate::BacklashModel;

/// Motor and load of one axis in steps.
///
/// The position of the load is between `motor - backlash` (its positive flank is engaged) and
/// `motor` (its negative flank is engaged). So it is known for each step whether it moves the load,
/// and a task may end anywhere, also during a take-up.
#[derive(Copy, Clone, Debug)]
pub struct Play {
    backlash: u16,
    /// Motor steps ahead of the load, 0 to `backlash`.
    ahead: u16,
    load: i32,
}

impl Play {
    /// Creates an axis at zero with the positive flank engaged.
    pub const fn new(backlash: u16) -> Self {
        Self {
            backlash,
            ahead: backlash,
            load: 0,
        }
    }

    /// Creates an axis in a known state: `ahead` motor steps ahead of the load, at most `backlash`.
    pub const fn at(backlash: u16, ahead: u16, load: i32) -> Self {
        let ahead = if ahead > backlash { backlash } else { ahead };
        Self {
            backlash,
            ahead,
            load,
        }
    }

    /// Returns the number of steps in that direction that move the motor only.
    pub const fn owed(&self, is_forward: bool) -> u16 {
        if is_forward {
            self.backlash.wrapping_sub(self.ahead) // `ahead` is at most `backlash`
        } else {
            self.ahead
        }
    }

    /// Whether a step in that direction moves the motor only.
    pub const fn owes(&self, is_forward: bool) -> bool {
        self.owed(is_forward) != 0
    }

    /// Makes a motor step. Returns whether it moves the load.
    pub const fn step(&mut self, is_forward: bool) -> bool {
        let moves = !self.owes(is_forward);
        self.shift(is_forward, moves);
        moves
    }

    const fn shift(&mut self, is_forward: bool, moves_load: bool) {
        match (moves_load, is_forward) {
            // 2^32 steps at 100 per second take more than a year.
            (true, true) => self.load = self.load.wrapping_add(1),
            (true, false) => self.load = self.load.wrapping_sub(1),
            // Below the backlash, or above zero.
            (false, true) => self.ahead = self.ahead.wrapping_add(1),
            (false, false) => self.ahead = self.ahead.wrapping_sub(1),
        }
    }

    /// Sets the state: the negative flank is engaged.
    pub const fn set_behind(&mut self) {
        self.ahead = 0;
    }

    /// Makes the present position of the load zero.
    pub const fn set_zero(&mut self) {
        self.load = 0;
    }

    /// Returns the position of the load, in steps from zero.
    pub const fn load(self) -> i32 {
        self.load
    }
}

/// Functions for the steps of a path.
impl Play {
    /// Makes this many steps, -1 to 1, that move the load. Call it only if no take-up is due.
    #[inline]
    pub const fn carry(&mut self, steps: i32) {
        self.load = self.load.wrapping_add(steps);
    }

    /// Makes a step of a take-up, which moves the motor only.
    #[inline]
    pub const fn take_up(&mut self, is_forward: bool) {
        self.shift(is_forward, false);
    }

    /// Undoes the last step.
    pub const fn undo(&mut self, is_forward: bool, moved: bool) {
        self.shift(!is_forward, moved);
    }

    /// Changes the backlash. The engaged flank stays engaged.
    pub const fn set_backlash(&mut self, backlash: u16) {
        let is_positive = self.ahead == self.backlash;
        self.backlash = backlash;
        if is_positive || self.ahead > backlash {
            self.ahead = backlash;
        }
    }
}

/// The same backlash everywhere, also if the axis begins within its backlash. The position of the
/// load is that of the machine.
impl<const N: usize> BacklashModel<N> for Play {
    fn take_up(&mut self, _: usize, direction: i8, _: &[i32; N]) -> u32 {
        if direction == 0 {
            return 0;
        }
        let owed = self.owed(direction > 0);
        self.ahead = if direction > 0 { self.backlash } else { 0 };
        owed.into()
    }

    fn is_free(&self) -> bool {
        self.backlash == 0
    }
}
