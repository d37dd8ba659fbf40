//! Properties of the timers of every straight move.

use husillo_planner::AxisTimers;
use proptest::prelude::*;

/// Returns the event times of each axis as sums of the waits.
fn times<const N: usize>(timers: AxisTimers<N>) -> ([Vec<u64>; N], u64) {
    let mut result = std::array::from_fn(|_| Vec::new());
    let (mut now, mut timers) = (0, timers);
    for (wait, mask) in timers.by_ref() {
        now += u64::from(wait);
        for (axis, list) in result.iter_mut().enumerate() {
            if mask & (1 << axis) != 0 {
                list.push(now);
            }
        }
    }
    (result, now + timers.rest_ticks())
}

proptest! {
    /// Event k of an axis with b events is at floor(((2 k - 1) T + b) / 2 b), and the move takes
    /// exactly T ticks.
    #[test]
    fn times_are_exact(
        ticks in 0_u64..1 << 40,
        shift in 0_u32..40,
        events in any::<[u16; 4]>(),
        cut in 0_u32..16,
    ) {
        let ticks = ticks >> shift;
        let events = events.map(|events| u32::from(events >> cut) % 3000);
        // A tick can hold one event per axis.
        prop_assume!(events.iter().all(|events| u64::from(*events) <= ticks));
        let (lists, end) = times(AxisTimers::new(ticks, events));
        for (list, b) in lists.iter().zip(events) {
            let (b, t) = (u128::from(b), u128::from(ticks));
            let exact: Vec<u64> = (1..=b)
                .map(|k| (((2 * k - 1) * t + b) / (2 * b)) as u64)
                .collect();
            prop_assert_eq!(list, &exact);
        }
        prop_assert_eq!(end, ticks);
    }

    /// No input panics, and every item waits or steps.
    #[test]
    fn any_numbers(ticks: u64, events: [u32; 9]) {
        for (wait, mask) in AxisTimers::new(ticks, events).take(500) {
            prop_assert!(wait != 0 || mask != 0);
        }
    }
}

/// More than 2^31 ticks without an event are split into several items.
#[test]
fn long_waits() {
    let items: Vec<(u32, u8)> = AxisTimers::new(10 << 31, [1]).collect();
    assert_eq!(
        items,
        [
            (1 << 31, 0),
            (1 << 31, 0),
            (1 << 31, 0),
            (1 << 31, 0),
            (1 << 31, 1)
        ]
    );
}
