//! Events of lines, arcs and helices. An element is an event.

use std::hint::black_box;

use criterion::{BenchmarkGroup, Criterion, Throughput, measurement::WallTime};
use husillo_interp::{Arc, ArcMove, Direction, Helix, Line, Rim, Step};

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("interp");
    walk(&mut group, "line3", &Line::new([100_000, -50_000, 7]));
    walk(
        &mut group,
        "line6",
        &Line::new([100_000, -50_000, 7, 33_333, 0, 99_999]),
    );
    let circle = ArcMove {
        from: [10_000, 0],
        to: [10_000, 0],
        centre: [0, 0],
        fraction_bits: 16,
        direction: Direction::CounterClockwise,
        turns: 0,
        rim: Rim::Spiral,
    };
    let narrow = Arc::new(&circle).expect("a circle");
    let wide = Arc::wide(&circle).expect("a circle");
    let helix = Helix::new(&circle, [0, 1], [0, 0, 5000]).expect("a helix");
    walk(&mut group, "arc_i32", &narrow);
    walk(&mut group, "arc_i64", &wide);
    walk::<Helix<3>>(&mut group, "helix", &helix);
    group.throughput(Throughput::Elements(1));
    group.bench_function("arc_setup_quarter_of_1000_steps", |bencher| {
        let quarter = ArcMove {
            from: [1000, 0],
            to: [0, 1000],
            ..circle
        };
        bencher.iter(|| Arc::new(black_box(&quarter)));
    });
    group.finish();
}

fn walk<I>(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, path: &I)
where
    I: Iterator<Item = Step> + Clone,
{
    group.throughput(Throughput::Elements(path.clone().count() as u64));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            for step in black_box(path.clone()) {
                black_box(step);
            }
        });
    });
}
