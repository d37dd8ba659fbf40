//! Converts a drill file of 5000 holes to the records of the circuit-board drill, as
//! `husillo compile` does: the program from its start to the output files.
#![allow(missing_docs)] // criterion_group! makes undocumented public items

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};

/// Number of holes of the board.
const HOLES: u64 = 5000;

/// The path of the program. It is built first, optimised as the benchmark is.
fn program() -> PathBuf {
    let bench = std::env::current_exe().expect("it runs");
    // target/PROFILE/deps/board-HASH
    let folder = bench.ancestors().nth(2).expect("two folders up");
    let target = folder
        .parent()
        .expect("the folder of the profile is in another one");
    let mut build = Command::new(env!("CARGO"));
    build
        .args(["build", "-q", "-p", "husillo-host", "--target-dir"])
        .arg(target)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."));
    if folder.ends_with("release") {
        build.arg("--release");
    }
    assert!(
        build.status().is_ok_and(|status| status.success()),
        "husillo is built"
    );
    folder.join(format!("husillo{}", std::env::consts::EXE_SUFFIX))
}

/// Holes scattered over the table of the drill, 220 x 45 mm.
fn drill_file() -> String {
    let mut state = 5_u64;
    let mut below = |limit: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % limit
    };
    let mut text = String::from("M48\nMETRIC,TZ\nT1C0.8\n%\nT1\n");
    for _ in 0..HOLES {
        let (x, y) = (below(220_000), below(45_000));
        let place = |um: u64| format!("{}.{:03}", um / 1000, um % 1000);
        writeln!(text, "X{}Y{}", place(x), place(y)).expect("a string takes it");
    }
    text + "M30\n"
}

fn compile(criterion: &mut Criterion) {
    let folder = std::env::temp_dir().join(format!("husillo-board-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the files");
    let (file, records) = (folder.join("board.drl"), folder.join("board.cod"));
    std::fs::write(&file, drill_file()).expect("the board is written");
    let program = program();
    let mut group = criterion.benchmark_group("compile");
    for order in ["file", "shortest"] {
        group.bench_function(format!("5000 holes, order {order}"), |bencher| {
            bencher.iter(|| {
                let mut command = Command::new(&program);
                command.args(["compile", "-m", "drill", "--order", order, "-o"]);
                let status = command
                    .arg(&records)
                    .arg(&file)
                    .stdout(Stdio::null())
                    .status();
                assert!(status.is_ok_and(|status| status.success()), "it compiles");
            });
        });
    }
    group.finish();
    // The output is not needed any more.
    let _ = std::fs::remove_dir_all(&folder);
}

criterion_group! {
    name = board;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3));
    targets = compile
}
criterion_main!(board);
