//! Coil currents of the motors during their first steps.

use crate::observers::{AXES, Now, Observer};
use husillo_stepper::{Driver, Levels};
use std::io;

/// Coil currents of one motor.
#[derive(Clone, Debug)]
pub struct Motor {
    /// Letter of its axis.
    pub letter: char,
    /// Name of the driver and mode.
    pub driver: String,
    /// Names of the two rows.
    pub rows: [&'static str; 2],
    /// Time in microseconds, and the currents of coil A and B after each step, 1000 = 100 %.
    pub steps: Vec<(u64, [i16; 2])>,
    coils: Option<Driver>,
}

impl Motor {
    /// A motor that has not turned. `coils` is the driver of its coils; `None` for step and
    /// direction.
    pub const fn new(letter: char, driver: String, coils: Option<Driver>) -> Self {
        Self {
            letter,
            driver,
            rows: match coils {
                Some(_) => ["coil A", "coil B"],
                None => ["STEP", "DIR"],
            },
            steps: Vec::new(),
            coils,
        }
    }

    /// Currents of both coils. Step and direction are drawn as two rows of levels.
    fn currents(&self, levels: Levels) -> [i16; 2] {
        match self.coils {
            Some(driver) => driver.currents(levels),
            None => [0, 1].map(|bit| if levels.is_high(bit) { 1000 } else { 0 }),
        }
    }
}

/// Steps of each motor that are kept.
const MOST_STEPS: usize = 24;
/// Step events after which nothing more is kept. It bounds the work if a motor never turns.
const MOST_EVENTS: u64 = 100_000;

/// Currents of the first steps.
#[derive(Clone, Debug)]
pub struct Phases {
    motors: Vec<Motor>,
    timer_hz: u32,
    is_open: bool,
}

impl Phases {
    /// Motors at rest at these levels.
    pub fn new(mut motors: Vec<Motor>, timer_hz: u32, levels: &[Levels; AXES]) -> Self {
        for (motor, levels) in motors.iter_mut().zip(levels) {
            motor.steps = vec![(0, motor.currents(*levels))];
        }
        Self {
            motors,
            timer_hz,
            is_open: true,
        }
    }

    fn micros(&self, ticks: u64) -> u64 {
        ticks.saturating_mul(1_000_000) / u64::from(self.timer_hz)
    }

    #[cold]
    fn keep(&mut self, now: &Now<'_>) {
        let micros = self.micros(now.ticks);
        let before = micros.saturating_sub(self.micros(now.step.wait_ticks.into()));
        let moved = now.step.delta.iter().zip(now.levels);
        for (motor, (delta, levels)) in self.motors.iter_mut().zip(moved) {
            if *delta != 0 && motor.steps.len() <= MOST_STEPS {
                if let [at_rest] = motor.steps.as_mut_slice() {
                    at_rest.0 = before;
                }
                motor.steps.push((micros, motor.currents(*levels)));
            }
        }
        let is_open = |motor: &Motor| motor.steps.len() <= MOST_STEPS;
        self.is_open = now.event < MOST_EVENTS && self.motors.iter().any(is_open);
    }

    /// The first steps of the motors, for the report.
    pub fn motors(&self) -> &[Motor] {
        &self.motors
    }
}

impl Observer for Phases {
    #[inline]
    fn step(&mut self, now: &Now<'_>) -> io::Result<()> {
        if self.is_open {
            self.keep(now);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observers::tests::now;

    #[test]
    fn only_the_first_steps_of_an_axis_are_kept() {
        let motors = ['X', 'Y', 'Z'].map(|letter| Motor::new(letter, "step".into(), None));
        let mut phases = Phases::new(motors.into(), 500_000, &[Levels(0); AXES]);
        for event in 3..100 {
            let seen = Now {
                levels: &[Levels(0b01); AXES],
                ..now(event)
            };
            phases.step(&seen).unwrap();
        }
        let [x, y, _] = phases.motors() else {
            panic!("three motors")
        };
        assert_eq!((x.letter, x.rows), ('X', ["STEP", "DIR"]));
        assert_eq!((x.steps.len(), y.steps.len()), (MOST_STEPS + 1, 1));
        // X rested until the wait of its first step began. A tick is 2 us.
        assert_eq!(x.steps[0], (4000, [0, 0]));
        assert_eq!(x.steps[1], (6000, [1000, 0]));
    }
}
