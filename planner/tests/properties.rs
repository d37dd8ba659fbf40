//! Properties of every timer.

use husillo_planner::Timer;
use proptest::prelude::*;

proptest! {
    /// The time so far is never off by more than one tick, and the total is exact.
    #[test]
    fn sum_is_exact(
        sweeps in prop::collection::vec(1_u32..u32::MAX, 1..200),
        shift in 0_u32..32,
        ticks in 0_u64..1 << 52,
    ) {
        let sweeps: Vec<u32> = sweeps.into_iter().map(|sweep| (sweep >> shift).max(1)).collect();
        let total: u64 = sweeps.iter().copied().map(u64::from).sum();
        let mut timer = Timer::new(ticks, total, *sweeps.iter().max().unwrap());
        let (mut so_far, mut waited) = (0_u128, 0_u128);
        for sweep in sweeps {
            so_far += u128::from(sweep);
            waited += u128::from(timer.wait(sweep));
            let exact = so_far * u128::from(ticks) / u128::from(total);
            prop_assert!(waited == exact || waited == exact + 1, "{} {}", waited, exact);
        }
        prop_assert_eq!(waited, u128::from(ticks));
    }

    /// This holds after 2^31 events too; equal events are added up in one wait per 2^k events.
    #[test]
    fn rate_is_exact_over_long_moves(events in 1_u64..1 << 31, ticks in 0_u64..1 << 51) {
        let mut timer = Timer::new(ticks, events, 1);
        // The error of the rate is below 2^-fraction_bits per event, and 32 bits below that are
        // known.
        prop_assert!(timer.fraction_bits() >= 9);
        let first = timer.wait(1);
        prop_assert!(first == ticks / events || first == ticks / events + 1);
        let error = (u128::from(timer.rate()) * u128::from(events))
            .abs_diff(u128::from(ticks) << timer.fraction_bits());
        prop_assert!(error <= u128::from(events));
    }

    /// No input panics.
    #[test]
    fn any_timer(ticks: u64, sweep: u64, largest: u32, q: u8, waits in any::<[u32; 8]>()) {
        let mut timers = [
            Timer::new(ticks, sweep, largest),
            Timer::with_fraction_bits(ticks, sweep, q),
        ];
        for timer in &mut timers {
            for wait in waits {
                timer.wait(wait);
            }
        }
    }
}

/// 2^31 - 1 equal events one by one, at a rate that is not exact: no tick is lost.
#[test]
fn long_walk() {
    let (events, ticks) = (20_000_000_u64, 123_456_789_123_u64);
    let mut timer = Timer::new(ticks, events, 1);
    let waited: u64 = (0..events).map(|_| timer.wait(1)).sum();
    assert_eq!(waited, ticks);
}
