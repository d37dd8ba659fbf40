//! One motor with its speed profile in one object: husillo beside other crates, on the same move,
//! in the same run, built with the same flags. The pins are mocks that do nothing.

mod accel;
mod husillo;
mod universal;

use cpu_time::ThreadTime;

/// A move of `steps` steps from standstill.
pub struct Job {
    pub top_rate_hz: u32,
    pub acceleration_hz_per_s: u32,
    pub steps: u32,
}

impl Job {
    /// Seconds of step `number`, counted from 1, on the true trapezoid.
    fn time(&self, number: usize) -> f64 {
        let (a, v) = (
            f64::from(self.acceleration_hz_per_s),
            f64::from(self.top_rate_hz),
        );
        let (n, s) = (number as f64, f64::from(self.steps));
        let ramp = v * v / (2.0 * a);
        let total = s / v + v / a;
        if n <= ramp {
            (2.0 * n / a).sqrt()
        } else if n <= s - ramp {
            v / a + (n - ramp) / v
        } else {
            total - (2.0 * (s - n).max(0.0) / a).sqrt()
        }
    }
}

/// A candidate: returns the seconds of each step, or only counts them.
type Run = fn(&Job, &mut dyn FnMut(f64));

fn main() {
    let job = Job {
        top_rate_hz: 8_000,
        acceleration_hz_per_s: 20_000,
        steps: 4_000,
    };
    let candidates: [(&str, Run); 4] = [
        ("husillo `StepperAxis`, A4988 pulses", husillo::straight),
        ("the same, S-curves", husillo::smooth),
        ("stepper 0.6.0, DRV8825", universal::run),
        ("accel-stepper 0.1.0, polled each us", accel::run),
    ];
    println!("| 4000 steps to 8000 steps/s at 20 000 steps/s^2 | ns per step | surplus steps |");
    let is_trial = std::env::args().any(|argument| argument == "--test");
    for (name, run) in candidates {
        let mut times = Vec::new();
        run(&job, &mut |seconds| times.push(seconds));
        let worst = times
            .iter()
            .enumerate()
            .map(|(index, at)| (at - job.time(index + 1)).abs())
            .fold(0.0, f64::max);
        let total = times.last().copied().unwrap_or_default() / job.time(job.steps as usize);
        let surplus = times.len() as i64 - i64::from(job.steps);
        let rounds = if is_trial { 1 } else { 15 };
        let mut costs: Vec<f64> = (0..rounds).map(|_| cost(&job, run)).collect();
        costs.sort_by(f64::total_cmp);
        println!(
            "| {name} | {:.1} | {surplus:+} | time of the move {:+.2} % | largest error {:.3} ms |",
            costs[costs.len() / 2],
            100.0 * (total - 1.0),
            worst * 1e3,
        );
    }
}

fn cost(job: &Job, run: Run) -> f64 {
    let start = ThreadTime::now();
    let mut steps = 0_u32;
    run(job, &mut |seconds| {
        std::hint::black_box(seconds);
        steps += 1;
    });
    start.elapsed().as_nanos() as f64 / f64::from(steps.max(1))
}
