//! Events to the levels of the motors' drivers: the last stage before the pins.

use husillo_stepper::{CoilDriver, Levels, PulseTiming};

use crate::pulses::Pulses;

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
///
/// What a step event is at the pins is theirs: one change of levels for coils; for step and
/// direction drivers DIR, the rising edge at the step's time, and the falling edge, with the times
/// of each driver ([`CoilDriver::timing`]).
///
/// ```
/// use husillo_machine::{Idle, Motors};
/// use husillo_stepper::{Levels, PulseNanoseconds, StepDirection};
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
    /// Where a step is more than one change of levels.
    pulses: Option<Pulses<N>>,
}

impl<const N: usize, D: CoilDriver> Motors<N, D> {
    /// Enabled motors, holding the phase their drivers start with.
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

    /// A step event: calls `present` with the levels to show at each change, and the ticks since
    /// the last one.
    ///
    /// One call for coils, up to `2 N + 1` for step and direction drivers. The step itself is the
    /// last one. It comes `wait_ticks` after the last event, or where a driver is not ready by then
    /// as soon as it is; later steps make up for it.
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
            // Which axes step is anybody's guess on an arc: a step by 0 is cheaper than a branch.
            *levels = driver.step(*delta);
        }
        present(wait_ticks, &self.levels);
    }

    /// A time without a step: the last pulses end, and at its end the idle policy acts. Calls
    /// `present` as [`step`](Motors::step) does.
    pub fn rest<F: FnMut(u32, &[Levels; N])>(&mut self, wait_ticks: u32, mut present: F) {
        self.rested_ticks = self.rested_ticks.saturating_add(wait_ticks.into());
        let mut left = wait_ticks;
        if let (true, Some(pulses)) = (D::HAS_PULSES, &mut self.pulses) {
            let mut before = None;
            let (drivers, levels) = (&mut self.drivers, &mut self.levels);
            pulses.run(drivers, levels, wait_ticks, &[0; N], |ticks, levels| {
                // The last one is this rest's own, below.
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

    /// The pulses that are under way end: at the end of a program, before nothing comes any more.
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

    /// The shortest time between two steps of an axis that its driver takes, in ticks; 0 for coils.
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
