//! Step and direction pulses with their times.

use crate::{CoilDriver, Levels, PulseTiming};

/// Levels for the pins, and their duration.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Present {
    /// STEP, DIR and ENABLE.
    pub levels: Levels,
    /// Timer ticks until the call of [`StepDirection::advance`].
    pub ticks: u32,
}

#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
enum State {
    Idle,
    Hold,
    SetUp,
    High,
    Low,
}

/// A step was requested before the previous one was complete.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Busy;

impl core::fmt::Display for Busy {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the previous step is not complete")
    }
}

impl core::error::Error for Busy {}

/// A step and direction driver that takes a step on each rising edge of STEP, as most chips do. DIR
/// is high for positive steps. It owns neither pins nor timer.
///
/// For one motor with a timer of its own, [`start`](StepDirection::start) and
/// [`advance`](StepDirection::advance) return the levels and their durations. For several motors on
/// one stream of events, it is a [`CoilDriver`], and the machine keeps the times of
/// [`timing`](CoilDriver::timing).
///
/// # Examples
/// ```
/// use husillo_stepper::{Levels, PulseTiming, StepDirection};
///
/// let mut pulse = StepDirection::new(
///     PulseTiming { setup_ticks: 5, hold_ticks: 2, high_ticks: 3, low_ticks: 4 }
/// );
/// let mut present = pulse.start(-1)?;
/// let mut seen = Vec::new();
/// while let Some(now) = present {
///     seen.push((now.levels.contains(Levels::STEP), now.ticks));
///     present = pulse.advance();
/// }
/// assert_eq!(seen, [(false, 5), (true, 3), (false, 4)]); // DIR turned: set-up first
/// assert!(pulse.is_idle());
/// # Ok::<(), husillo_stepper::Busy>(())
/// ```
#[derive(Copy, Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StepDirection {
    timing: PulseTiming,
    state: State,
    /// The level of DIR on the pin.
    forward: bool,
    /// The level of DIR for the present step.
    wanted: bool,
    enabled: bool,
}

impl StepDirection {
    /// Creates an idle, enabled driver with STEP low and DIR high (positive).
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

    /// Begins one step in the direction of the sign of `delta`. Returns `None` if there is nothing
    /// to do, because `delta` is 0 or the driver is disabled.
    ///
    /// The function does not know how long the driver was idle. So every change of direction waits
    /// for the rest of the hold time.
    ///
    /// # Errors
    /// [`Busy`]: the previous step is not complete. Nothing changes.
    pub fn start(&mut self, delta: i8) -> Result<Option<Present>, Busy> {
        if self.state != State::Idle {
            return Err(Busy);
        }
        if delta == 0 || !self.enabled {
            return Ok(None);
        }
        self.wanted = delta > 0;
        Ok(Some(if self.wanted == self.forward {
            self.rise()
        } else if self.rest_of_hold() > 0 {
            self.state = State::Hold;
            self.present(self.rest_of_hold())
        } else {
            self.turn_now()
        }))
    }

    /// Returns the next levels of the present step. Call it after the ticks of the previous ones.
    /// Returns `None` if the step is complete.
    pub fn advance(&mut self) -> Option<Present> {
        match self.state {
            State::Idle => None,
            State::Hold => Some(self.turn_now()),
            State::SetUp => Some(self.rise()),
            State::High => {
                self.state = State::Low;
                Some(self.present(self.timing.low()))
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

    /// Returns the longest time of one step, in ticks. It is the shortest safe step interval when
    /// the direction reverses.
    #[must_use]
    pub fn longest_step_ticks(&self) -> u32 {
        let pulse = self.timing.high().saturating_add(self.timing.low());
        pulse
            .saturating_add(self.rest_of_hold())
            .saturating_add(self.timing.setup_ticks)
    }

    /// Returns the rest of the hold time after a complete step.
    fn rest_of_hold(&self) -> u32 {
        let since_rise = self.timing.high().saturating_add(self.timing.low());
        self.timing.hold_ticks.saturating_sub(since_rise)
    }

    fn turn_now(&mut self) -> Present {
        self.forward = self.wanted;
        if self.timing.setup_ticks == 0 {
            return self.rise();
        }
        self.state = State::SetUp;
        self.present(self.timing.setup_ticks)
    }

    fn rise(&mut self) -> Present {
        self.state = State::High;
        self.present(self.timing.high())
    }

    fn present(&self, ticks: u32) -> Present {
        Present {
            levels: self.levels(),
            ticks,
        }
    }
}

impl CoilDriver for StepDirection {
    const HAS_PULSES: bool = true;

    #[inline]
    fn turn(&mut self, delta: i8) -> Levels {
        if delta != 0 && self.enabled {
            self.wanted = delta > 0;
            self.forward = self.wanted;
        }
        self.levels()
    }

    /// Raises STEP. No other step begins until [`end_pulse`](CoilDriver::end_pulse) lowers it.
    #[inline]
    fn step(&mut self, delta: i8) -> Levels {
        if delta != 0 && self.enabled {
            self.wanted = delta > 0;
            self.forward = self.wanted;
            self.state = State::High;
        }
        self.levels()
    }

    #[inline]
    fn end_pulse(&mut self) -> Levels {
        self.state = State::Idle;
        self.levels()
    }

    fn timing(&self) -> Option<PulseTiming> {
        Some(self.timing)
    }

    fn levels(&self) -> Levels {
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

    /// Drives ENABLE. A pulse that has begun is completed, so that the driver counts it.
    fn set_enabled(&mut self, on: bool) -> Levels {
        self.enabled = on;
        self.levels()
    }
}
