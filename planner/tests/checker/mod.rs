//! Independent checks that use nothing but the intervals: their mean rates, and how fast these
//! change.

#![allow(dead_code, reason = "every test takes what it needs")]

/// Limits for a stream of intervals.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub timer_hz: f64,
    pub top_rate_hz: f64,
    pub acceleration_hz_per_s: f64,
    /// Ticks by which one interval may be off because of rounding.
    pub slack_ticks: f64,
}

/// The first fault in `intervals`, for a move that begins at any rate.
///
/// The mean rates of two neighbouring intervals differ by at most the acceleration times the time
/// between their midpoints, whatever the rates in between. Both intervals may be off by the slack.
pub fn fault(intervals: &[u32], bounds: &Bounds) -> Option<String> {
    let Bounds {
        timer_hz,
        top_rate_hz,
        acceleration_hz_per_s,
        slack_ticks,
    } = *bounds;
    for (index, pair) in intervals.windows(2).enumerate() {
        let [one, other] = [f64::from(pair[0]), f64::from(pair[1])];
        let (short, long) = (one.min(other), one.max(other));
        let change = timer_hz / (short + slack_ticks) - timer_hz / (long - slack_ticks).max(0.5);
        let time = (one + other + 2.0 * slack_ticks) / 2.0 / timer_hz;
        if change > acceleration_hz_per_s * time * (1.0 + 1e-6) {
            return Some(format!(
                "acceleration between {index} and the next: {one} {other}: {}",
                change / time
            ));
        }
    }
    let least = timer_hz / top_rate_hz - slack_ticks;
    intervals
        .iter()
        .position(|ticks| f64::from(*ticks) < least * (1.0 - 1e-6))
        .map(|index| format!("rate at {index}: {} < {least}", intervals[index]))
}

/// The times in ticks at which the true trapezoid reaches each whole step, in floating point.
pub fn trapezoid_times(f: f64, start: f64, top: f64, end: f64, a: f64, events: u32) -> Vec<f64> {
    let n = f64::from(events);
    let highest = ((start * start + end * end) / 2.0 + a * n).sqrt();
    let end = end.min((start * start + 2.0 * a * n).sqrt());
    let peak = highest.min(top).max(start.min(top)).max(end);
    let up = (peak * peak - start * start) / (2.0 * a);
    let down = (peak * peak - end * end) / (2.0 * a);
    let whole = (peak - start) / a + (n - up - down) / peak + (peak - end) / a;
    (1..=events)
        .map(|k| {
            let s = f64::from(k);
            f * if s <= up {
                // The numerically stable form of (v - start) / a.
                2.0 * s / ((start * start + 2.0 * a * s).sqrt() + start)
            } else if s <= n - down {
                (peak - start) / a + (s - up) / peak
            } else {
                whole - 2.0 * (n - s) / ((end * end + 2.0 * a * (n - s)).sqrt() + end).max(1e-300)
            }
        })
        .collect()
}

/// The first point where the mean acceleration changes faster than the jerk, if both ends of each
/// interval may be off by the slack.
///
/// This is the second divided difference of the mean rates: the third divided difference of the
/// inverse of the times, which is at most the jerk / 6.
pub fn jerk_fault(intervals: &[u32], bounds: &Bounds, jerk_hz_per_s2: f64) -> Option<String> {
    // Position k is at time t[k]; its third divided difference is the mean of a third derivative
    // / 6.
    let f = bounds.timer_hz;
    for (index, part) in intervals.windows(3).enumerate() {
        let [a, b, c] = [part[0], part[1], part[2]].map(|ticks| f64::from(ticks) / f);
        let third = ((1.0 / c - 1.0 / b) / (b + c) - (1.0 / b - 1.0 / a) / (a + b)) / (a + b + c);
        // The effect of moving any of the four times by the slack.
        let slack = bounds.slack_ticks / f;
        let least = a.min(b).min(c) - slack;
        if least <= 0.0 {
            continue;
        }
        let rounding = 8.0 * slack / least.powi(4) / 4.0;
        if third.abs() * 6.0 > jerk_hz_per_s2 * (1.0 + 1e-4) + 6.0 * rounding {
            return Some(format!(
                "jerk at {index}: {part:?}: {} of {jerk_hz_per_s2}",
                third * 6.0
            ));
        }
    }
    None
}
