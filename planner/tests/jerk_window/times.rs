//! How much longer the path takes than with limited acceleration alone.

use husillo_planner::JerkLimits;

use crate::{
    moves::{CHORD_NM, Move, line, machine, random_moves},
    runner::{Disturbance, run},
};

/// Time in s of the fastest path with limited acceleration, if all moves are known.
fn trapezoid(moves: &[Move], limits: &JerkLimits) -> f64 {
    let a = limits.acceleration_nm_per_s2 as f64;
    let tops: Vec<f64> = moves
        .iter()
        .map(|one| f64::from(one.stretch.top_nm_per_s.min(limits.highest_nm_per_s)))
        .collect();
    let mut speeds = vec![0.0; moves.len() + 1];
    for at in (1..moves.len()).rev() {
        let gain = 2.0 * a * moves[at].stretch.length_nm as f64;
        let limit = f64::from(moves[at].stretch.entry_limit_nm_per_s);
        let limit = limit.min(tops[at - 1]).min(tops[at]);
        let after: f64 = speeds[at + 1];
        speeds[at] = limit.min((after * after + gain).sqrt());
    }
    let mut time = 0.0;
    for (at, one) in moves.iter().enumerate() {
        let length = one.stretch.length_nm as f64;
        let before: f64 = speeds[at];
        let after = speeds[at + 1].min((before * before + 2.0 * a * length).sqrt());
        speeds[at + 1] = after;
        let peak = ((before * before + after * after) / 2.0 + a * length).sqrt();
        let peak = peak.min(tops[at]);
        let ramps = (2.0 * peak * peak - before * before - after * after) / (2.0 * a);
        time += (2.0 * peak - before - after) / a + (length - ramps).max(0.0) / peak;
    }
    time
}

fn seconds(moves: &[Move], limits: JerkLimits) -> f64 {
    let mut random = oorandom::Rand64::new(1);
    let seen = run::<1024>(limits, moves, Disturbance::default(), &mut random);
    assert!(!seen.fault(), "{seen:?}");
    seen.seconds
}

fn ratio(moves: &[Move], limits: JerkLimits) -> f64 {
    seconds(moves, limits) / trapezoid(moves, &limits)
}

/// Lines with corners, most of them shorter than 1 mm.
#[test]
fn real_corners_cost_few_percent() {
    let mut random = oorandom::Rand64::new(7);
    let mut lines = random_moves(&mut random, 8_000);
    lines.retain(|one| one.stretch.length_nm != CHORD_NM);
    for (window, most) in [(10, 1.005), (50, 1.023)] {
        let ratio = ratio(&lines, machine(1, window));
        assert!(ratio < most, "{window} ms: {ratio}");
    }
}

/// Chords of 20 um without corners, in runs of about 1.5 mm at different speeds.
#[test]
fn chords_follow_the_programmed_speeds() {
    let mut random = oorandom::Rand64::new(7);
    let mut chords = random_moves(&mut random, 8_000);
    chords.retain(|one| one.stretch.length_nm == CHORD_NM);
    for one in &mut chords {
        one.stretch.entry_limit_nm_per_s = u32::MAX;
    }
    for (window, most) in [(10, 1.012), (50, 1.062)] {
        let ratio = ratio(&chords, machine(1, window));
        println!("{window} ms: {ratio}");
        assert!(ratio < most, "{window} ms: {ratio}");
    }
}

/// Chords without corners at one speed take one window more than the trapezoid, and at most one
/// slice.
#[test]
fn a_run_of_chords_is_one_move() {
    for (count, length, top) in [(5_000, 20_000, 50_000_000), (2_000, 100_000, 100_000_000)] {
        let moves = vec![line(length, top, u32::MAX); count];
        for window_ms in [10, 50] {
            let limits = machine(1, window_ms);
            let window = window_ms as f64 / 1000.0;
            let more = seconds(&moves, limits) - trapezoid(&moves, &limits) - window;
            assert!(
                (0.0..window / 8.0).contains(&more),
                "{length} {window_ms}: {more}"
            );
        }
    }
}

/// Single moves beside the seven phases of the time-optimal profile, at 1 m/s^2 and 20 m/s^3.
#[test]
fn single_moves_are_near_the_optimum() {
    let limits = machine(1, 50);
    let (a, t) = (1e9, 0.05);
    let j = a / t;
    for (length, most) in [
        (200_000_000, 1.0025),
        (50_000_000, 1.007),
        (10_000_000, 1.014),
        (1_000_000, 1.006),
        (100_000, 1.006),
        (10_000, 1.006),
    ] {
        let path = length as f64;
        // Without and with a phase of constant acceleration, and with the top speed of 300 mm/s.
        let best = if path <= 2.0 * a * t * t {
            4.0 * (path / 2.0 / j).cbrt()
        } else {
            let ramp = ((t * t + 4.0 * path / a).sqrt() - t) / 2.0;
            if a * ramp <= 3e8 {
                2.0 * (ramp + t)
            } else {
                path / 3e8 + 3e8 / a + t
            }
        };
        let ratio = seconds(&[line(length, 300_000_000, 0)], limits) / best;
        println!("{length} nm: {ratio}");
        assert!((0.999..most).contains(&ratio), "{length}: {ratio}");
    }
}

/// A slow move at the end does not make the one before it slow, even if a slice is long enough for
/// more than the whole path.
#[test]
fn a_slow_end_is_reached_at_full_speed() {
    let limits = JerkLimits {
        acceleration_nm_per_s2: 77_000_000_000,
        jerk_nm_per_s3: 385_000_000_000, // a window of 200 ms
        highest_nm_per_s: 31_622_776,
    };
    let moves = [
        line(859_337, 859_337, 0),
        line(0, 100, u32::MAX),
        line(10, 100, u32::MAX),
    ];
    let seconds = seconds(&moves, limits);
    assert!(seconds < 1.6, "{seconds}");
}
