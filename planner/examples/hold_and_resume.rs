//! Holds a move with ramps half-way, resumes it, and compresses the intervals into bursts for a
//! slow controller.

use husillo_planner::{Bursts, Rates, RatesError, Trapezoid};

fn main() -> Result<(), RatesError> {
    let rates = Rates {
        timer_hz: 1_000_000,
        start_rate_hz: 0,
        top_rate_hz: 2000,
        end_rate_hz: 0,
        acceleration_hz_per_s: 10_000,
    };
    let mut profile = Trapezoid::new(&rates, 1000)?;
    let mut intervals: Vec<u32> = profile.by_ref().take(500).collect();
    let stop = profile.hold();
    intervals.extend(profile.by_ref());
    println!("stopped after {stop:?} more, {} left", profile.remaining());
    profile.resume();
    intervals.extend(profile);
    println!(
        "{} events, {} in bursts",
        intervals.len(),
        Bursts::new(intervals.into_iter(), 10).count()
    );
    Ok(())
}
