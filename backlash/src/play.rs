//! An axis whose nut has play on its screw.

/// Motor and load of one axis in steps.
///
/// The load is between `motor - lash` (its positive flank engaged) and `motor` (its negative flank
/// engaged). So each step shows whether it moves the load, and a task may end anywhere, also during
/// a take-up.
#[derive(Copy, Clone, Debug)]
pub struct Play {
    lash: u16,
    /// Motor steps ahead of the load, 0 to `lash`.
    ahead: u16,
    load: i32,
}

impl Play {
    /// At zero, the positive flank engaged.
    pub const fn new(lash: u16) -> Self {
        Self {
            lash,
            ahead: lash,
            load: 0,
        }
    }

    /// Steps that way which move the motor only.
    pub const fn owed(&self, is_forward: bool) -> u16 {
        if is_forward {
            self.lash.wrapping_sub(self.ahead) // it is not above
        } else {
            self.ahead
        }
    }

    /// Whether a step that way moves the motor only.
    pub const fn owes(&self, is_forward: bool) -> bool {
        self.owed(is_forward) != 0
    }

    /// A motor step; whether it moves the load.
    pub const fn step(&mut self, is_forward: bool) -> bool {
        let moves = !self.owes(is_forward);
        self.shift(is_forward, moves);
        moves
    }

    const fn shift(&mut self, is_forward: bool, moves_load: bool) {
        match (moves_load, is_forward) {
            // Of 2^32 steps, at 100 a second, none in a year.
            (true, true) => self.load = self.load.wrapping_add(1),
            (true, false) => self.load = self.load.wrapping_sub(1),
            // Below the lash, or above zero.
            (false, true) => self.ahead = self.ahead.wrapping_add(1),
            (false, false) => self.ahead = self.ahead.wrapping_sub(1),
        }
    }

    /// The negative flank is engaged here.
    pub const fn set_behind(&mut self) {
        self.ahead = 0;
    }

    /// The load is at zero here.
    pub const fn set_zero(&mut self) {
        self.load = 0;
    }

    /// Load steps from zero.
    pub const fn load(self) -> i32 {
        self.load
    }
}

/// What only steps of a path need.
impl Play {
    /// So many steps, -1 to 1, that move the load, as those do that owe nothing.
    #[inline]
    pub const fn carry(&mut self, steps: i32) {
        self.load = self.load.wrapping_add(steps);
    }

    /// A step that moves the motor only, as those do that are owed.
    #[inline]
    pub const fn take_up(&mut self, is_forward: bool) {
        self.shift(is_forward, false);
    }

    /// As if a step, the last one of those made, had not been.
    pub const fn undo(&mut self, is_forward: bool, moved: bool) {
        self.shift(!is_forward, moved);
    }

    /// Another lash: the flank that is engaged stays so.
    pub const fn set_lash(&mut self, lash: u16) {
        let is_positive = self.ahead == self.lash;
        self.lash = lash;
        if is_positive || self.ahead > lash {
            self.ahead = lash;
        }
    }
}
