//! accel-stepper, polled once in a microsecond of simulated time. The time of the polls without a
//! step is part of its cost, because it has no other way to run.

use core::cell::Cell;
use core::time::Duration;

use accel_stepper::{Driver, SystemClock, func_device};

use crate::Job;

struct Clock<'a>(&'a Cell<u64>);

impl SystemClock for Clock<'_> {
    fn elapsed(&self) -> Duration {
        Duration::from_micros(self.0.get())
    }
}

pub fn run(job: &Job, step: &mut dyn FnMut(f64)) {
    let now = Cell::new(1);
    let mut driver = Driver::new();
    driver.set_max_speed(job.top_rate_hz as f32);
    driver.set_acceleration(job.acceleration_hz_per_s as f32);
    driver.move_to(job.steps.into());
    let step = core::cell::RefCell::new(step);
    let made = || step.borrow_mut()(now.get() as f64 / 1e6);
    let mut device = func_device(made, made);
    while driver.is_running() && now.get() < 10_000_000 {
        driver.poll(&mut device, Clock(&now)).expect("no error");
        now.set(now.get() + 1);
    }
}
