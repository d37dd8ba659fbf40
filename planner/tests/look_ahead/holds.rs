//! Hold, resume and override at any event.

use proptest::prelude::*;

use crate::{
    checker::{check_axes, check_path},
    moves::{any_moves, any_polyline},
    runner::{Wish, run},
};

const HZ: u32 = 32_000_000;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A hold stops within v^2 / 2a, across as many moves as necessary. After it is resumed, no
    /// event is lost.
    #[test]
    fn a_hold_stops_and_loses_nothing(moves in any_polyline(), at in any::<prop::sample::Index>()) {
        let count = moves.iter().map(|one| one.sweeps.len()).sum();
        let at = at.index(count);
        let result = run::<8>(&moves, HZ, &[(at, Wish::Hold)]);
        let events = &result.events;
        prop_assert_eq!(events.len(), count);
        prop_assert_eq!(result.stops, 1);
        // If the path was at rest already, it stops at once.
        let stop = events.iter().position(|event| event.is_after_stop).unwrap();
        prop_assert!(stop >= at);
        let speed = match at {
            0 => 0.0,
            at => f64::from(events[at - 1].speed_nm_per_s) + 1.0,
        };
        // The square falls by 2 a ds in every event; where accelerations differ, by their mean.
        let mut squared = speed * speed;
        for event in &events[at..stop] {
            prop_assert!(squared >= 0.0, "late by {event:?}");
            let acceleration = moves[event.of].stretch.acceleration_nm_per_s2 as f64;
            squared -= 2.0 * acceleration * event.length_nm - 1.0;
        }
        // The events before and after the hold are checked separately.
        let (before, after) = events.split_at(stop);
        for part in [before, after] {
            check_path(&moves, part, HZ, 1.0, false);
            check_path(&moves, part, HZ, 10_000.0, false);
            check_axes(&moves, part, HZ, false);
        }
    }

    /// Overrides at random events change the speed with the acceleration of the path, and no corner
    /// is passed faster than its limit.
    #[test]
    fn overrides_change_smoothly(
        moves in any_polyline(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 10_u8..=200), 1..6),
    ) {
        let count = moves.iter().map(|one| one.sweeps.len()).sum();
        let wishes: Vec<_> = changes
            .into_iter()
            .map(|(at, percent)| (at.index(count), Wish::Override(percent)))
            .collect();
        let events = run::<8>(&moves, HZ, &wishes).events;
        prop_assert_eq!(events.len(), count);
        check_path(&moves, &events, HZ, 1.0, false);
        check_path(&moves, &events, HZ, 10_000.0, false);
        check_axes(&moves, &events, HZ, false);
        for event in &events {
            let speed = event.length_nm * f64::from(HZ) / event.ticks as f64;
            let ceiling = f64::from(moves[event.of].stretch.ceiling_nm_per_s);
            prop_assert!(speed <= ceiling + 1.0 + speed / event.ticks as f64, "{event:?}");
        }
        for pair in events.windows(2).filter(|pair| pair[0].of != pair[1].of) {
            let limit = moves[pair[1].of].stretch.entry_limit_nm_per_s;
            prop_assert!(
                f64::from(pair[0].speed_nm_per_s) <= f64::from(limit) * (1.0 + 1e-6) + 10.0,
                "{pair:?}"
            );
        }
    }

    /// Holds and overrides in sequence, with moves of all kinds: every event is made.
    #[test]
    fn everything_at_once(
        moves in any_moves(20),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0_u8..=200), 1..12),
    ) {
        let count = moves.iter().map(|one| one.sweeps.len()).sum();
        let wishes: Vec<_> = changes
            .into_iter()
            .map(|(at, percent)| {
                let wish = if percent < 100 { Wish::Hold } else { Wish::Override(percent) };
                (at.index(count), wish)
            })
            .collect();
        let result = run::<5>(&moves, HZ, &wishes);
        prop_assert_eq!(result.events.len(), count);
        let events = &result.events;
        let mut part = Vec::new();
        for event in events {
            if event.is_after_stop {
                check_path(&moves, &part, HZ, 1.0, false);
                part.clear();
            }
            part.push(*event);
        }
        check_path(&moves, &part, HZ, 1.0, false);
    }
}
