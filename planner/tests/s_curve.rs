//! Properties of every jerk-limited profile.

mod checker;

use checker::{Bounds, fault, jerk_fault};
use husillo_planner::{Rates, RatesError, SCurve};
use proptest::prelude::*;

fn limits() -> impl Strategy<Value = (Rates, u32)> {
    (
        prop::sample::select(&[1_000_000_u32, 32_000_000][..]),
        0_u32..4000,
        10_u32..40_000,
        0_u32..4000,
        1000_u32..200_000,
        5_u32..2000,
    )
        .prop_map(|(timer_hz, start, top, end, acceleration, jerk)| {
            let rates = Rates {
                timer_hz,
                start_rate_hz: start.min(top),
                top_rate_hz: top,
                end_rate_hz: end.min(top),
                acceleration_hz_per_s: acceleration,
            };
            (rates, acceleration * jerk)
        })
}

fn bounds(rates: &Rates) -> Bounds {
    Bounds {
        timer_hz: rates.timer_hz.into(),
        top_rate_hz: rates.top_rate_hz.into(),
        acceleration_hz_per_s: rates.acceleration_hz_per_s.into(),
        slack_ticks: 1.25 * 4.0,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    /// The number of events is right, and rates, acceleration and jerk stay within the limits.
    #[test]
    fn within_limits((rates, jerk) in limits(), events in 1_u32..4000) {
        let Ok(profile) = SCurve::new(&rates, jerk, events) else {
            return Ok(());
        };
        prop_assert_eq!(profile.len(), events as usize);
        let intervals: Vec<u32> = profile.collect();
        prop_assert_eq!(intervals.len(), events as usize);
        prop_assert_eq!(fault(&intervals, &bounds(&rates)), None);
        prop_assert_eq!(jerk_fault(&intervals, &bounds(&rates), jerk.into()), None);
    }

    /// From standstill to standstill the profile is its own mirror image, to a tick or two.
    #[test]
    fn mirrors((rates, jerk) in limits(), events in 1_u32..4000) {
        let rates = Rates { start_rate_hz: 0, end_rate_hz: 0, ..rates };
        let intervals: Vec<u32> = SCurve::new(&rates, jerk, events).unwrap().collect();
        for (one, other) in intervals.iter().zip(intervals.iter().rev()) {
            prop_assert!(one.abs_diff(*other) <= 8 + one / 100_000, "{} {}", one, other);
        }
    }

    /// Whatever is requested on the way, the number of events is right and the limits hold.
    #[test]
    fn changes_on_the_way(
        (rates, jerk) in limits(),
        events in 1_u32..3000,
        changes in prop::collection::vec((0_u32..700, 0_u8..4, 10_u32..40_000), 0..12),
    ) {
        let mut events = events;
        let Ok(mut profile) = SCurve::new(&rates, jerk, events) else { return Ok(()) };
        let (mut intervals, mut fastest) = (Vec::new(), rates.top_rate_hz.max(rates.start_rate_hz));
        for (count, what, rate) in changes {
            let len = profile.len();
            let part: Vec<u32> = profile.by_ref().take(count as usize).collect();
            prop_assert_eq!(part.len(), len.min(count as usize));
            intervals.extend(part);
            match what {
                0 => if profile.set_top_rate(rate) == Ok(true) { fastest = fastest.max(rate) },
                1 => { let _ = profile.hold(); }
                2 => if profile.set_remaining(rate % 3000) {
                    prop_assert_eq!(profile.len(), (rate % 3000) as usize);
                    events = intervals.len() as u32 + rate % 3000;
                },
                _ => { let _ = profile.resume(); }
            }
            prop_assert!(profile.rate_hz() <= fastest);
            prop_assert_eq!(profile.remaining() as usize + intervals.len(), events as usize);
        }
        if !profile.resume() {
            intervals.extend(profile.by_ref());
            prop_assert!(profile.resume());
        }
        intervals.extend(profile.by_ref());
        prop_assert_eq!(intervals.len(), events as usize);
        let bounds = Bounds { top_rate_hz: fastest.into(), ..bounds(&rates) };
        prop_assert_eq!(fault(&intervals, &bounds), None);
        prop_assert_eq!(jerk_fault(&intervals, &bounds, jerk.into()), None);
    }

    /// No input panics, and every profile ends.
    #[test]
    fn any_numbers(values: [u32; 6], shifts: [u8; 6], events: u32) {
        let [timer_hz, start_rate_hz, top_rate_hz, end_rate_hz, acceleration_hz_per_s, jerk] =
            std::array::from_fn(|index| values[index] >> (shifts[index] % 32));
        let rates = Rates {
            timer_hz,
            start_rate_hz,
            top_rate_hz,
            end_rate_hz,
            acceleration_hz_per_s,
        };
        if let Ok(mut profile) = SCurve::new(&rates, jerk, events) {
            let _ = profile.by_ref().take(300).count();
            let _ = profile.hold();
            let _ = profile.by_ref().take(300).count();
            profile.resume();
            let _ = profile.set_top_rate(top_rate_hz / 2);
            let left = profile.len();
            prop_assert_eq!(profile.by_ref().take(300).count(), left.min(300));
        }
    }
}

/// The total time is that of the textbook's seven phases, and of their short forms.
#[test]
fn textbook_times() {
    let rates = Rates {
        timer_hz: 1_000_000,
        start_rate_hz: 0,
        top_rate_hz: 1000,
        end_rate_hz: 0,
        acceleration_hz_per_s: 5000,
    };
    // Jerk time 0.05 s, ramp 0.25 s over 125 steps; 750 steps at 1000 Hz.
    let sum = |events, jerk| -> u32 { SCurve::new(&rates, jerk, events).unwrap().sum() };
    assert!(sum(1000, 100_000).abs_diff(1_250_000) < 3);
    // No cruise, acceleration reached: the peak v satisfies (v/a + a/j) v = 100.
    let peak: f64 = (-0.05 + (0.05_f64 * 0.05 + 4.0 * 100.0 / 5000.0).sqrt()) * 2500.0;
    let time = 2.0 * (peak / 5000.0 + 0.05) * 1e6;
    assert!((f64::from(sum(100, 100_000)) - time).abs() < 3.0);
    // No constant acceleration: 2 j t^3 = 10.
    let time = 4.0 * (10.0_f64 / 2.0 / 100_000.0).cbrt() * 1e6;
    assert!(
        (f64::from(sum(10, 100_000)) - time).abs() < 4.0,
        "{} {time}",
        sum(10, 100_000)
    );
}

/// Another goal on the way: the rate continues, and a goal within the braking distance is refused.
#[test]
fn another_goal_on_the_way() {
    let rates = Rates {
        timer_hz: 1_000_000,
        start_rate_hz: 0,
        top_rate_hz: 1000,
        end_rate_hz: 0,
        acceleration_hz_per_s: 5000,
    };
    let mut profile = SCurve::new(&rates, 100_000, 2000).unwrap();
    assert_eq!(profile.rate_hz(), 0);
    assert!(profile.nth(999).unwrap().abs_diff(1000) <= 1);
    assert!(profile.rate_hz().abs_diff(1000) <= 1);
    let before = profile.clone();
    // A ramp takes 125 events.
    assert!(!profile.set_remaining(123));
    assert_eq!(profile, before);
    assert!(profile.set_remaining(175));
    assert!(profile.by_ref().take(49).last().unwrap().abs_diff(1000) <= 1);
    assert_eq!(profile.by_ref().count(), 126);
    assert_eq!(profile.rate_hz(), 0);
    assert!(profile.set_remaining(10));
    let again: Vec<u32> = profile.collect();
    let new: Vec<u32> = SCurve::new(&rates, 100_000, 10).unwrap().collect();
    for (one, other) in again.iter().zip(&new) {
        assert!(one.abs_diff(*other) <= 4, "{again:?} {new:?}");
    }
}

/// Impossible profiles are refused.
#[test]
fn refused() {
    let rates = Rates {
        timer_hz: 1_000_000,
        start_rate_hz: 1000,
        top_rate_hz: 1000,
        end_rate_hz: 0,
        acceleration_hz_per_s: 5000,
    };
    assert_eq!(
        SCurve::new(&rates, 100_000, 124).err(),
        Some(RatesError::TooShort)
    );
    assert_eq!(
        SCurve::new(&rates, 100_000, 126).map(Iterator::count),
        Ok(126)
    );
    assert_eq!(SCurve::new(&rates, 0, 126).err(), Some(RatesError::Zero));
    assert!(size_of::<SCurve>() <= 128);
}

/// A jerk that reaches the acceleration, or the top rate, within one tick is refused, because the
/// limits would not hold.
#[test]
fn a_jerk_too_high_for_the_timer_is_refused() {
    for (timer_hz, top_rate_hz, acceleration_hz_per_s, jerk) in [
        (1000, 100, 100_000, u32::MAX),
        (1000, 1, 1860, 1_840_797),
        (20_000, 1000, 5000, 1_000_000_000),
        (100_000, 10_000, 100, u32::MAX),
    ] {
        let rates = Rates {
            timer_hz,
            start_rate_hz: 0,
            top_rate_hz,
            end_rate_hz: 0,
            acceleration_hz_per_s,
        };
        assert_eq!(
            SCurve::new(&rates, jerk, 10),
            Err(RatesError::TimerOutOfRange)
        );
    }
}
