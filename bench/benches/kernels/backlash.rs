//! The take-up stage on three axes. One element is one event.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use husillo_backlash::{Backlash, Compensator, Flank};

const EVENTS: i32 = 10_000;

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("backlash");
    group.throughput(Throughput::Elements(EVENTS as u64));
    let axes = [1457, 1271, 0].map(|backlash_steps| Backlash::new(backlash_steps, Flank::Positive));
    for (name, period) in [("straight_on", EVENTS), ("reversal_every_10_events", 10)] {
        group.bench_function(name, |bencher| {
            let mut stage = Compensator::new(axes);
            bencher.iter(|| {
                for event in 0..EVENTS {
                    let x = if event / period % 2 == 0 { 1 } else { -1 };
                    black_box(stage.before(black_box(&[x, 1, 0]), [event, event, 0]));
                }
            });
        });
    }
    group.finish();
}
