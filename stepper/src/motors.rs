//! Conversion of events to driver levels: the last stage before the pins.

use crate::pulses::Pulses;
use crate::{CoilDriver, Levels, PulseTiming};

/// State of the motors at rest.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Default)]
pub enum Idle {
    /// Keeps the current on.
    #[default]
    Hold,
    /// Reduces the current after this many timer ticks of rest, where the driver can. The next step
    /// has full current.
    Reduced {
        /// Timer ticks since the last step.
        after_ticks: u64,
    },
    /// Turns all currents off after this many timer ticks of rest. The next step first restores the
    /// held phase.
    Off {
        /// Timer ticks since the last step.
        after_ticks: u64,
    },
}

/// The motors of a machine, with one driver per axis.
///
/// The drivers determine the levels of a step event. For coils it is one change of levels. For step
/// and direction drivers it is DIR, the rising edge at the time of the step, and the falling edge,
/// with the times of each driver ([`CoilDriver::timing`]).
///
/// # Examples
/// ```
/// use husillo_stepper::{Idle, Levels, Motors, PulseNanoseconds, StepDirection};
///
/// let driver = StepDirection::new(PulseNanoseconds::A4988.ticks(10_000_000)); // ticks of 100 ns
/// let mut motors = Motors::new([driver], Idle::Hold);
/// let mut pins = Vec::new();
/// for delta in [1, 1, -1] {
///     motors.step(500, &[delta], |ticks, [levels]| pins.push((ticks, levels.0 & 0b11)));
/// }
/// assert_eq!(pins, [
///     (500, 0b11), // STEP rises, DIR is high
///     (10, 0b10), // and falls 1 us later
///     (490, 0b11), // the second step, 50 us after the first one
///     (2, 0b01), // DIR turns as soon as the hold time allows
///     (8, 0b00),
///     (490, 0b01), // the third step
/// ]);
/// ```
#[derive(Copy, Clone, Debug)]
pub struct Motors<const N: usize, D> {
    drivers: [D; N],
    levels: [Levels; N],
    idle: Idle,
    rested_ticks: u64,
    is_resting: bool,
    was_released: bool,
    /// Pulses in progress; `None` where a step is one change of levels.
    pulses: Option<Pulses<N>>,
}

impl<const N: usize, D: CoilDriver> Motors<N, D> {
    /// Creates enabled motors that hold the initial phase of their drivers.
    pub fn new(drivers: [D; N], idle: Idle) -> Self {
        Self {
            levels: drivers.each_ref().map(CoilDriver::levels),
            pulses: if D::HAS_PULSES {
                Pulses::of(&drivers)
            } else {
                None
            },
            drivers,
            idle,
            rested_ticks: 0,
            is_resting: false,
            was_released: false,
        }
    }

    /// Makes a step event: calls `present` at each change with the ticks since the last change and
    /// the levels.
    ///
    /// There is one call for coils and up to `2 N + 1` calls for step and direction drivers. The
    /// last one is the step. It comes `wait_ticks` after the last event. If a driver is not ready
    /// then, the step comes as soon as it is, and later steps catch up.
    #[inline]
    pub fn step<F: FnMut(u32, &[Levels; N])>(
        &mut self,
        wait_ticks: u32,
        delta: &[i8; N],
        mut present: F,
    ) {
        if self.is_resting {
            self.wake();
            // A driver needs time to wake before its first pulse.
            if self.pulses.is_some() {
                present(0, &self.levels);
            }
        }
        self.rested_ticks = 0;
        if let (true, Some(pulses)) = (D::HAS_PULSES, &mut self.pulses) {
            return pulses.run(
                &mut self.drivers,
                &mut self.levels,
                wait_ticks,
                delta,
                present,
            );
        }
        for ((driver, levels), delta) in self.drivers.iter_mut().zip(&mut self.levels).zip(delta) {
            // On an arc it is unpredictable which axes step, so a step by 0 is cheaper than a
            // branch.
            *levels = driver.step(*delta);
        }
        present(wait_ticks, &self.levels);
    }

    /// Waits without a step. Pulses in progress end, and at the end the idle policy acts. Calls
    /// `present` as [`step`](Motors::step) does.
    pub fn rest<F: FnMut(u32, &[Levels; N])>(&mut self, wait_ticks: u32, mut present: F) {
        self.rested_ticks = self.rested_ticks.saturating_add(wait_ticks.into());
        let mut left = wait_ticks;
        if let (true, Some(pulses)) = (D::HAS_PULSES, &mut self.pulses) {
            let mut before = None;
            let (drivers, levels) = (&mut self.drivers, &mut self.levels);
            pulses.run(drivers, levels, wait_ticks, &[0; N], |ticks, levels| {
                // The last change is that of this rest, below.
                if let Some((ticks, levels)) = before.replace((ticks, *levels)) {
                    present(ticks, &levels);
                }
            });
            left = before.map_or(0, |(ticks, _)| ticks);
        }
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
        present(left, &self.levels);
    }

    /// Ends the pulses in progress, at the end of a program.
    pub fn end_pulses<F: FnMut(u32, &[Levels; N])>(&mut self, mut present: F) {
        if let Some(pulses) = &mut self.pulses {
            if let Some(ticks) = pulses.last_fall() {
                pulses.run(
                    &mut self.drivers,
                    &mut self.levels,
                    ticks,
                    &[0; N],
                    &mut present,
                );
            }
        }
    }

    /// Shortest interval between two steps of an axis that its driver allows, in ticks; 0 for
    /// coils.
    pub fn shortest_interval_ticks(&self, axis: usize) -> u32 {
        let driver = self.drivers.get(axis).and_then(CoilDriver::timing);
        driver.map_or(0, PulseTiming::shortest_interval_ticks)
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

    /// Turns the currents of all motors off, or on in the last held phase.
    pub fn set_enabled(&mut self, on: bool) {
        self.is_resting = !on;
        self.was_released |= !on;
        self.update(|driver| driver.set_enabled(on));
    }

    /// The present levels.
    pub fn levels(&self) -> &[Levels; N] {
        &self.levels
    }

    /// Whether the motors were without current since the last call. A hand or a load may then have
    /// turned them by whole electrical cycles unnoticed. Home the machine, unless this is known to
    /// be impossible.
    pub fn was_released(&mut self) -> bool {
        core::mem::take(&mut self.was_released)
    }
}
