//! One stepping axis without lines: a goal in, levels of the driver with their times out.

#[cfg(any(feature = "embedded-hal", feature = "embedded-hal-async"))]
mod delays;
mod limits;
mod profile;
mod pulse;
mod units;

use core::fmt;

use husillo_planner::RatesError;
use husillo_stepper::{CoilDriver, Levels};

pub use limits::{AccelerationLimits, AxisLimits, JerkLimits};
pub use profile::AxisProfile;
pub use pulse::Change;
use pulse::Pulse;
pub use units::{StepUnits, UnitsError};

/// A motor with its speed profile: it is sent to positions, runs at a rate, and stops.
///
/// The axis owns no pin and no clock. [`next_change`](StepperAxis::next_change) returns the levels
/// of the driver and the ticks to wait before they are written. A timer interrupt calls it, or a
/// loop, or a task.
///
/// - **Limits.** No step comes faster than the top rate and no rate changes faster than the
///   acceleration allows, whatever is requested and whenever. With [`JerkLimits`] the jerk is
///   limited too. Only [`halt`](StepperAxis::halt) stops without a ramp.
/// - **Ends.** Every move ends at exactly its goal, at standstill. A new goal in the present
///   direction continues at the present rate. Where it is too near or behind, the axis brakes,
///   and returns.
/// - **Positions** are in steps. [`StepUnits`] converts them to millimetres or degrees.
/// - **Pulses.** With a step and direction driver, STEP rises at the time of the step. DIR
///   changes its set-up time before, and STEP falls its high time later.
///
/// # Cost
/// A change takes one step of the profile; see [`Trapezoid`](husillo_planner::Trapezoid) and
/// [`SCurve`](husillo_planner::SCurve). The start of a move makes a profile, also the start of
/// the way back within `next_change`. The README has the instructions.
///
/// # Examples
/// ```
/// use husillo_machine::{AccelerationLimits, StepperAxis};
/// use husillo_stepper::{Driver, Mode, Sequencer};
///
/// let limits = AccelerationLimits {
///     timer_hz: 1_000_000,
///     top_rate_hz: 2_000,
///     acceleration_hz_per_s: 10_000,
/// };
/// let motor = Sequencer::new(Driver::L297, Mode::Half)?;
/// let mut axis = StepperAxis::new(motor, limits)?;
/// axis.move_to(1_000);
/// let mut ticks = 0;
/// while let Some(change) = axis.next_change() {
///     ticks += change.ticks; // wait, then write `change.levels` to the pins
///     if axis.position() == 500 {
///         axis.move_to(-1_000); // brakes, and returns
///     }
/// }
/// assert_eq!(axis.position(), -1_000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct StepperAxis<D, L: AxisLimits = AccelerationLimits> {
    driver: D,
    limits: L,
    /// The motion that is executed; `None` at rest.
    profile: Option<L::Profile>,
    goal: Goal,
    position: i32,
    is_forward: bool,
    is_enabled: bool,
    /// Highest rate of moves.
    move_rate_hz: u32,
    pulse: Pulse,
    /// The change that a delay waits for.
    #[cfg(any(feature = "embedded-hal", feature = "embedded-hal-async"))]
    due: Option<Change>,
}

/// What the axis is to do.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
enum Goal {
    /// Stand at a position.
    Position(i32),
    /// Run on.
    Run { is_forward: bool, rate_hz: u32 },
}

/// Why an axis cannot run at a rate.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StepperAxisError {
    /// The limits do not suit the arithmetic of the profile.
    Rates(RatesError),
    /// The rate is above the top rate of the limits.
    AboveLimit,
    /// At the top rate, steps follow each other faster than the pulses of the driver allow.
    DriverTooSlow,
}

impl From<RatesError> for StepperAxisError {
    fn from(error: RatesError) -> Self {
        StepperAxisError::Rates(error)
    }
}

impl fmt::Display for StepperAxisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StepperAxisError::Rates(error) => error.fmt(f),
            StepperAxisError::AboveLimit => f.write_str("the rate is above the top rate"),
            StepperAxisError::DriverTooSlow => {
                f.write_str("the pulses of the driver are too long for the top rate")
            }
        }
    }
}

impl core::error::Error for StepperAxisError {}

