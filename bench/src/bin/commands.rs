//! From lines to commands, for comparison with `bench/grbl/check.c`; `bench/grbl/run` runs both
//! alternately.
//!
//! `commands DIALECT PASSES FILE` prints bytes, lines, refused lines and the CPU seconds of the
//! fastest pass over the file. `commands write seg|arc|mix` prints a program of 30 MB.

use std::hint::black_box;
use std::io::Write as _;

use cpu_time::ThreadTime;
use husillo_gcode::{Block, Commands, Dialect, Modal};

/// Length of the generated programs.
const BYTES: usize = 30_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["write", name] => write(name),
        [dialect, passes, path] => time(dialect, passes, path),
        _ => Err("usage: commands DIALECT PASSES FILE, commands write seg|arc|mix".into()),
    }
}

fn write(name: &str) -> Result<(), Box<dyn std::error::Error>> {
    let program = match name {
        "seg" => husillo_bench::segments(BYTES),
        "arc" => husillo_bench::arcs(BYTES),
        "mix" => husillo_bench::mixed(BYTES),
        _ => return Err("programs: seg, arc, mix".into()),
    };
    std::io::stdout().write_all(program.as_bytes())?;
    Ok(())
}

fn time(dialect: &str, passes: &str, path: &str) -> Result<(), Box<dyn std::error::Error>> {
    let dialect = Dialect::by_name(dialect).ok_or("no such dialect")?;
    let passes: u32 = passes.parse()?;
    let mut program = std::fs::read(path)?;
    if program.last() != Some(&b'\n') {
        program.push(b'\n');
    }
    let (mut best_s, mut counts) = (f64::INFINITY, Counts::default());
    for _ in 0..passes {
        let begin = ThreadTime::now();
        counts = take(&program, dialect);
        best_s = best_s.min(begin.elapsed().as_secs_f64());
    }
    let Counts { lines, refused } = counts;
    println!("{} {lines} {refused} {best_s:.6}", program.len());
    Ok(())
}

#[derive(Default)]
struct Counts {
    lines: usize,
    refused: usize,
}

/// Splits, reads, checks and interprets every line, and makes its commands.
#[inline(never)]
fn take(program: &[u8], dialect: Dialect) -> Counts {
    let (mut block, mut modal) = (Block::new(), Modal::<3>::new(dialect));
    let mut commands = Commands::new();
    let mut counts = Counts::default();
    let mut begin = 0;
    for end in memchr::memchr_iter(b'\n', program) {
        let line = &program[begin..end];
        begin = end + 1;
        counts.lines += 1;
        for (_, text) in dialect.blocks(line) {
            let planned = block
                .read(text, &dialect)
                .and_then(|()| modal.apply(&block, &mut commands));
            match planned {
                Ok(()) => (&mut commands).for_each(|command| {
                    black_box(command);
                }),
                Err(error) => {
                    black_box(error);
                    counts.refused += 1;
                }
            }
        }
    }
    counts
}
