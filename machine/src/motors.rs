//! Events to the levels of the motors' drivers: the last stage before the pins.

use husillo_stepper::{CoilDriver, Levels};

/// What the motors do when nothing moves.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Default)]
pub enum Idle {
    /// Keep the current on.
    #[default]
    Hold,
    /// Reduce the current after this many timer ticks of rest, where the driver can; the next step has all of it.
    Reduced {
        /// Timer ticks from the last step.
        after_ticks: u64,
    },
    /// Turn all currents off after this many timer ticks of rest. The next step first restores the
    /// phase that was held.
    Off {
        /// Timer ticks from the last step.
        after_ticks: u64,
    },
}

/// The motors of a machine, one driver an axis.
#[derive(Copy, Clone, Debug)]
pub struct Motors<const N: usize, D> {
    drivers: [D; N],
    levels: [Levels; N],
    idle: Idle,
    rested_ticks: u64,
    is_resting: bool,
    was_released: bool,
}

impl<const N: usize, D: CoilDriver> Motors<N, D> {
    /// Enabled motors, holding the phase their drivers start with.
    pub fn new(drivers: [D; N], idle: Idle) -> Self {
        Self {
            levels: drivers.each_ref().map(CoilDriver::levels),
            drivers,
            idle,
            rested_ticks: 0,
            is_resting: false,
            was_released: false,
        }
    }

    /// The levels after one step event.
    #[inline]
    pub fn step(&mut self, delta: &[i8; N]) -> &[Levels; N] {
        if self.is_resting {
            self.wake();
        }
        self.rested_ticks = 0;
        for ((driver, levels), delta) in self.drivers.iter_mut().zip(&mut self.levels).zip(delta) {
            // Which axes step is anybody's guess on an arc: a step by 0 is cheaper than a branch.
            *levels = driver.step(*delta);
        }
        &self.levels
    }

    /// The levels after a time without a step: the idle policy acts here.
    pub fn rest(&mut self, ticks: u64) -> &[Levels; N] {
        self.rested_ticks = self.rested_ticks.saturating_add(ticks);
        match self.idle {
            _ if self.is_resting => {}
            Idle::Off { after_ticks } if self.rested_ticks >= after_ticks => {
                self.set_enabled(false);
            }
            Idle::Reduced { after_ticks } if self.rested_ticks >= after_ticks => {
                self.is_resting = true;
                self.update(|driver| driver.set_reduced(true));
            }
            _ => {}
        }
        &self.levels
    }

    #[cold]
    fn wake(&mut self) {
        self.update(|driver| driver.set_reduced(false));
        self.set_enabled(true);
    }

    fn update(&mut self, change: impl Fn(&mut D) -> Levels) {
        for (driver, levels) in self.drivers.iter_mut().zip(&mut self.levels) {
            *levels = change(driver);
        }
    }

    /// Turns the currents of all motors off, or on in the phase that was held last.
    pub fn set_enabled(&mut self, on: bool) {
        self.is_resting = !on;
        self.was_released |= !on;
        self.update(|driver| driver.set_enabled(on));
    }

    /// The levels now.
    pub fn levels(&self) -> &[Levels; N] {
        &self.levels
    }

    /// Whether the motors were without current since the last call: a hand or a load may have turned
    /// them, by a whole electrical cycle unnoticed. Home the machine, or know that it cannot happen.
    pub fn was_released(&mut self) -> bool {
        core::mem::take(&mut self.was_released)
    }
}
