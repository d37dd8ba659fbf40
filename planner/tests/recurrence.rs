//! Properties of every trapezoid by recurrence.

mod checker;

use checker::{Bounds, fault};
use husillo_planner::{Rates, Recurrence, Trapezoid};
use proptest::prelude::*;

fn rates() -> impl Strategy<Value = Rates> {
    (
        prop::sample::select(&[1_000_000_u32, 32_000_000][..]),
        0_u32..8000,
        100_u32..60_000,
        0_u32..8000,
        2000_u32..1_000_000,
    )
        .prop_map(|(timer_hz, start, top, end, acceleration)| Rates {
            timer_hz,
            start_rate_hz: start.min(top),
            top_rate_hz: top,
            end_rate_hz: end.min(top),
            acceleration_hz_per_s: acceleration,
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    /// The number of events is right. Rates and acceleration stay within the limits except for the
    /// documented errors.
    #[test]
    fn within_bounds(rates in rates(), events in 1_u32..4000) {
        let Ok(profile) = Recurrence::new(&rates, events) else {
            prop_assert!(Trapezoid::new(&rates, events).is_err());
            return Ok(());
        };
        prop_assert_eq!(profile.len(), events as usize);
        let intervals: Vec<u32> = profile.collect();
        prop_assert_eq!(intervals.len(), events as usize);
        let bounds = Bounds {
            timer_hz: rates.timer_hz.into(),
            top_rate_hz: 1.022 * f64::from(rates.top_rate_hz),
            acceleration_hz_per_s: 1.25 * f64::from(rates.acceleration_hz_per_s),
            slack_ticks: 2.0,
        };
        prop_assert_eq!(fault(&intervals, &bounds), None);
    }

    /// The time of the whole move differs from the exact trapezoid by at most 2.2 %, a tick per
    /// event, and a tenth of the longest interval where the ramps meet.
    #[test]
    fn time_is_right(rates in rates(), events in 1_u32..4000) {
        let (Ok(cheap), Ok(exact)) =
            (Recurrence::new(&rates, events), Trapezoid::new(&rates, events))
        else {
            return Ok(());
        };
        let longest = cheap.clone().max().map_or(0.0, f64::from);
        let cheap = cheap.map(f64::from).sum::<f64>();
        let exact = exact.map(f64::from).sum::<f64>();
        prop_assert!(
            (cheap - exact).abs() < 0.022 * exact + 0.1 * longest + f64::from(events),
            "{} {}",
            cheap,
            exact
        );
    }

    /// A single event speeds up and slows down: its time is that of the exact trapezoid.
    #[test]
    fn a_single_event_takes_its_time(rates in rates()) {
        let (Ok(mut cheap), Ok(mut exact)) =
            (Recurrence::new(&rates, 1), Trapezoid::new(&rates, 1))
        else {
            return Ok(());
        };
        let (Some(cheap), Some(exact)) = (cheap.next(), exact.next()) else {
            return Err(TestCaseError::fail("no event"));
        };
        prop_assert!(cheap.abs_diff(exact) <= 2 + exact / 45, "{} {}", cheap, exact);
    }

    /// No input panics, and the number of events is right.
    #[test]
    fn any_numbers(values: [u32; 5], shifts: [u8; 5], events: u32) {
        let [timer_hz, start_rate_hz, top_rate_hz, end_rate_hz, acceleration_hz_per_s] =
            std::array::from_fn(|index| values[index] >> (shifts[index] % 32));
        let rates = Rates {
            timer_hz,
            start_rate_hz,
            top_rate_hz,
            end_rate_hz,
            acceleration_hz_per_s,
        };
        if let Ok(profile) = Recurrence::new(&rates, events % 1000) {
            prop_assert_eq!(profile.count(), events as usize % 1000);
        }
    }
}

/// The documented errors from standstill.
#[test]
fn stated_errors() {
    let rates = Rates {
        timer_hz: 32_000_000,
        start_rate_hz: 0,
        top_rate_hz: 60_000,
        end_rate_hz: 0,
        acceleration_hz_per_s: 10_000,
    };
    let exact = Trapezoid::new(&rates, 400_000).unwrap();
    let errors: Vec<f64> = Recurrence::new(&rates, 400_000)
        .unwrap()
        .zip(exact)
        .map(|(cheap, exact)| f64::from(cheap) / f64::from(exact) - 1.0)
        .take(170_000)
        .collect();
    for (event, from, to) in [
        (1, -1e-6, 1e-6),
        (2, -0.022, -0.020),
        (3, -0.008, -0.006),
        (10, -0.001, 0.0),
    ] {
        let error = errors[event - 1];
        assert!(from <= error && error <= to, "{event}: {error}");
    }
    // One tick each; an interval at the top rate has 533.
    let worst = errors[100..]
        .iter()
        .fold(0.0_f64, |worst, error| worst.max(error.abs()));
    assert!(worst < 0.004, "{worst}");
    assert!(size_of::<Recurrence>() <= 64);
}
