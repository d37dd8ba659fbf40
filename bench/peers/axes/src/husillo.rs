//! `StepperAxis` on an A4988.

use husillo_machine::stepper::{Levels, PulseNanoseconds, StepDirection};
use husillo_machine::{AccelerationLimits, AxisLimits, JerkLimits, StepperAxis};

use crate::Job;

const TIMER_HZ: u32 = 1_000_000;

pub fn straight(job: &Job, step: &mut dyn FnMut(f64)) {
    let limits = AccelerationLimits {
        timer_hz: TIMER_HZ,
        top_rate_hz: job.top_rate_hz,
        acceleration_hz_per_s: job.acceleration_hz_per_s,
    };
    run(limits, job, step);
}

pub fn smooth(job: &Job, step: &mut dyn FnMut(f64)) {
    let limits = JerkLimits {
        timer_hz: TIMER_HZ,
        top_rate_hz: job.top_rate_hz,
        acceleration_hz_per_s: job.acceleration_hz_per_s,
        jerk_hz_per_s2: 10 * job.acceleration_hz_per_s,
    };
    run(limits, job, step);
}

fn run(limits: impl AxisLimits, job: &Job, step: &mut dyn FnMut(f64)) {
    let driver = StepDirection::new(PulseNanoseconds::A4988.ticks(TIMER_HZ));
    let mut axis = StepperAxis::new(driver, limits).expect("limits within range");
    axis.move_to(job.steps.cast_signed());
    let mut now = 0_u64;
    while let Some(change) = axis.next_change() {
        now += u64::from(change.ticks);
        if change.levels.contains(Levels::STEP) {
            step(now as f64 / 1e6);
        }
    }
}
