//! An axis whose nut has play on its screw.

/// Motor and load of one axis in steps.
///
/// The load is between `motor - lash` (its positive flank engaged) and `motor` (the negative one), so a step knows by itself whether it
/// moves the load: a task may be cut short anywhere, in the middle of a take-up too.
#[derive(Copy, Clone, Debug)]
pub(super) struct Play {
    lash: u16,
    /// Motor steps ahead of the load, 0 to `lash`.
    ahead: u16,
    load: i32,
}

impl Play {
    /// At zero, the positive flank engaged.
    pub(super) const fn new(lash: u16) -> Self {
        Self {
            lash,
            ahead: lash,
            load: 0,
        }
    }

    /// Whether a step that way moves the motor only.
    pub(super) const fn owes(&self, direction: i8) -> bool {
        match direction {
            1 => self.ahead < self.lash,
            -1 => self.ahead > 0,
            _ => false,
        }
    }

    /// A motor step, or none for 0.
    pub(super) const fn step(&mut self, direction: i8) {
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

    /// The load is at zero here.
    pub(super) const fn set_zero(&mut self) {
        self.load = 0;
    }

    /// Load steps from zero.
    pub(super) const fn load(self) -> i32 {
        self.load
    }
}
