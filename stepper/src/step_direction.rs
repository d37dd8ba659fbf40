//! Step and direction pulses with their times.

use crate::Levels;

/// The times a step and direction drive asks for, in timer ticks.
///
/// ```text
///            set-up    high     low
///  DIR  ─────╲_________________________________╱──────
///  STEP ____________╱───────╲__________________
///                   │<──── hold (from the rising edge) ──>│ before DIR may change
/// ```
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PulseTiming {
    /// DIR stable before STEP rises.
    pub setup_ticks: u32,
    /// DIR stable after STEP has risen.
    pub hold_ticks: u32,
    /// STEP high; at least 1 is used.
    pub high_ticks: u32,
    /// STEP low after the pulse; at least 1 is used.
    pub low_ticks: u32,
}

/// Levels to put on the pins now, and how long they stay.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Present {
    /// STEP, DIR and ENABLE.
    pub levels: Levels,
    /// Timer ticks until [`StepDirection::advance`] is to be called.
    pub ticks: u32,
}

#[derive(Copy, Clone, Eq, PartialEq, Debug)]
enum State {
    Idle,
    Hold,
    SetUp,
    High,
    Low,
}

/// One step at a time as a pulse; it owns neither pins nor timer.
///
/// ```
/// use husillo_stepper::{Levels, PulseTiming, StepDirection};
///
/// let mut pulse = StepDirection::new(PulseTiming { setup_ticks: 5, hold_ticks: 2, high_ticks: 3, low_ticks: 4 });
/// let mut present = pulse.start(-1);
/// let mut seen = Vec::new();
/// while let Some(now) = present {
///     seen.push((now.levels.contains(Levels::STEP), now.ticks));
///     present = pulse.advance();
/// }
/// assert_eq!(seen, [(false, 5), (true, 3), (false, 4)]); // DIR turned: set-up first
/// assert!(pulse.is_idle());
/// ```
#[derive(Copy, Clone, Debug)]
pub struct StepDirection {
    timing: PulseTiming,
    state: State,
    /// DIR as it is on the pin.
    forward: bool,
    /// DIR as the step under way wants it.
    wanted: bool,
    enabled: bool,
}

impl StepDirection {
    /// Idle and enabled, STEP low, DIR high (positive).
    #[must_use]
    pub const fn new(timing: PulseTiming) -> StepDirection {
        StepDirection {
            timing,
            state: State::Idle,
            forward: true,
            wanted: true,
            enabled: true,
        }
    }

    /// Begins one step in the direction of the sign of `delta`.
    ///
    /// `None` when there is nothing to do: a step is still under way, `delta` is 0, or the drive is disabled. How long
    /// it has been idle is not known here, so a change of direction waits the rest of the hold time every time.
    pub fn start(&mut self, delta: i8) -> Option<Present> {
        if self.state != State::Idle || delta == 0 || !self.enabled {
            return None;
        }
        self.wanted = delta > 0;
        if self.wanted == self.forward {
            return Some(self.rise());
        }
        if self.rest_of_hold() > 0 {
            self.state = State::Hold;
            return Some(self.present(self.rest_of_hold()));
        }
        Some(self.turn())
    }

    /// The next levels of the step under way, after the ticks of the last ones; `None` when the step is complete.
    pub fn advance(&mut self) -> Option<Present> {
        match self.state {
            State::Idle => None,
            State::Hold => Some(self.turn()),
            State::SetUp => Some(self.rise()),
            State::High => {
                self.state = State::Low;
                Some(self.present(self.timing.low_ticks.max(1)))
            }
            State::Low => {
                self.state = State::Idle;
                None
            }
        }
    }

    /// Whether a step may be started.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.state == State::Idle
    }

    /// The levels now.
    #[must_use]
    pub fn levels(&self) -> Levels {
        let mut bits = 0;
        if self.state == State::High {
            bits |= Levels::STEP.0;
        }
        if self.forward {
            bits |= Levels::DIR.0;
        }
        if self.enabled {
            bits |= Levels::ENABLE.0;
        }
        Levels(bits)
    }

    /// Drives ENABLE. A pulse under way is completed, so that the drive counts what was started.
    pub fn set_enabled(&mut self, on: bool) -> Levels {
        self.enabled = on;
        self.levels()
    }

    /// The longest time one step takes, in ticks: the shortest safe step interval when the direction turns.
    #[must_use]
    pub fn longest_step_ticks(&self) -> u32 {
        let pulse = self
            .timing
            .high_ticks
            .max(1)
            .saturating_add(self.timing.low_ticks.max(1));
        pulse
            .saturating_add(self.rest_of_hold())
            .saturating_add(self.timing.setup_ticks)
    }

    /// What is left of the hold time when a step has been completed.
    fn rest_of_hold(&self) -> u32 {
        let since_rise = self
            .timing
            .high_ticks
            .max(1)
            .saturating_add(self.timing.low_ticks.max(1));
        self.timing.hold_ticks.saturating_sub(since_rise)
    }

    fn turn(&mut self) -> Present {
        self.forward = self.wanted;
        if self.timing.setup_ticks == 0 {
            return self.rise();
        }
        self.state = State::SetUp;
        self.present(self.timing.setup_ticks)
    }

    fn rise(&mut self) -> Present {
        self.state = State::High;
        self.present(self.timing.high_ticks.max(1))
    }

    fn present(&self, ticks: u32) -> Present {
        Present {
            levels: self.levels(),
            ticks,
        }
    }
}
