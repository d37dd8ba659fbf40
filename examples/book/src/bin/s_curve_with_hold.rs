//! A move with limited jerk that is held on its way, and resumed.

use husillo_planner::{Rates, RatesError, SCurve};

// ANCHOR: limits
/// 2000 steps/s, 10 000 steps/s^2, 200 000 steps/s^3, with a timer of 1 MHz.
const RATES: Rates = Rates {
    timer_hz: 1_000_000,
    start_rate_hz: 0,
    top_rate_hz: 2_000,
    end_rate_hz: 0,
    acceleration_hz_per_s: 10_000,
};
const JERK_HZ_PER_S2: u32 = 200_000;
const STEPS: u32 = 3_000;
// ANCHOR_END: limits

fn main() -> Result<(), RatesError> {
    let whole: u64 = SCurve::new(&RATES, JERK_HZ_PER_S2, STEPS)?
        .map(u64::from)
        .sum();
    println!("without a hold: {:.3} s", seconds(whole));

    // ANCHOR: hold
    let mut profile = SCurve::new(&RATES, JERK_HZ_PER_S2, STEPS)?;
    let mut intervals: Vec<u32> = profile.by_ref().take(1_000).collect();
    println!("held after 1000 steps, at {} steps/s", profile.rate_hz());

    let to_stop = profile.hold().expect("room for a stop");
    // The iterator ends at the stop.
    intervals.extend(profile.by_ref());
    assert!(profile.is_held());
    assert_eq!(intervals.len() as u32, 1_000 + to_stop);
    println!(
        "stands after {to_stop} more steps, {} remain",
        profile.remaining()
    );

    assert!(profile.resume());
    intervals.extend(profile.by_ref());
    // ANCHOR_END: hold
    assert_eq!(intervals.len() as u32, STEPS);

    // ANCHOR: check
    // No rate is exceeded, apart from the rounding of an interval to ticks.
    let shortest = intervals.iter().min().expect("some steps");
    let total = intervals.iter().copied().map(u64::from).sum::<u64>();
    println!(
        "shortest interval {shortest} ticks, {:.3} s in all",
        seconds(total)
    );
    assert!(*shortest >= RATES.timer_hz / RATES.top_rate_hz - 1);
    // By the formulas: a stop from v takes v / a + a / j, and as much time again to start.
    // Meanwhile the move gets as far as in half of this time at v.
    let [v, a, j] = [2_000.0, 10_000.0, 200_000.0];
    assert!((seconds(total - whole) - (v / a + a / j)).abs() < 0.001);
    // ANCHOR_END: check
    Ok(())
}

fn seconds(ticks: u64) -> f64 {
    ticks as f64 / f64::from(RATES.timer_hz)
}
