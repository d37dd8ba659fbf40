//! Benchmarks of the speed profiles and the constant-speed timer. One element is one interval.

use std::{hint::black_box, time::Duration};

use criterion::{BenchmarkGroup, Criterion, Throughput, measurement::WallTime};
use husillo_planner::{Rates, Recurrence, SCurve, Timer, Trapezoid};

const EVENTS: u32 = 10_000;

/// From standstill to standstill; the top rate is never reached.
const RAMP: Rates = Rates {
    timer_hz: 1_000_000,
    start_rate_hz: 0,
    top_rate_hz: 50_000,
    end_rate_hz: 0,
    acceleration_hz_per_s: 100_000,
};

/// At the top rate throughout.
const LEVEL: Rates = Rates {
    start_rate_hz: 50_000,
    end_rate_hz: 50_000,
    ..RAMP
};

const JERK_HZ_PER_S2: u32 = 1_000_000;

fn walk(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    profile: &(impl Iterator<Item = u32> + Clone),
) {
    group.throughput(Throughput::Elements(EVENTS.into()));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            for ticks in black_box(profile.clone()) {
                black_box(ticks);
            }
        });
    });
}

fn profiles(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("profile");
    let fits = "rates within range";
    for (name, rates) in [("trapezoid_ramp", &RAMP), ("trapezoid_level", &LEVEL)] {
        walk(
            &mut group,
            name,
            &Trapezoid::new(rates, EVENTS).expect(fits),
        );
    }
    for (name, rates) in [("recurrence_ramp", &RAMP), ("recurrence_level", &LEVEL)] {
        walk(
            &mut group,
            name,
            &Recurrence::new(rates, EVENTS).expect(fits),
        );
    }
    let curve = SCurve::new(&RAMP, JERK_HZ_PER_S2, EVENTS).expect(fits);
    walk(&mut group, "s_curve", &curve);
    group.throughput(Throughput::Elements(1));
    group.bench_function("trapezoid_set_up", |bencher| {
        bencher.iter(|| Trapezoid::new(black_box(&RAMP), EVENTS));
    });
    group.bench_function("s_curve_set_up", |bencher| {
        bencher.iter(|| SCurve::new(black_box(&RAMP), JERK_HZ_PER_S2, EVENTS));
    });
    group.finish();
}

fn timer(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("timer");
    group.throughput(Throughput::Elements(EVENTS.into()));
    let timer = Timer::new(123_456_789, u64::from(EVENTS) << 20, 1 << 21);
    group.bench_function("wait", |bencher| {
        bencher.iter(|| {
            let mut timer = black_box(timer.clone());
            for event in 0..EVENTS {
                black_box(timer.wait(1_000_000 + event));
            }
        });
    });
    group.throughput(Throughput::Elements(1));
    group.bench_function("set_up", |bencher| {
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

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1))
        .configure_from_args();
    profiles(&mut criterion);
    timer(&mut criterion);
    criterion.final_summary();
}
