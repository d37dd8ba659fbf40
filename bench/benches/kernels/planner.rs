//! Waits of the constant-speed timer. An element is a wait.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use husillo_planner::Timer;

const WAITS: u64 = 10_000;

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("planner");
    group.throughput(Throughput::Elements(WAITS));
    group.bench_function("timer_wait", |bencher| {
        let timer = Timer::new(123_456_789, WAITS << 20, 1 << 21);
        bencher.iter(|| {
            let mut timer = black_box(timer.clone());
            for event in 0..WAITS {
                black_box(timer.wait(1_000_000 + event));
            }
        });
    });
    group.throughput(Throughput::Elements(1));
    group.bench_function("timer_setup", |bencher| {
        bencher.iter(|| {
            Timer::new(
                black_box(123_456_789),
                black_box(987_654_321),
                black_box(1 << 20),
            )
        });
    });
    group.finish();
}
