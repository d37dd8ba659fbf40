//! Coil currents of the motors during their first steps.

use crate::machines::machine_file::MachineFile;
use crate::programs::setup;
use crate::simulation::observer::{Now, Observer};
use husillo_stepper::{Driver, Levels};
use std::io;

/// Coil currents of one motor.
#[derive(Debug)]
pub struct Motor {
    /// Letter of its axis.
    pub letter: char,
    /// Name of the driver and mode.
    pub driver: String,
    /// Names of the two rows.
    pub rows: [&'static str; 2],
    /// Time in microseconds, and the currents of coil A and B after each step, 1000 = 100 %.
    pub steps: Vec<(u64, [i16; 2])>,
}

/// Steps of each motor that are kept.
const MOST_STEPS: usize = 24;
/// Step events after which nothing more is kept. It bounds the work if a motor never turns.
const MOST_EVENTS: u64 = 100_000;

/// Time in microseconds, and the currents of both coils after it.
type Phase = (u64, [i16; 2]);

/// Currents of the first steps.
#[derive(Debug)]
pub struct Phases {
    /// The coil driver of each axis; `None` for step and direction.
    drivers: [Option<Driver>; 3],
    timer_hz: u32,
    phases: [Vec<Phase>; 3],
    is_open: bool,
}

impl Phases {
    /// Motors at rest at these levels.
    pub fn new(machine: &MachineFile, levels: &[Levels; 3]) -> Self {
        let drivers = machine
            .axes
            .each_ref()
            .map(|axis| setup::driver(axis.driver));
        let at_rest = |axis: usize| vec![(0, currents(drivers[axis], levels[axis]))];
        Self {
            drivers,
            timer_hz: machine.timer_hz,
            phases: [0, 1, 2].map(at_rest),
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
        for axis in 0..3 {
            let phases = &mut self.phases[axis];
            if now.step.delta[axis] != 0 && phases.len() <= MOST_STEPS {
                if let [at_rest] = phases.as_mut_slice() {
                    at_rest.0 = before;
                }
                phases.push((micros, currents(self.drivers[axis], now.levels[axis])));
            }
        }
        self.is_open =
            now.event < MOST_EVENTS && self.phases.iter().any(|phases| phases.len() <= MOST_STEPS);
    }

    /// The first steps of the motors, for the report.
    pub fn motors(&self, machine: &MachineFile) -> Vec<Motor> {
        let axes = machine.axes.iter().zip(&self.phases).zip(self.drivers);
        axes.map(|((axis, steps), driver)| Motor {
            letter: char::from(axis.letter),
            driver: format!("{:?}, {:?}", axis.driver, axis.mode).to_lowercase(),
            rows: match driver {
                Some(_) => ["coil A", "coil B"],
                None => ["STEP", "DIR"],
            },
            steps: steps.clone(),
        })
        .collect()
    }
}

/// Currents of both coils. Step and direction are drawn as two rows of levels.
fn currents(driver: Option<Driver>, levels: Levels) -> [i16; 2] {
    match driver {
        Some(driver) => driver.currents(levels),
        None => [0, 1].map(|bit| if levels.is_high(bit) { 1000 } else { 0 }),
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
    use crate::simulation::observer::tests::now;

    #[test]
    fn only_the_first_steps_of_an_axis_are_kept() {
        let machine = MachineFile::load("router").unwrap();
        let mut phases = Phases::new(&machine, &[Levels(0); 3]);
        for event in 3..100 {
            let seen = Now {
                levels: &[Levels(0b01); 3],
                ..now(event)
            };
            phases.step(&seen).unwrap();
        }
        let [x, y, _] = &phases.motors(&machine)[..] else {
            panic!("three motors")
        };
        assert_eq!((x.letter, x.rows), ('X', ["STEP", "DIR"]));
        assert_eq!((x.steps.len(), y.steps.len()), (MOST_STEPS + 1, 1));
        // X rested until the wait of its first step began.
        let tick = 1e6 / f64::from(machine.timer_hz);
        assert_eq!(x.steps[0], ((2000.0 * tick) as u64, [0, 0]));
        assert_eq!(x.steps[1], ((3000.0 * tick) as u64, [1000, 0]));
    }
}
