//! The whole chain, from the text of a program to step events, for comparison with
//! `bench/grbl/chain.c`; `bench/grbl/run chain` runs both alternately.
//!
//! `chain PASSES FILE` prints refused lines, axis steps and the CPU seconds of the fastest pass.

use cpu_time::ThreadTime;
use husillo_bench::{Router, router};
use husillo_machine::{Filled, StepEvent};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [passes, path] = &arguments[..] else {
        return Err("usage: chain PASSES FILE".into());
    };
    let program = std::fs::read(path)?;
    let (mut best_s, mut made) = (f64::INFINITY, Made::default());
    for _ in 0..passes.parse::<u32>()? {
        let mut machine = router().ok_or("the scale is 0")?;
        let begin = ThreadTime::now();
        made = run(&mut machine, &program);
        best_s = best_s.min(begin.elapsed().as_secs_f64());
    }
    println!("{} {} {best_s:.6}", made.refused, made.steps);
    Ok(())
}

#[derive(Default)]
struct Made {
    refused: usize,
    steps: u64,
}

/// Gives every line to the machine, and makes steps while its queue is full and at the end.
#[inline(never)]
fn run(machine: &mut Router, program: &[u8]) -> Made {
    let mut made = Made::default();
    let mut begin = 0;
    for end in memchr::memchr_iter(b'\n', program).chain([program.len()]) {
        let line = program.get(begin..end).unwrap_or_default();
        begin = end + 1;
        while !machine.has_room() && fill(machine, &mut made.steps) {}
        made.refused += usize::from(machine.line(line).is_err());
    }
    while fill(machine, &mut made.steps) {}
    made
}

/// Makes up to 64 steps. Returns whether more events follow.
fn fill(machine: &mut Router, steps: &mut u64) -> bool {
    let mut events = [StepEvent::default(); 64];
    let Filled { steps: made, then } = machine.fill(&mut events);
    for event in events.iter().take(made) {
        let moved = event.delta.iter().filter(|&&delta| delta != 0).count();
        *steps += moved as u64;
    }
    made == events.len() || then.is_some()
}

#[cfg(test)]
mod tests {
    use super::{router, run};

    /// The axis steps of a rectangle are its length, and no line is refused.
    #[test]
    fn all_steps_are_counted() {
        let mut machine = router().unwrap();
        let made = run(&mut machine, b"G1 X1 F600\nY2\nX0\nY0\nM2");
        assert_eq!((made.refused, made.steps), (0, 2 * (400 + 800)));
    }
}
