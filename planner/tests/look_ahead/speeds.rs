//! As fast as allowed, never faster.

use proptest::prelude::*;

use crate::{
    checker::{Optimum, check_axes, check_path},
    moves::{Move, any_moves, any_polyline, polyline},
    runner::{Wish, run},
};

const HZ: u32 = 32_000_000;

/// Compares the clock with the best possible one: with all moves in the queue no event is earlier
/// or later.
///
/// An event where the acceleration changes takes the time of the mean of its speeds. In the others
/// the cubic is at most 0.04 of an interval off.
fn check_against_optimum(moves: &[Move], percent: u8) -> Result<(), TestCaseError> {
    let best = Optimum::new(moves, percent);
    let events = run::<256>(moves, HZ, &[(0, Wish::Override(percent))]).events;
    let hz = f64::from(HZ);
    let (mut clock, mut begun, mut slack) = (0.0, 0.0, 2.0);
    let (mut of, mut at) = (0, 0.0);
    for event in &events {
        let one = &moves[event.of];
        if event.of != of {
            let length = moves[of].stretch.length_nm as f64;
            begun += best.at(of, &moves[of], percent, length, 0.0).1 * hz;
            (of, at) = (event.of, 0.0);
        }
        let before = best.at(of, one, percent, at, 0.0).1 * hz;
        at += event.length_nm;
        // The next grains count as well.
        let grain = one.length_of(*one.sweeps.iter().max().unwrap());
        let around = grain + event.length_nm;
        let (speed, seconds, is_corner) = best.at(of, one, percent, at, around);
        clock += event.ticks as f64;
        let ticks = seconds * hz - before;
        let scale = ticks * grain.max(event.length_nm) / event.length_nm;
        let gain = 2.0 * one.stretch.acceleration_nm_per_s2 as f64 * grain;
        if is_corner {
            slack += scale * (gain / (speed * speed + gain)).min(0.5);
        }
        slack += ticks * (2.0 / (event.length_nm * hz / ticks) + 1e-7);
        let exact = begun + seconds * hz;
        let most = slack + 0.04 * scale;
        prop_assert!(
            f64::abs(clock - exact) <= most,
            "{clock} for {exact} +- {most}, to {speed}, {event:?}"
        );
        let error = f64::abs(f64::from(event.speed_nm_per_s) - speed);
        // Within a grain with a corner the square is taken as linear.
        let corner = if is_corner {
            gain / (speed + gain.sqrt())
        } else {
            0.0
        };
        // The model knows the place to 1e-6 nm.
        let place = 2e-6 * one.stretch.acceleration_nm_per_s2 as f64;
        let corner = corner + place / (speed + place.sqrt());
        prop_assert!(
            error <= 2.0 + speed * 1e-6 + 8.0 / speed.max(1.0).sqrt() + corner,
            "{speed} for {event:?}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// With a queue long enough every event happens at the time of the best possible motion.
    #[test]
    fn a_long_queue_is_optimal(moves in any_moves(30), percent in 10_u8..=200) {
        check_against_optimum(&moves, percent)?;
    }

    /// The same holds on polylines with corners.
    #[test]
    fn polylines_are_optimal(moves in any_polyline()) {
        check_against_optimum(&moves, 100)?;
    }

    /// However short the queue is, speed, acceleration and jump of path and axes stay within their
    /// limits.
    #[test]
    fn a_short_queue_keeps_the_limits(moves in any_polyline()) {
        let events = run::<3>(&moves, HZ, &[]).events;
        check_path(&moves, &events, HZ, 1.0, true);
        check_path(&moves, &events, HZ, 10_000.0, true);
        check_axes(&moves, &events, HZ, true);
    }

    /// A shorter queue is never faster.
    #[test]
    fn a_longer_queue_is_no_slower(moves in any_polyline()) {
        let time = |events: Vec<crate::runner::Event>| {
            events.iter().map(|event| event.ticks).sum::<u64>()
        };
        let [two, eight, all] = [
            time(run::<2>(&moves, HZ, &[]).events),
            time(run::<8>(&moves, HZ, &[]).events),
            time(run::<64>(&moves, HZ, &[]).events),
        ];
        prop_assert!(all <= eight + 1 && eight <= two + 1, "{all} {eight} {two}");
    }

    /// The path stops where a move must be entered at rest, and at the end.
    #[test]
    fn stops_are_stops(moves in any_moves(10)) {
        let events = run::<4>(&moves, HZ, &[]).events;
        let last = events.last().unwrap();
        prop_assert!(last.speed_nm_per_s < 10, "{last:?}");
        for pair in events.windows(2) {
            if pair[0].of != pair[1].of && moves[pair[1].of].stretch.entry_limit_nm_per_s == 0 {
                prop_assert!(pair[0].speed_nm_per_s < 10, "{pair:?}");
            }
        }
    }

    /// Where the start speed is the top speed, every event is at the time of constant speed,
    /// without ramps: within one tick at the end of a move, and within 1.25 ticks before.
    #[test]
    fn without_ramps_time_is_the_programmed_one(
        moves in any_moves(10),
        hz in 10_000_u32..40_000_000,
    ) {
        let moves: Vec<Move> = moves.into_iter().map(|mut one| {
            one.stretch.start_nm_per_s = one.stretch.ceiling_nm_per_s;
            one
        }).collect();
        let (mut clock, mut exact) = (0_u128, 0_u128);
        let mut so_far = 0;
        for event in run::<4>(&moves, hz, &[]).events {
            let now = &moves[event.of];
            clock += u128::from(event.ticks);
            so_far += u128::from(event.sweep);
            let part = exact
                + u128::from(now.cruise_ticks_q16(hz)) * so_far / u128::from(now.total());
            let late = (clock << 16) as i128 - part as i128;
            prop_assert!((-0x1_4000..=0x1_0000).contains(&late), "{clock} {part}");
            if so_far == u128::from(now.total()) {
                prop_assert!((-0x1_0000 + 1..=0x1_0000).contains(&late), "{clock} {part}");
                exact += u128::from(now.cruise_ticks_q16(hz));
                so_far = 0;
            }
        }
    }
}

/// A long line made of many short ones takes the time of one trapezoid: 100 mm at a slow feed of 2
/// mm/min, and at 20 mm/s.
#[test]
fn short_lines_take_the_time_of_one() {
    for (feed, pieces, piece_nm) in [(33_333, 200, 20_000), (20_000_000, 5_000, 20_000)] {
        let points: Vec<_> = (1..=pieces)
            .map(|number| ([number * piece_nm, 0], feed))
            .collect();
        let events = run::<64>(&polyline(&points), HZ, &[]).events;
        let seconds = events.iter().map(|event| event.ticks).sum::<u64>() as f64 / f64::from(HZ);
        let [feed, a] = [f64::from(feed), 300e6];
        let exact = (pieces * piece_nm) as f64 / feed + feed / a;
        // The events at the ends of the ramps are cut at the top speed: each costs a part of the
        // time of one event.
        let slack = 2.0 * 1000.0 / feed;
        assert!((seconds - exact).abs() < slack, "{seconds} for {exact}");
    }
}
