//! The changes of levels that make a step of one driver.

use husillo_stepper::{CoilDriver, Levels, PulseTiming};

/// Levels of the driver, and the wait before them.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Change {
    /// Ticks since the change before; from rest, since the call.
    pub ticks: u32,
    /// The levels to write then.
    pub levels: Levels,
}

/// The state of the pulse.
#[derive(Copy, Clone, Debug)]
pub(super) struct Pulse {
    /// `None` if a step is one change of levels.
    timing: Option<PulseTiming>,
    next: Next,
    /// The direction on the pin; 0 before the first step.
    delta: i8,
    /// Ticks since the last step that its successor's interval contains.
    passed: u32,
    is_standing: bool,
}

/// What comes before the next step of the profile.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
enum Next {
    Nothing,
    /// The set-up time has begun.
    Rise,
    /// STEP is high.
    Fall,
}

impl Pulse {
    pub(super) const fn new(timing: Option<PulseTiming>) -> Pulse {
        Pulse {
            timing,
            next: Next::Nothing,
            delta: 0,
            passed: 0,
            is_standing: true,
        }
    }

    /// The next change of a step that has begun.
    #[inline]
    pub(super) fn rest<D: CoilDriver>(&mut self, driver: &mut D) -> Option<Change> {
        let timing = self.timing?;
        match self.next {
            Next::Nothing => None,
            Next::Rise => {
                self.next = Next::Fall;
                Some(Change {
                    ticks: timing.setup_ticks,
                    levels: driver.step(self.delta),
                })
            }
            Next::Fall => {
                self.next = Next::Nothing;
                self.passed = timing.high();
                Some(Change {
                    ticks: timing.high(),
                    levels: driver.end_pulse(),
                })
            }
        }
    }

    /// Begins a step that is due `ticks` after the one before; from rest, after now.
    #[inline]
    pub(super) fn begin<D: CoilDriver>(&mut self, driver: &mut D, ticks: u32, delta: i8) -> Change {
        let Some(timing) = self.timing else {
            return Change {
                ticks,
                levels: driver.step(delta),
            };
        };
        let from_rest = core::mem::take(&mut self.is_standing);
        let left = if from_rest {
            ticks
        } else {
            ticks.saturating_sub(self.passed)
        };
        if delta == self.delta {
            self.next = Next::Fall;
            return Change {
                ticks: left.max(timing.low()),
                levels: driver.step(delta),
            };
        }
        self.delta = delta;
        self.next = Next::Rise;
        // DIR holds its level after the rising edge. STEP stays low for its time as well.
        let hold = timing
            .hold_ticks
            .max(timing.high().saturating_add(timing.low()));
        Change {
            ticks: left
                .saturating_sub(timing.setup_ticks)
                .max(hold.saturating_sub(timing.high())),
            levels: driver.turn(delta),
        }
    }

    /// Whether a step was begun whose rising edge is not to come any more.
    pub(super) fn take_back(&mut self) -> bool {
        let is_begun = self.next == Next::Rise;
        if is_begun {
            self.next = Next::Nothing;
        }
        is_begun
    }

    /// The profile has ended.
    #[inline]
    pub(super) fn stand(&mut self) {
        self.is_standing = true;
    }
}
