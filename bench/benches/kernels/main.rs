//! Benchmarks that cross crates, one group each. (The methods of `interp` and `planner` have their
//! own benchmarks.) The measuring times are short: all benchmarks together take less than a minute.
#![allow(missing_docs)] // criterion_group! makes undocumented public items

mod backlash;
mod gcode;
mod machine;
mod sim;
mod stepper;

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};

fn quick() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(1000))
}

criterion_group! {
    name = kernels;
    config = quick();
    targets = gcode::bench, stepper::bench, backlash::bench, machine::bench, sim::bench
}
criterion_main!(kernels);
