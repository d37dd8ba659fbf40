//! Text: words, checked blocks, commands. One element is one line.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput};
use husillo_gcode::{Block, Dialect, Modal, words};

const BYTES: usize = 50_000;

pub fn bench(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gcode");
    let dialect = Dialect::RS274;
    let programs = [
        ("seg", husillo_bench::segments(BYTES)),
        ("arc", husillo_bench::arcs(BYTES)),
        ("mix", husillo_bench::mixed(BYTES)),
    ];
    for (name, program) in &programs {
        let lines: Vec<&[u8]> = program.lines().map(str::as_bytes).collect();
        group.throughput(Throughput::Elements(lines.len() as u64));
        group.bench_with_input(BenchmarkId::new("words", name), &lines, |bencher, lines| {
            bencher.iter(|| {
                for line in lines {
                    assert!(words(line).all(|word| black_box(word).is_ok()));
                }
            });
        });
        group.bench_with_input(
            BenchmarkId::new("blocks", name),
            &lines,
            |bencher, lines| {
                bencher.iter(|| {
                    for line in lines {
                        assert!(black_box(Block::parse(line, &dialect)).is_ok());
                    }
                });
            },
        );
        group.bench_with_input(
            BenchmarkId::new("commands", name),
            &lines,
            |bencher, lines| {
                bencher.iter(|| {
                    let mut modal = Modal::<3>::new(dialect);
                    for line in lines {
                        let block = Block::parse(line, &dialect).expect("a correct block");
                        let (next, commands) = modal.plan(&block).expect("a correct program");
                        commands.for_each(|command| {
                            black_box(command);
                        });
                        modal = next;
                    }
                });
            },
        );
    }
    group.finish();
}
