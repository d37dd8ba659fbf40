//! Properties of every compressed stream.

use husillo_planner::{Burst, Bursts, Rates, Trapezoid};
use proptest::prelude::*;

/// The largest distance of a replayed event from its original. The numbers of events have to be
/// equal.
fn largest_error(intervals: &[u32], bursts: &[Burst]) -> i64 {
    let replayed: Vec<u32> = bursts.iter().flat_map(Burst::replay).collect();
    assert_eq!(replayed.len(), intervals.len());
    let (mut off, mut largest) = (0_i64, 0);
    for (one, other) in intervals.iter().zip(replayed) {
        off += i64::from(*one) - i64::from(other);
        largest = largest.max(off.abs());
    }
    largest
}

/// Whether any record of this many events stays within the error, by trying all of them.
fn any_record(intervals: &[u32], late: i64, error: i64) -> bool {
    let first = i64::from(intervals[0]) + late;
    (first - error..=first + error).any(|interval| {
        (-40_i64..=40).any(|add| {
            let (mut replayed, mut original, mut next) = (0, late, interval);
            intervals.iter().all(|ticks| {
                replayed += next;
                original += i64::from(*ticks);
                let fits = next >= 0 && (replayed - original).abs() <= error;
                next += add;
                fits
            })
        })
    })
}

proptest! {
    /// The replay has the same number of events, each within the error of its original time, over
    /// the whole stream.
    #[test]
    fn replays(
        intervals in prop::collection::vec(any::<u32>(), 0..300),
        shift in 0_u32..32,
        error in 0_u32..200,
    ) {
        let intervals: Vec<u32> = intervals.iter().map(|ticks| ticks >> shift).collect();
        let bursts: Vec<Burst> = Bursts::new(intervals.iter().copied(), error).collect();
        prop_assert!(largest_error(&intervals, &bursts) <= i64::from(error));
    }

    /// With an error of at most 8, no record that starts at the same event holds one event more.
    #[test]
    fn longest_runs(intervals in prop::collection::vec(100_u32..130, 1..60), error in 0_u32..9) {
        let (mut done, mut late) = (0, 0_i64);
        for burst in Bursts::new(intervals.iter().copied(), error) {
            let end = done + usize::from(burst.count);
            if end < intervals.len() {
                prop_assert!(!any_record(&intervals[done..=end], late, error.into()));
            }
            let original: i64 = intervals[done..end].iter().map(|ticks| i64::from(*ticks)).sum();
            late += original - burst.replay().map(i64::from).sum::<i64>();
            done = end;
        }
    }
}

/// A trapezoid of 10 000 events fits in few records.
#[test]
fn trapezoid_shrinks() {
    let rates = Rates {
        timer_hz: 1_000_000,
        start_rate_hz: 0,
        top_rate_hz: 8000,
        end_rate_hz: 0,
        acceleration_hz_per_s: 20_000,
    };
    let intervals: Vec<u32> = Trapezoid::new(&rates, 10_000).unwrap().collect();
    for (error, most) in [(1, 600), (5, 250), (25, 150)] {
        let bursts: Vec<Burst> = Bursts::new(intervals.iter().copied(), error).collect();
        assert!(largest_error(&intervals, &bursts) <= i64::from(error));
        assert!(bursts.len() <= most, "{error}: {}", bursts.len());
    }
}
