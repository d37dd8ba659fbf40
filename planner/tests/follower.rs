//! Properties of motion that follows a spindle.

use husillo_planner::{Due, Follower};
use proptest::prelude::*;

/// Runs a follower on a spindle whose position in counts is any function of ticks. Returns the true
/// position of the spindle at each event.
fn run(
    position: impl Fn(u32) -> f64,
    follower: &mut Follower,
    ticks: std::ops::Range<u32>,
) -> Vec<f64> {
    let mut events = Vec::new();
    for now in ticks {
        follower.measure(now, position(now).floor() as i32);
        while follower.due(now) == Due::Now {
            events.push(position(now));
            follower.advance();
        }
    }
    events
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// With more counts than events the pitch error is below one step, however the speed varies:
    /// from 10 % to 100 % and back.
    #[test]
    fn pitch_error_below_a_step(
        counts in 100_u32..4000,
        events in 50_u32..2000,
        wave in 3000.0_f64..30_000.0,
        speed in 0.01_f64..0.2,
    ) {
        prop_assume!(events <= counts);
        // Speed in counts per tick: speed (0.55 + 0.45 cos).
        let position = |now: u32| {
            let t = f64::from(now);
            speed * (0.55 * t + 0.45 * wave * (t / wave).sin())
        };
        let mut follower = Follower::new(counts, events, 5, 0).unwrap();
        let made = run(position, &mut follower, 0..60_000);
        let a_step = f64::from(counts) / f64::from(events);
        for (index, at) in made.iter().enumerate() {
            let error = (at - 5.0) / a_step - index as f64;
            prop_assert!(error.abs() < 1.0, "{} {}", index, error);
        }
        let all = ((position(59_999) - 5.0) / a_step) as usize;
        prop_assert!(made.len() + 1 >= all && made.len() <= all + 2);
    }

    /// With several events per count the period is divided among them. The error is below one step
    /// too, while the speed changes slowly.
    #[test]
    fn interpolates_between_counts(events in 1_u32..8, speed in 0.001_f64..0.02) {
        let position = |now: u32| {
            let t = f64::from(now);
            speed * (t + 1000.0 * (t / 20_000.0).sin())
        };
        let mut follower = Follower::new(1, events, 8, 0).unwrap();
        for (index, at) in run(position, &mut follower, 0..200_000).iter().enumerate() {
            let error = (at - 8.0) * f64::from(events) - index as f64;
            prop_assert!(error.abs() < 1.0, "{} {}", index, error);
        }
    }

    /// The pitch is an exact fraction: after any number of turns the event is at its exact count.
    #[test]
    fn no_drift(counts in 1_u32..5000, events in 1_u32..5000, turns in 1_i64..500) {
        let mut follower = Follower::new(counts, events, 0, 0).unwrap();
        for _ in 0..turns * i64::from(events) {
            follower.advance();
        }
        prop_assert_eq!(follower.counts_ahead(), turns * i64::from(counts));
    }

    /// No input panics.
    #[test]
    fn any_numbers(
        counts: u32,
        events: u32,
        start: i32,
        calls in prop::collection::vec(any::<(u32, i32)>(), 0..50),
    ) {
        if let Some(mut follower) = Follower::new(counts, events, start, 0) {
            for (now, count) in calls {
                follower.measure(now, count);
                let _ = follower.due(now);
                follower.advance();
            }
        }
    }
}

/// The motion stands while the spindle stands and does not step back with it. It continues where it
/// left the thread.
#[test]
fn stop_and_reverse() {
    // Forward to 500 counts, stop, back to 300, forward again.
    let position = |now: u32| match now {
        0..50_000 => f64::from(now) / 100.0,
        50_000..60_000 => 500.0,
        60_000..80_000 => 500.0 - f64::from(now - 60_000) / 100.0,
        _ => 300.0 + f64::from(now - 80_000) / 100.0,
    };
    let mut follower = Follower::new(10, 3, 0, -1).unwrap();
    let forward = run(position, &mut follower, 0..50_000);
    assert_eq!(forward.len(), 150);
    // Counts 490, 493.3 and 496.7 were made; count 500 comes with the stop, and nothing else.
    assert_eq!(run(position, &mut follower, 50_000..90_000), [500.0]);
    // The farthest event is 500; the next is at 503.3.
    let again = run(position, &mut follower, 90_000..110_000);
    assert!((again[0] - 503.33).abs() < 0.1, "{}", again[0]);
    assert!(size_of::<Follower>() <= 48);
}

proptest! {
    /// Events with individual waits in 2^-16 counts are due at the same times as events with equal
    /// waits.
    #[test]
    fn advance_by_is_advance(
        counts in 1_u32..50_000,
        start in -1000_i32..1000,
        events in 1_u32..200,
    ) {
        // `counts` 2^-16 counts per event, expressed in both ways.
        let mut each = Follower::new(counts, 1 << 16, start, -2000).unwrap();
        let mut many = Follower::new(1, 1 << 16, start, -2000).unwrap();
        for _ in 0..events {
            each.advance();
            many.advance_by(counts);
            prop_assert_eq!(each.counts_ahead(), many.counts_ahead());
        }
        let mut at_once = Follower::new(counts, 1 << 16, start, -2000).unwrap();
        at_once.advance_by(events);
        prop_assert_eq!(at_once, each);
    }
}
