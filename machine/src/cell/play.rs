//! An axis whose nut has play on its screw.

/// Motor and load of one axis in steps.
///
/// The load is between `motor - lash` (its positive flank engaged) and `motor` (the negative one), so a step knows by itself whether it
/// moves the load: a task may be cut short anywhere, in the middle of a take-up too.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Play {
    lash: u16,
    /// Motor steps ahead of the load, 0 to `lash`.
    ahead: u16,
    load: i32,
}

impl Play {
    /// At zero, the positive flank engaged.
    pub(crate) const fn new(lash: u16) -> Self {
        Self {
            lash,
            ahead: lash,
            load: 0,
        }
    }

    /// Whether a step that way moves the motor only.
    pub(crate) const fn owes(&self, direction: i8) -> bool {
        match direction {
            1 => self.ahead < self.lash,
            -1 => self.ahead > 0,
            _ => false,
        }
    }

    /// A motor step, or none for 0.
    pub(crate) const fn step(&mut self, direction: i8) {
        if !self.owes(direction) {
            // Of 2^32 steps, at 100 a second, none in a year.
            self.load = self.load.wrapping_add(direction as i32);
        } else if direction > 0 {
            // Below the lash.
            self.ahead = self.ahead.wrapping_add(1);
        } else {
            // Above zero.
            self.ahead = self.ahead.wrapping_sub(1);
        }
    }

    /// Another lash: the flank that is engaged stays so.
    pub(crate) const fn set_lash(&mut self, lash: u16) {
        let is_positive = self.ahead == self.lash;
        self.lash = lash;
        if is_positive || self.ahead > lash {
            self.ahead = lash;
        }
    }

    /// The negative flank is engaged here.
    pub(crate) const fn set_behind(&mut self) {
        self.ahead = 0;
    }

    /// The load is at zero here.
    pub(crate) const fn set_zero(&mut self) {
        self.load = 0;
    }

    /// Load steps from zero.
    pub(crate) const fn load(self) -> i32 {
        self.load
    }
}
