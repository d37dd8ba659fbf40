//! Coil sequences. One element is one step.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use husillo_stepper::{CoilDriver, Driver, Microstep, Mode, Sequencer};

const STEPS: u64 = 10_000;

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stepper");
    group.throughput(Throughput::Elements(STEPS));
    group.bench_function("sequencer_half_steps", |bencher| {
        let mut motor =
            Sequencer::new(Driver::A3988, Mode::Half).expect("the A3988 makes half steps");
        bencher.iter(|| {
            for _ in 0..STEPS {
                black_box(motor.step(black_box(1)));
            }
        });
    });
    group.bench_function("microsteps_64", |bencher| {
        let mut motor = Microstep::<64>::new();
        bencher.iter(|| {
            for _ in 0..STEPS {
                black_box(motor.step(black_box(1)));
            }
        });
    });
    group.finish();
}
