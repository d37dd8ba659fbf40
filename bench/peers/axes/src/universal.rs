//! stepper, with the default profile of ramp-maker in `f64` and a timer that adds up its waits.

use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use std::rc::Rc;

use fugit::{TimerDurationU32, TimerInstantU32};
use stepper::embedded_hal::digital::{ErrorType, blocking::OutputPin};
use stepper::motion_control::DelayToTicks;
use stepper::ramp_maker::Trapezoidal;
use stepper::{Direction, Stepper, drivers::drv8825::DRV8825};

use crate::Job;

const TIMER_HZ: u32 = 1_000_000;

/// STEP: notes the time of its rising edges.
struct Step(Rc<Cell<u64>>, Rc<RefCell<Vec<u64>>>);

impl ErrorType for Step {
    type Error = Infallible;
}

impl OutputPin for Step {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.1.borrow_mut().push(self.0.get());
        Ok(())
    }
}

struct Dir;

impl ErrorType for Dir {
    type Error = Infallible;
}

impl OutputPin for Dir {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

struct Timer(Rc<Cell<u64>>);

impl fugit_timer::Timer<TIMER_HZ> for Timer {
    type Error = Infallible;

    fn now(&mut self) -> TimerInstantU32<TIMER_HZ> {
        TimerInstantU32::from_ticks(self.0.get() as u32)
    }

    fn start(&mut self, duration: TimerDurationU32<TIMER_HZ>) -> Result<(), Infallible> {
        self.0.set(self.0.get() + u64::from(duration.ticks()));
        Ok(())
    }

    fn cancel(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn wait(&mut self) -> nb::Result<(), Infallible> {
        Ok(())
    }
}

/// Ticks are the unit of its delays.
struct Ticks;

impl DelayToTicks<f64, TIMER_HZ> for Ticks {
    type Error = Infallible;

    fn delay_to_ticks(&self, delay: f64) -> Result<TimerDurationU32<TIMER_HZ>, Infallible> {
        Ok(TimerDurationU32::from_ticks(delay as u32))
    }
}

pub fn run(job: &Job, step: &mut dyn FnMut(f64)) {
    let now = Rc::new(Cell::new(0));
    let edges = Rc::new(RefCell::new(Vec::with_capacity(job.steps as usize + 8)));
    let hz = f64::from(TIMER_HZ);
    let profile = Trapezoidal::new(f64::from(job.acceleration_hz_per_s) / hz / hz);
    let mut timer = Timer(now.clone());
    let driver = Stepper::from_driver(DRV8825::new())
        .enable_direction_control(Dir, Direction::Forward, &mut timer)
        .unwrap_or_else(|_| panic!("the pins have no errors"))
        .enable_step_control(Step(now.clone(), edges.clone()));
    let mut stepper = driver.enable_motion_control((timer, profile, Ticks));
    let top = f64::from(job.top_rate_hz) / hz;
    let mut motion = stepper.move_to_position(top, job.steps.cast_signed());
    let _ = motion.wait();
    for edge in edges.borrow().iter() {
        step(*edge as f64 / 1e6);
    }
}
