//! The whole chain from a line of text to step events. One element is one event.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use husillo_gcode::Dialect;
use husillo_machine::{Axis, Config, Equipment, Event, Machine, Scale};

/// A micro mill without limits.
pub fn micromill() -> Machine<3> {
    let scale = Scale::new(140, 1).expect("140 nm a step");
    let axis = |backlash_steps| Axis {
        scale,
        travel: None,
        max_rate_hz: 170,
        backlash_steps,
        ramp: None,
    };
    Machine::new(Config {
        axes: [axis(1457), axis(1271), axis(0)],
        timer_hz: 1_000_000,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: None,
        equipment: Equipment::NONE,
        spindle_counts: None,
    })
}

/// Runs all events of a program; each line must be accepted.
pub fn run(machine: &mut Machine<3>, program: &[&str], mut each: impl FnMut(Event<3>)) {
    for line in program {
        machine.line(line.as_bytes()).expect("a correct line");
        while let Some(event) = machine.next_event() {
            each(event);
        }
    }
}

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("machine");
    let short = husillo_bench::segments(2000);
    let programs: [(&str, Vec<&str>); 3] = [
        ("lines", vec!["G1 X10 Y3 F1.4", "G1 X0 Y0"]),
        ("circle", vec!["G3 X0 Y0 I-1.5 F1.4"]),
        ("short_segments", short.lines().collect()),
    ];
    for (name, program) in &programs {
        let mut events = 0_u64;
        run(&mut micromill(), program, |_| events += 1);
        group.throughput(Throughput::Elements(events));
        group.bench_function(*name, |bencher| {
            bencher.iter(|| {
                run(&mut micromill(), program, |event| {
                    black_box(event);
                });
            });
        });
    }
    group.finish();
}