impl<D: CoilDriver, L: AxisLimits> StepperAxis<D, L> {
    /// Creates an axis at rest, at position 0.
    ///
    /// # Errors
    /// [`StepperAxisError::Rates`] and [`StepperAxisError::DriverTooSlow`].
    pub fn new(driver: D, limits: L) -> Result<Self, StepperAxisError> {
        let _ = limits.profile(limits.top_rate_hz(), 1)?;
        let timing = driver.timing();
        // An interval is up to two ticks shorter than that of the top rate.
        let shortest = limits.timer_hz().checked_div(limits.top_rate_hz());
        let needed = timing.map_or(0, |timing| {
            timing.shortest_interval_ticks().saturating_add(2)
        });
        if shortest.unwrap_or(0) < needed {
            return Err(StepperAxisError::DriverTooSlow);
        }
        Ok(StepperAxis {
            pulse: Pulse::new(timing),
            driver,
            move_rate_hz: limits.top_rate_hz(),
            limits,
            profile: None,
            goal: Goal::Position(0),
            position: 0,
            is_forward: true,
            is_enabled: true,
            #[cfg(any(feature = "embedded-hal", feature = "embedded-hal-async"))]
            due: None,
        })
    }

    /// Moves to a position, from rest or during any motion, at the rate of
    /// [`set_rate`](StepperAxis::set_rate).
    pub fn move_to(&mut self, position: i32) {
        self.goal = Goal::Position(position);
        self.redirect();
    }

    /// Moves by a number of steps from the present position. The goal saturates.
    pub fn move_by(&mut self, steps: i32) {
        self.move_to(self.position.saturating_add(steps));
    }

    /// Runs at a rate until another command; a negative rate runs backwards, and 0 is
    /// [`stop`](StepperAxis::stop). The position wraps at the ends of `i32`.
    ///
    /// # Errors
    /// [`StepperAxisError::AboveLimit`] and [`StepperAxisError::Rates`]; the motion is then
    /// unchanged.
    pub fn run(&mut self, rate_hz: i32) -> Result<(), StepperAxisError> {
        if rate_hz == 0 {
            self.stop();
            return Ok(());
        }
        self.check(rate_hz.unsigned_abs())?;
        self.goal = Goal::Run {
            is_forward: rate_hz > 0,
            rate_hz: rate_hz.unsigned_abs(),
        };
        self.redirect();
        Ok(())
    }

    /// Sets the highest rate of moves, also of the one that is executed. It is the top rate of the
    /// limits until then.
    ///
    /// # Errors
    /// Those of [`run`](StepperAxis::run); the rate is then unchanged.
    pub fn set_rate(&mut self, rate_hz: u32) -> Result<(), StepperAxisError> {
        self.check(rate_hz)?;
        self.move_rate_hz = rate_hz;
        self.redirect();
        Ok(())
    }

    /// Brakes to standstill. The goal becomes the position where the axis will stand.
    pub fn stop(&mut self) {
        let ahead = self.profile.as_mut().map_or(0, L::Profile::stop);
        self.goal = Goal::Position(self.ahead(ahead));
    }

    /// Stops without a ramp: no step begins after the change that was last returned and the rest
    /// of its pulse. A motor at a high rate may lose its position.
    pub fn halt(&mut self) {
        self.profile = None;
        self.goal = Goal::Position(self.position);
    }

    /// Returns the next change of levels and the ticks to wait before it, or `None` at rest. Then
    /// call it again after the next command.
    ///
    /// The position includes the step of the returned change.
    #[inline]
    pub fn next_change(&mut self) -> Option<Change> {
        if let Some(change) = self.pulse.rest(&mut self.driver) {
            return Some(change);
        }
        let Some(ticks) = self.next_interval() else {
            self.pulse.stand();
            return None;
        };
        let delta = if self.is_forward { 1 } else { -1 };
        Some(self.pulse.begin(&mut self.driver, ticks, delta))
    }

    /// Switches the current of the motor off or on. Off stops without a ramp; commands are then
    /// executed when the current is on again. Call it when the last change has been written.
    /// Returns the levels to write.
    pub fn set_enabled(&mut self, on: bool) -> Levels {
        if !on {
            self.halt();
            if self.pulse.take_back() {
                self.position = self.ahead(1_u32.wrapping_neg());
                self.goal = Goal::Position(self.position);
            }
        }
        self.is_enabled = on;
        self.driver.set_enabled(on)
    }

