//! Moves with two levels of acceleration, as arcs have them. The checker uses the events alone.

use husillo_planner::Upper;
use proptest::prelude::*;

use crate::{
    checker::check_path,
    moves::{Move, any_moves},
    runner::{Event, Wish, run},
};

const HZ: u32 = 32_000_000;

/// A move, and the speed and the acceleration of its upper level.
type Level = Option<(f64, f64)>;

/// Moves of any kind, most of them with two levels.
fn any_levels(longest: usize) -> impl Strategy<Value = (Vec<Move>, Vec<Level>)> {
    (any_moves(longest), 0.2..1.2_f64, 0.05..1.0_f64).prop_map(|(mut moves, knee, share)| {
        let mut levels = Vec::new();
        for (number, one) in moves.iter_mut().enumerate() {
            let stretch = &mut one.stretch;
            let from = (f64::from(stretch.top_nm_per_s) * knee) as u32;
            let below = stretch.acceleration_nm_per_s2;
            let above = (below as f64 * share) as u64;
            let has_upper = number % 4 != 3;
            if has_upper {
                stretch.upper = Upper::new(stretch.ceiling_nm_per_s, from, [below, above]);
            }
            levels.push(has_upper.then_some((f64::from(from), above.max(1) as f64)));
            // Uneven events hide the acceleration: the cubic is known to a part of the largest one.
            one.sweeps.fill(1 << 16);
        }
        (moves, levels)
    })
}

/// No two events differ by more than the acceleration at the lower one of their speeds.
fn check_levels(
    moves: &[Move],
    levels: &[Level],
    events: &[Event],
    late: f64,
) -> Result<(), TestCaseError> {
    let speed = |event: &Event| event.length_nm * f64::from(HZ) / event.ticks as f64;
    for (number, pair) in events.windows(2).enumerate() {
        if pair[1].is_after_stop {
            continue;
        }
        // An event may lie across the level, and its mean speed above it. Where the events around
        // it are above the level, too, it is so as a whole.
        let around = |at: Option<usize>| {
            let event = at.and_then(|at| events.get(at));
            event
                .filter(|event| event.of == pair[0].of && event.of == pair[1].of)
                .map_or(0.0, speed)
        };
        let mut around = around(number.checked_sub(1)).min(around(Some(number + 2)));
        let after = events.get(number + 2);
        if pair[0].is_after_stop || after.is_some_and(|after| after.is_after_stop) {
            around = 0.0;
        }
        let [first, second] = [speed(&pair[0]), speed(&pair[1])];
        let seconds = (pair[0].ticks + pair[1].ticks + 2) as f64 / 2.0 / f64::from(HZ);
        let slowest = around.min(first).min(second);
        let limit = |event: &Event| match levels[event.of] {
            Some((from, above)) if slowest > from + 4.0 => above,
            _ => moves[event.of].stretch.acceleration_nm_per_s2 as f64,
        };
        let limit = limit(&pair[0]).max(limit(&pair[1]));
        let tick = [0, 1].map(|side| {
            let ticks = pair[side].ticks as f64;
            speed(&pair[side]) * (1.0 + late * ticks) / (ticks - 1.0)
        });
        let most = limit * seconds * 1.036 + tick[0] + tick[1] + 4.0;
        prop_assert!(
            (second - first).abs() <= most,
            "{first} to {second} with {most} at {pair:?} of {:?}",
            moves[pair[0].of].stretch
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Above the level only its acceleration is used, whatever the queue, holds and overrides.
    #[test]
    fn each_level_keeps_its_acceleration(
        (moves, levels) in any_levels(20),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0_u8..=200), 0..6),
    ) {
        let events = run::<64>(&moves, HZ, &[]).events;
        check_levels(&moves, &levels, &events, 0.0)?;
        check_path(&moves, &events, HZ, 1.0, true);
        for pair in events.windows(2).filter(|pair| pair[0].of != pair[1].of) {
            let limit = moves[pair[1].of].stretch.entry_limit_nm_per_s;
            prop_assert!(
                f64::from(pair[0].speed_nm_per_s) <= f64::from(limit) * (1.0 + 1e-6) + 1e3,
                "{pair:?}"
            );
        }
        prop_assert!(events.last().unwrap().speed_nm_per_s < 1000);
        let count = events.len();
        let wishes: Vec<_> = changes
            .into_iter()
            .map(|(at, percent)| match percent {
                0..100 => (at.index(count), Wish::Hold),
                _ => (at.index(count), Wish::Override(percent)),
            })
            .collect();
        let result = run::<5>(&moves, HZ, &wishes);
        prop_assert_eq!(result.events.len(), count);
        check_levels(&moves, &levels, &result.events, 0.04)?;
        let corners = result.events.windows(2).filter(|pair| pair[0].of != pair[1].of);
        for pair in corners.filter(|pair| !pair[1].is_after_stop) {
            let limit = moves[pair[1].of].stretch.entry_limit_nm_per_s;
            prop_assert!(
                f64::from(pair[0].speed_nm_per_s) <= f64::from(limit) * (1.0 + 1e-6) + 1e3,
                "{pair:?}"
            );
        }
    }

    /// The upper level only makes moves faster: without it they stay below the level.
    #[test]
    fn two_levels_are_no_slower_than_one((moves, levels) in any_levels(20)) {
        let below: Vec<Move> = moves.iter().cloned().zip(levels).map(|(mut one, level)| {
            if let (Some((from, _)), Some(_)) = (level, one.stretch.upper.take()) {
                one.stretch.ceiling_nm_per_s = one.stretch.ceiling_nm_per_s.min(from as u32);
                one.stretch.top_nm_per_s = one.stretch.top_nm_per_s.min(from as u32);
            }
            one
        }).collect();
        let time = |moves: &[Move]| {
            run::<64>(moves, HZ, &[]).events.iter().map(|event| event.ticks).sum::<u64>()
        };
        let [two, one] = [time(&moves), time(&below)];
        prop_assert!(two as f64 <= one as f64 * 1.000_01 + 10.0, "{two} {one}");
    }
}
