//! Comparison of speeds.

use std::time::Duration;

use cpu_time::ThreadTime;

/// Number of rounds.
const TURNS: usize = 15;
/// Shortest time of a candidate in a round.
const TURN: Duration = Duration::from_millis(20);

/// One row of a table.
pub struct Candidate<'a> {
    pub name: &'a str,
    /// Results on its accuracy, one cell per column.
    pub cells: Vec<String>,
    /// Runs the job once and returns the number of events.
    pub run: Box<dyn FnMut() -> u64 + 'a>,
}

/// Prints a table: name, time, nanoseconds and the other cells.
pub fn race(title: &str, event: &str, columns: &[&str], candidates: Vec<Candidate<'_>>) {
    let (mut rows, mut jobs) = (Vec::new(), Vec::new());
    for Candidate {
        name,
        cells,
        mut run,
    } in candidates
    {
        let repeats = repeats(&mut run);
        rows.push((name, cells));
        jobs.push((run, repeats));
    }
    let mut turns = vec![Vec::new(); jobs.len()];
    for _ in 0..if is_trial() { 1 } else { TURNS } {
        for ((run, repeats), turns) in jobs.iter_mut().zip(&mut turns) {
            turns.push(nanoseconds(run, *repeats));
        }
    }
    println!("| {title} | time | ns {event} | {} |", columns.join(" | "));
    println!("| --- |{}", " --- |".repeat(columns.len() + 2));
    let first = turns[0].clone();
    for ((name, cells), turns) in rows.iter().zip(&turns) {
        let ratio = median(turns.iter().zip(&first).map(|(own, first)| own / first));
        let absolute = median(turns.iter().copied());
        let cells = cells.join(" | ");
        println!("| {name} | {ratio:.2} | {absolute:.2} | {cells} |");
    }
    println!();
}

/// Whether this is only a check that everything runs.
fn is_trial() -> bool {
    std::env::args().any(|argument| argument == "--test")
}

/// The number of repetitions of the job in a round.
fn repeats(run: &mut dyn FnMut() -> u64) -> u32 {
    let mut repeats = 1;
    loop {
        let start = ThreadTime::now();
        for _ in 0..repeats {
            run();
        }
        if is_trial() || start.elapsed() >= TURN {
            return repeats;
        }
        repeats *= 2;
    }
}

fn nanoseconds(run: &mut dyn FnMut() -> u64, repeats: u32) -> f64 {
    let start = ThreadTime::now();
    let events: u64 = (0..repeats).map(|_| run()).sum();
    start.elapsed().as_nanos() as f64 / events.max(1) as f64
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
