//! Look-ahead benchmarks: one million moves of 20 um through the queue, and the events of the ramp.
//! One criterion element is one move or one event.

use std::{f64::consts::TAU, hint::black_box, time::Duration};

use criterion::{Criterion, Throughput};
use husillo_planner::{Junction, Limits, LookAhead, Ramp, Stretch, Tangent};

const MOVES: usize = 1_000_000;
const SPEEDS: [u32; 3] = [100_000_000; 3];
const ACCELERATIONS: [u64; 3] = [500_000_000; 3];
const JUNCTION: Junction<3> = Junction {
    jump_nm_per_s: Some([10_000_000; 3]),
    deviation_nm: Some(10_000),
    acceleration_nm_per_s2: ACCELERATIONS,
};

/// Chords of 20 um on circles of 3.2 mm radius, with a corner every few chords.
fn chords() -> Vec<[i64; 3]> {
    (0..MOVES)
        .map(|number| {
            let corner = (number / 700) as f64;
            let angle = number as f64 * TAU / 1000.0 + corner;
            [
                (20_000.0 * angle.cos()) as i64,
                (20_000.0 * angle.sin()) as i64,
                (number % 3) as i64,
            ]
        })
        .collect()
}

/// The work of a machine for one line, from the end point to the queue entry.
fn stretch(way: &[i64; 3], last: &mut Option<Tangent<3>>) -> Option<Stretch> {
    let direction = Tangent::new(*way)?;
    let ceiling = direction.speed_limit(&SPEEDS);
    let entry_limit_nm_per_s = match &*last {
        Some(last) => JUNCTION.speed(last, &direction),
        None => 0,
    };
    *last = Some(direction);
    let squared: i64 = way.iter().map(|part| part * part).sum();
    Some(Stretch {
        length_nm: (squared as u64).isqrt(),
        top_nm_per_s: 50_000_000.min(ceiling),
        ceiling_nm_per_s: ceiling,
        obeys_override: true,
        acceleration_nm_per_s2: direction.acceleration_limit(&ACCELERATIONS),
        start_nm_per_s: 0,
        upper: None,
        entry_limit_nm_per_s,
    })
}

fn look_ahead(criterion: &mut Criterion) {
    let chords = chords();
    let stretches: Vec<Stretch> = {
        let mut last = None;
        chords
            .iter()
            .filter_map(|way| stretch(way, &mut last))
            .collect()
    };
    let mut group = criterion.benchmark_group("look_ahead");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(5));
    group.throughput(Throughput::Elements(MOVES as u64));
    // Braking from 50 mm/s takes 2.5 mm and the queue holds 0.64 mm, so the whole queue is always a
    // braking ramp.
    group.bench_function("million_moves_with_junctions", |bencher| {
        bencher.iter(|| {
            let mut queue = LookAhead::<u32, 32>::new();
            let mut last = None;
            for way in &chords {
                if queue.is_full() {
                    black_box(queue.limits());
                    queue.pop();
                }
                if let Some(stretch) = stretch(black_box(way), &mut last) {
                    let _ = queue.push(stretch, 0);
                }
            }
            queue
        });
    });
    group.bench_function("million_moves_queue_alone", |bencher| {
        bencher.iter(|| {
            let mut queue = LookAhead::<u32, 32>::new();
            for stretch in &stretches {
                if queue.is_full() {
                    black_box(queue.limits());
                    queue.pop();
                }
                let _ = queue.push(*black_box(stretch), 0);
            }
            queue
        });
    });
    group.finish();
}

const EVENTS: u32 = 100_000;

fn ramp(criterion: &mut Criterion) {
    let line = Stretch {
        length_nm: 100_000_000,
        top_nm_per_s: 100_000_000,
        ceiling_nm_per_s: 100_000_000,
        obeys_override: true,
        acceleration_nm_per_s2: 100_000_000,
        start_nm_per_s: 0,
        upper: None,
        entry_limit_nm_per_s: 0,
    };
    let mut group = criterion.benchmark_group("ramp");
    group.throughput(Throughput::Elements(EVENTS.into()));
    // 50 mm of acceleration, 50 mm of deceleration.
    group.bench_function("event_speeding_up_or_down", |bencher| {
        bencher.iter(|| {
            let mut ramp = Ramp::new(1_000_000);
            ramp.begin(&line, EVENTS.into(), 1, 1_000_000 << 16);
            let limits = black_box(Limits {
                top_nm_per_s: 100_000_000,
                exit_squared: 0,
                version: 0,
            });
            for _ in 0..EVENTS {
                black_box(ramp.wait(black_box(1), &limits));
            }
        });
    });
    group.bench_function("event_at_constant_speed", |bencher| {
        let cruising = Stretch {
            start_nm_per_s: 100_000_000,
            upper: None,
            ..line
        };
        bencher.iter(|| {
            let mut ramp = Ramp::new(1_000_000);
            ramp.begin(&cruising, EVENTS.into(), 1, 1_000_000 << 16);
            let limits = black_box(Limits {
                top_nm_per_s: 100_000_000,
                exit_squared: u64::MAX,
                version: 0,
            });
            for _ in 0..EVENTS {
                black_box(ramp.wait(black_box(1), &limits));
            }
        });
    });
    group.throughput(Throughput::Elements(1));
    group.bench_function("begin_and_first_event", |bencher| {
        let short = Stretch {
            length_nm: 20_000,
            ..line
        };
        let mut ramp = Ramp::new(1_000_000);
        let limits = Limits {
            top_nm_per_s: 100_000_000,
            exit_squared: 0,
            version: 0,
        };
        bencher.iter(|| {
            ramp.begin(black_box(&short), black_box(143), 1, 200 << 16);
            ramp.wait(black_box(1), &limits)
        });
    });
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    look_ahead(&mut criterion);
    ramp(&mut criterion);
    criterion.final_summary();
}
