//! Times every kernel of `bench/peers/control`. It uses the CPU time of the thread, so that other
//! programs have little influence. All kernels run in rounds. The result is the median over the
//! rounds of the ratio to the kernel of husillo for the same task.

use cpu_time::ThreadTime;
use std::time::Duration;

/// Number of rounds.
const TURNS: usize = 15;
/// Shortest time of a kernel in a round.
const TURN: Duration = Duration::from_millis(20);

/// A kernel and its nanoseconds per sample in each round.
struct Row {
    name: String,
    repeats: u32,
    turns: Vec<f64>,
}

fn main() {
    let is_trial = std::env::args().any(|argument| argument == "--test");
    let mut rows: Vec<Row> = Vec::new();
    for _ in 0..if is_trial { 1 } else { TURNS } {
        kernels::all(&mut |name, events, work| {
            let number = rows.iter().position(|row| row.name == name);
            let number = number.unwrap_or_else(|| {
                rows.push(Row {
                    name: name.to_owned(),
                    repeats: if is_trial { 1 } else { repeats(work) },
                    turns: Vec::new(),
                });
                rows.len() - 1
            });
            let row = &mut rows[number];
            let start = ThreadTime::now();
            for _ in 0..row.repeats {
                work();
            }
            let samples = f64::from(row.repeats) * f64::from(events);
            row.turns.push(start.elapsed().as_nanos() as f64 / samples);
        });
    }
    println!("| kernel | of ours | ns a sample |\n| --- | --- | --- |");
    let mut ours = 0;
    for number in 0..rows.len() {
        let row = &rows[number];
        if row.name.starts_with("husillo") {
            ours = number;
        }
        let ratios = row.turns.iter().zip(&rows[ours].turns);
        let ratio = median(ratios.map(|(own, first)| own / first));
        let time = median(row.turns.iter().copied());
        println!("| {} | {ratio:.2} | {time:.2} |", row.name);
    }
}

/// The number of repetitions of the kernel in a round.
fn repeats(work: &mut dyn FnMut()) -> u32 {
    let mut repeats = 1;
    loop {
        let start = ThreadTime::now();
        for _ in 0..repeats {
            work();
        }
        if start.elapsed() >= TURN {
            return repeats;
        }
        repeats *= 2;
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
