//! Benchmarks of every method on moves of about ten thousand events: lines between opposite corners
//! of a box, whole circles, curves. One element is one event; set-up is measured separately. The
//! measuring times are short: all benchmarks together take less than a minute.

use std::{hint::black_box, time::Duration};

use criterion::{BenchmarkGroup, Criterion, Throughput, measurement::WallTime};
use husillo_interp::{
    Arc, ArcDda, ArcMove, Bezier, Conic, DirectSearch, DirectSearchPrinted, Direction, EllipseMove,
    Helix, Line, LineDda, LineDdaExact, Rim, Staircase, Step, TimedDirectSearch,
};

const DELTA: [i32; 6] = [10_000, -5_000, 7, 3_333, 0, 9_999];

const CIRCLE: ArcMove = ArcMove {
    from: [2_000, 0],
    to: [2_000, 0],
    centre: [0, 0],
    fraction_bits: 0,
    direction: Direction::CounterClockwise,
    turns: 0,
    rim: Rim::Spiral,
};

type Group<'a> = BenchmarkGroup<'a, WallTime>;

fn walk(group: &mut Group<'_>, name: &str, path: &(impl Iterator<Item = Step> + Clone)) {
    group.throughput(Throughput::Elements(path.clone().count() as u64));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            for step in black_box(path.clone()) {
                black_box((step.axes, step.negative));
            }
        });
    });
}

fn lines(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("line");
    let [x, y, z, ..] = DELTA;
    walk(&mut group, "two_axes", &Line::new([x, y]));
    walk(&mut group, "three_axes", &Line::new([x, y, z]));
    walk(&mut group, "six_axes", &Line::new(DELTA));
    let long_enough = "a line with steps";
    let dda = LineDda::new([x, y]).expect(long_enough);
    walk(&mut group, "dda_two_axes", &dda);
    let dda = LineDda::new([x, y, z]).expect(long_enough);
    walk(&mut group, "dda_three_axes", &dda);
    let printed = LineDda::printed([x, y]).expect(long_enough);
    walk(&mut group, "dda_printed_two_axes", &printed);
    let exact = LineDdaExact::new([x, y]).expect(long_enough);
    walk(&mut group, "dda_exact_two_axes", &exact);
    group.throughput(Throughput::Elements(1));
    group.bench_function("set_up_three_axes", |bencher| {
        bencher.iter(|| Line::new(black_box([x, y, z])));
    });
    group.finish();
}

fn arcs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("arc");
    let circle = "a circle";
    let search = DirectSearch::new(&CIRCLE).expect(circle);
    walk(&mut group, "direct_search", &search);
    let timed = TimedDirectSearch::new(search, 10_000);
    group.bench_function("direct_search_timed", |bencher| {
        bencher.iter(|| {
            for event in black_box(timed.clone()) {
                black_box((event.step.axes, event.step.negative, event.wait_ticks));
            }
        });
    });
    let printed = DirectSearchPrinted::new(&CIRCLE).expect(circle);
    walk(&mut group, "direct_search_printed", &printed);
    let between = ArcMove {
        fraction_bits: 16,
        ..CIRCLE
    };
    let narrow = Arc::new(&between).expect(circle);
    walk(&mut group, "general_32_bits", &narrow);
    let wide = Arc::wide(&between).expect(circle);
    walk(&mut group, "general_64_bits", &wide);
    let staircase = Staircase::new(&CIRCLE).expect(circle);
    walk(&mut group, "staircase", &staircase);
    let printed = Staircase::printed(&CIRCLE).expect(circle);
    walk(&mut group, "staircase_printed", &printed);
    let dda = ArcDda::new(&CIRCLE).expect(circle);
    walk(&mut group, "dda", &dda);
    let printed = ArcDda::printed(&CIRCLE).expect(circle);
    walk(&mut group, "dda_printed", &printed);
    group.throughput(Throughput::Elements(1));
    let quarter = ArcMove {
        to: [0, 2_000],
        ..between
    };
    group.bench_function("set_up_general_quarter", |bencher| {
        bencher.iter(|| Arc::new(black_box(&quarter)));
    });
    let quarter = ArcMove {
        to: [0, 2_000],
        ..CIRCLE
    };
    group.bench_function("set_up_direct_search_quarter", |bencher| {
        bencher.iter(|| DirectSearch::new(black_box(&quarter)));
    });
    group.finish();
}

fn curves(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("curve");
    let helix = Helix::<3>::new(&CIRCLE, [0, 1], [0, 0, 1_000]).expect("a helix");
    walk(&mut group, "helix_three_axes", &helix);
    let ellipse = EllipseMove {
        from: [2_000, 0],
        to: [2_000, 0],
        centre: [0, 0],
        semi_axes: [2_000, 1_200],
        fraction_bits: 0,
        direction: Direction::CounterClockwise,
        turns: 0,
    };
    let ellipse = Conic::ellipse(&ellipse).expect("an ellipse");
    walk(&mut group, "ellipse", &ellipse);
    let control = [[0, 0], [2_000, 6_000], [6_000, -2_000], [8_000, 4_000]];
    let bezier = Bezier::cubic(control, 0).expect("a curve");
    walk(&mut group, "bezier_two_axes", &bezier);
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1))
        .configure_from_args();
    lines(&mut criterion);
    arcs(&mut criterion);
    curves(&mut criterion);
    criterion.final_summary();
}
