//! Properties of every trapezoid.

mod checker;

use checker::{Bounds, fault, trapezoid_times};
use husillo_planner::{Rates, RatesError, Trapezoid};
use proptest::prelude::*;

const TIMERS: [u32; 4] = [100_000, 1_000_000, 32_000_000, 84_000_000];

fn rates() -> impl Strategy<Value = Rates> {
    (
        prop::sample::select(&TIMERS[..]),
        0_u32..8000,
        1_u32..60_000,
        0_u32..8000,
        50_u32..2_000_000,
    )
        .prop_map(|(timer_hz, start, top, end, acceleration)| {
            // Fast timers allow no slow ramps: ramps stay below 2^30 ticks.
            let least = ((u64::from(timer_hz) * u64::from(top.max(8000))) >> 30) as u32 + 1;
            Rates {
                timer_hz,
                start_rate_hz: start.min(top),
                top_rate_hz: top,
                end_rate_hz: end.min(top),
                acceleration_hz_per_s: acceleration.max(least),
            }
        })
}

fn bounds(rates: &Rates) -> Bounds {
    Bounds {
        timer_hz: rates.timer_hz.into(),
        top_rate_hz: rates.top_rate_hz.into(),
        acceleration_hz_per_s: rates.acceleration_hz_per_s.into(),
        slack_ticks: 2.0,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    /// Every interval is that of the true trapezoid to one tick (two ticks where parts meet), and
    /// so is every sum.
    #[test]
    fn intervals_are_true(rates in rates(), events in 1_u32..4000) {
        let Ok(profile) = Trapezoid::new(&rates, events) else {
            // Only a profile that cannot slow down is refused.
            let [start, end] = [rates.start_rate_hz, rates.end_rate_hz].map(f64::from);
            let room = 2.0 * f64::from(rates.acceleration_hz_per_s) * f64::from(events);
            prop_assert!(start * start - end * end > room * 0.999_999);
            return Ok(());
        };
        let intervals: Vec<u32> = profile.collect();
        let times = trapezoid_times(
            rates.timer_hz.into(), rates.start_rate_hz.into(), rates.top_rate_hz.into(),
            rates.end_rate_hz.into(), rates.acceleration_hz_per_s.into(), events,
        );
        prop_assert_eq!(intervals.len(), times.len());
        let (mut sum, mut before, mut wide) = (0_u64, 0.0, 0);
        for (ticks, time) in intervals.iter().zip(times) {
            sum += u64::from(*ticks);
            prop_assert!((sum as f64 - time).abs() < 4.0 + time * 1e-9, "{} {}", sum, time);
            let error = (f64::from(*ticks) - (time - before)).abs();
            prop_assert!(error < 2.0 + time * 1e-9, "{} {}", ticks, time - before);
            wide += u32::from(error > 1.0 + time * 1e-9);
            before = time;
        }
        prop_assert!(wide <= 2);
        prop_assert_eq!(fault(&intervals, &bounds(&rates)), None);
    }

    /// In reverse it is the profile from the end rate to the start rate; the ramps are equal tick
    /// for tick.
    #[test]
    fn ramps_mirror(rates in rates(), events in 1_u32..3000) {
        let back = Rates {
            start_rate_hz: rates.end_rate_hz,
            end_rate_hz: rates.start_rate_hz,
            ..rates
        };
        let (Ok(there), Ok(back)) =
            (Trapezoid::new(&rates, events), Trapezoid::new(&back, events))
        else {
            return Ok(());
        };
        let there: Vec<u32> = there.collect();
        let mut back: Vec<u32> = back.collect();
        back.reverse();
        for (one, other) in there.iter().zip(&back) {
            prop_assert!(one.abs_diff(*other) <= 1, "{} {}", one, other);
        }
        let [start, end, top] =
            [rates.start_rate_hz, rates.end_rate_hz, rates.top_rate_hz].map(f64::from);
        let a = f64::from(rates.acceleration_hz_per_s);
        let peak = top.min(((start * start + end * end) / 2.0 + a * f64::from(events)).sqrt());
        let up = ((peak * peak - start * start) / (2.0 * a) - 0.001) as usize;
        let down = ((peak * peak - end * end) / (2.0 * a) - 0.001) as usize;
        prop_assert_eq!(&there[..up.min(there.len())], &back[..up.min(there.len())]);
        let tail = there.len() - down.min(there.len());
        prop_assert_eq!(&there[tail..], &back[tail..]);
    }

    /// Whatever is requested on the way, the number of events is right, `len` says when the
    /// iterator ends, acceleration and rates stay within the limits, and the end rate is met.
    #[test]
    fn changes_on_the_way(
        rates in rates(),
        events in 1_u32..3000,
        changes in prop::collection::vec((0_u32..700, 0_u8..4, 1_u32..60_000), 0..12),
    ) {
        let Ok(mut profile) = Trapezoid::new(&rates, events) else { return Ok(()) };
        let (mut intervals, mut fastest) = (Vec::new(), rates.top_rate_hz.max(rates.start_rate_hz));
        let mut events = events;
        for (count, what, rate) in changes {
            let len = profile.len();
            let part: Vec<u32> = profile.by_ref().take(count as usize).collect();
            prop_assert_eq!(part.len(), len.min(count as usize));
            intervals.extend(part);
            match what {
                0 => if profile.set_top_rate(rate).is_ok() { fastest = fastest.max(rate) },
                1 => match profile.hold() {
                    Some(stop) => prop_assert_eq!(profile.len(), stop as usize),
                    None => prop_assert_eq!(profile.len(), profile.remaining() as usize),
                },
                2 => if profile.set_remaining(rate % 3000) {
                    prop_assert_eq!(profile.len(), (rate % 3000) as usize);
                    events = intervals.len() as u32 + rate % 3000;
                },
                _ => profile.resume(),
            }
            prop_assert_eq!(profile.remaining() as usize + intervals.len(), events as usize);
        }
        profile.resume();
        intervals.extend(profile.by_ref());
        prop_assert_eq!(intervals.len(), events as usize);
        prop_assert!(profile.rate_hz() <= rates.end_rate_hz);
        let fastest = Bounds { top_rate_hz: fastest.into(), ..bounds(&rates) };
        prop_assert_eq!(fault(&intervals, &fastest), None);
    }

    /// A hold comes to standstill within the braking distance, rounded up, and leaves the rest of
    /// the move.
    #[test]
    fn hold_stops(rates in rates(), events in 1_u32..3000, at in 0_u32..3000) {
        let Ok(mut profile) = Trapezoid::new(&rates, events) else { return Ok(()) };
        let _ = profile.by_ref().take(at as usize).count();
        // The effect of one tick of rounding on the rate.
        let tick = f64::from(rates.acceleration_hz_per_s) / f64::from(rates.timer_hz);
        let rate = f64::from(profile.rate_hz()) + 1.0 + tick;
        if let Some(stop) = profile.hold() {
            let acceleration = f64::from(rates.acceleration_hz_per_s);
            prop_assert!(f64::from(stop) <= rate * rate / (2.0 * acceleration) + 1.01);
            prop_assert_eq!(profile.by_ref().count(), stop as usize);
            prop_assert!(profile.is_held());
            prop_assert_eq!(profile.rate_hz(), 0);
            profile.resume();
            prop_assert_eq!(profile.len(), profile.remaining() as usize);
        }
    }

    /// No input panics, and every profile ends.
    #[test]
    fn any_numbers(
        timer_hz: u32,
        start: u32,
        top: u32,
        end: u32,
        acceleration: u32,
        shifts in any::<[u8; 5]>(),
        events: u32,
    ) {
        let cut = |value: u32, shift: u8| value >> (shift % 32);
        let rates = Rates {
            timer_hz: cut(timer_hz, shifts[0]),
            start_rate_hz: cut(start, shifts[1]),
            top_rate_hz: cut(top, shifts[2]),
            end_rate_hz: cut(end, shifts[3]),
            acceleration_hz_per_s: cut(acceleration, shifts[4]),
        };
        if let Ok(mut profile) = Trapezoid::new(&rates, events) {
            let _ = profile.by_ref().take(300).count();
            let _ = profile.hold();
            let _ = profile.by_ref().take(300).count();
            profile.resume();
            let _ = profile.set_top_rate(top);
            let left = profile.remaining() as usize;
            prop_assert_eq!(profile.by_ref().take(300).count(), left.min(300));
        }
    }
}

/// An override takes effect at once: the rate changes at full acceleration until it is reached.
#[test]
fn override_takes_effect() {
    let rates = Rates {
        timer_hz: 1_000_000,
        start_rate_hz: 0,
        top_rate_hz: 1000,
        end_rate_hz: 0,
        acceleration_hz_per_s: 5000,
    };
    let mut profile = Trapezoid::new(&rates, 2000).unwrap();
    assert_eq!(profile.nth(999), Some(1000));
    profile.set_top_rate(2000).unwrap();
    // (2000^2 - 1000^2) / 10000 = 300 events.
    assert_eq!(profile.by_ref().take(301).last(), Some(500));
    profile.set_top_rate(500).unwrap();
    // (2000^2 - 500^2) / 10000 = 375 events.
    assert_eq!(profile.by_ref().take(376).last(), Some(2000));
    assert_eq!(profile.len(), 2000 - 1000 - 301 - 376);
    assert_eq!(profile.last(), Some(20000));
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
    let mut profile = Trapezoid::new(&rates, 2000).unwrap();
    assert_eq!(profile.nth(999), Some(1000));
    let before = profile.clone();
    assert!(!profile.set_remaining(99));
    assert_eq!(profile, before);
    // 1000^2 / 10000 = 100 events to the stop.
    assert!(profile.set_remaining(150));
    assert_eq!(profile.by_ref().take(50).last(), Some(1000));
    assert_eq!(profile.hold(), Some(100));
    assert!(profile.set_remaining(100));
    assert_eq!((profile.is_held(), profile.remaining()), (false, 100));
    assert_eq!(profile.by_ref().last(), Some(20_000));
    assert!(profile.set_remaining(1));
    assert_eq!(profile.next(), Some(2 * 14_142));
    assert!(profile.set_remaining(0));
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
    assert_eq!(Trapezoid::new(&rates, 99).err(), Some(RatesError::TooShort));
    assert_eq!(Trapezoid::new(&rates, 100).map(Iterator::count), Ok(100));
    let none = Rates {
        acceleration_hz_per_s: 0,
        ..rates
    };
    assert_eq!(Trapezoid::new(&none, 100).err(), Some(RatesError::Zero));
    let slow = Rates {
        timer_hz: 32_000_000,
        acceleration_hz_per_s: 1,
        ..rates
    };
    assert_eq!(
        Trapezoid::new(&slow, 100).err(),
        Some(RatesError::RampTooLong)
    );
    assert!(size_of::<Trapezoid>() <= 64);
}

/// A long move loses nothing: 20 million events on one slow ramp, compared with the formula.
#[test]
fn long_ramp() {
    let rates = Rates {
        timer_hz: 1_000_000,
        start_rate_hz: 0,
        top_rate_hz: 200_000,
        end_rate_hz: 200_000,
        acceleration_hz_per_s: 999,
    };
    let profile = Trapezoid::new(&rates, 20_000_000).unwrap();
    let sum: u64 = profile.map(u64::from).sum();
    let exact = 1e6 * (2.0 * 20e6 / 999.0_f64).sqrt();
    assert!((sum as f64 - exact).abs() < 2.0, "{sum} {exact}");
}

/// Where the ramp to the present rate takes less than a tick, an event at that rate still takes its
/// full time. A profile that has ended cannot be held.
#[test]
fn steep_ramps_take_their_time() {
    let rates = Rates {
        timer_hz: 20_000,
        start_rate_hz: 5,
        top_rate_hz: 1,
        end_rate_hz: 1,
        acceleration_hz_per_s: 524_818,
    };
    let mut profile = Trapezoid::new(&rates, 3).unwrap();
    profile.hold();
    assert!(profile.all(|ticks| ticks > 0));
    let mut profile = Trapezoid::new(&rates, 1).unwrap();
    profile.next();
    assert_eq!(profile.hold(), None);
}