    /// Gives the present position another number, at rest or in motion. The way that is left stays
    /// the same.
    pub fn set_position(&mut self, position: i32) {
        if let Goal::Position(goal) = &mut self.goal {
            *goal = goal.wrapping_sub(self.position).wrapping_add(position);
        }
        self.position = position;
    }

    /// The position in steps.
    pub const fn position(&self) -> i32 {
        self.position
    }

    /// The position where the axis will stand; `None` if it runs on.
    pub const fn goal(&self) -> Option<i32> {
        match self.goal {
            Goal::Position(position) => Some(position),
            Goal::Run { .. } => None,
        }
    }

    /// Whether steps are to come.
    pub fn is_moving(&self) -> bool {
        self.profile.as_ref().is_some_and(|p| p.steps_left() != 0)
            || self.goal != Goal::Position(self.position)
    }

    /// The present rate in Hz, rounded towards 0; negative backwards.
    pub fn rate_hz(&self) -> i32 {
        let rate = self.profile.as_ref().map_or(0, AxisProfile::rate_hz);
        let rate = rate.min(i32::MAX.unsigned_abs()).cast_signed();
        if self.is_forward {
            rate
        } else {
            rate.wrapping_neg()
        }
    }

    /// The present levels of the driver.
    pub fn levels(&self) -> Levels {
        self.driver.levels()
    }

    /// The limits.
    pub const fn limits(&self) -> &L {
        &self.limits
    }

    fn check(&self, rate_hz: u32) -> Result<(), StepperAxisError> {
        if rate_hz > self.limits.top_rate_hz() {
            return Err(StepperAxisError::AboveLimit);
        }
        let _ = self.limits.profile(rate_hz, 1)?;
        Ok(())
    }

    /// The position after this many steps in the present direction.
    const fn ahead(&self, steps: u32) -> i32 {
        let steps = steps.cast_signed();
        if self.is_forward {
            self.position.wrapping_add(steps)
        } else {
            self.position.wrapping_sub(steps)
        }
    }

    /// Direction, steps and highest rate of the way to the goal.
    const fn way(&self) -> (bool, u32, u32) {
        match self.goal {
            Goal::Position(goal) => {
                let is_forward = goal >= self.position;
                (is_forward, goal.abs_diff(self.position), self.move_rate_hz)
            }
            Goal::Run {
                is_forward,
                rate_hz,
            } => (is_forward, u32::MAX, rate_hz),
        }
    }

    /// Continues the motion towards the goal, or brakes where that is not possible.
    fn redirect(&mut self) {
        let (is_forward, steps, rate_hz) = self.way();
        let Some(profile) = &mut self.profile else {
            return;
        };
        let is_ahead = is_forward == self.is_forward && steps != 0;
        if !is_ahead || !profile.set_remaining(steps) {
            profile.stop();
        }
        profile.set_top_rate(rate_hz);
    }

    /// Takes a step of the profile, and returns its ticks.
    #[inline]
    fn next_interval(&mut self) -> Option<u32> {
        let next = self.profile.as_mut().and_then(Iterator::next);
        let ticks = match next {
            Some(ticks) => ticks,
            None => self.begin()?,
        };
        self.position = self.ahead(1);
        if let Goal::Run { is_forward, .. } = self.goal {
            self.run_on(is_forward);
        }
        Some(ticks)
    }

    /// Begins the way to the goal, at standstill.
    #[inline(never)]
    fn begin(&mut self) -> Option<u32> {
        self.profile = None;
        let (is_forward, steps, rate_hz) = self.way();
        if steps == 0 || !self.is_enabled {
            return None;
        }
        self.is_forward = is_forward;
        // The limits were checked with this rate.
        self.profile = self.limits.profile(rate_hz, steps).ok();
        self.profile.as_mut()?.next()
    }

    /// Keeps the end of a run out of reach.
    #[inline]
    fn run_on(&mut self, is_forward: bool) {
        if let Some(profile) = &mut self.profile {
            if is_forward == self.is_forward && profile.steps_left() < 1 << 31 {
                profile.set_remaining(u32::MAX);
            }
        }
    }
}
