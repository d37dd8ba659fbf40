//! Machines, and lists of moves.

use husillo_planner::{JerkLimits, Stretch};
use proptest::prelude::*;

pub const CHORD_NM: u64 = 20_000;

#[derive(Clone, Debug)]
pub struct Move {
    pub stretch: Stretch,
}

/// Acceleration in m/s^2, window in ms.
pub const fn machine(acceleration: u64, window_ms: u64) -> JerkLimits {
    let acceleration_nm_per_s2 = acceleration * 1_000_000_000;
    JerkLimits {
        acceleration_nm_per_s2,
        jerk_nm_per_s3: acceleration_nm_per_s2 * 1000 / window_ms,
        highest_nm_per_s: 300_000_000,
    }
}

pub const MACHINES: [JerkLimits; 3] = [machine(1, 10), machine(1, 50), machine(5, 50)];

pub fn line(length_nm: u64, top_nm_per_s: u32, entry_limit_nm_per_s: u32) -> Move {
    Move {
        stretch: Stretch {
            length_nm,
            top_nm_per_s,
            ceiling_nm_per_s: 300_000_000,
            obeys_override: true,
            acceleration_nm_per_s2: 1_000_000_000,
            start_nm_per_s: 0,
            upper: None,
            entry_limit_nm_per_s,
        },
    }
}

/// Runs of chords of 20 um, lines up to 50 mm; corners from 0 to 1 m/s; tops from 1 to 150 mm/s.
pub fn random_moves(random: &mut oorandom::Rand64, count: usize) -> Vec<Move> {
    let mut moves = Vec::new();
    let mut float = |low: f64, high: f64| low + random.rand_float() * (high - low);
    while moves.len() < count {
        let top = 10_f64.powf(float(6.0, 8.176)) as u32;
        let kind = float(0.0, 1.0);
        if kind < 0.5 {
            let corner = 10_f64.powf(float(6.0, 9.0)) as u32;
            for _ in 0..float(1.0, 150.0) as usize {
                moves.push(line(
                    CHORD_NM,
                    top,
                    (f64::from(corner) * float(0.8, 1.0)) as u32,
                ));
            }
        } else {
            let length = 10_f64.powf(float(3.0, 7.7)) as u64;
            let corner = match float(0.0, 1.0) {
                kind if kind < 0.1 => 0,
                kind if kind < 0.3 => 1_000_000_000,
                _ => 10_f64.powf(float(5.0, 8.5)) as u32,
            };
            moves.push(line(length, top, corner));
        }
    }
    moves.truncate(count);
    moves
}

/// Lists of up to 60 moves of any kind, from 0 nm to 1 m.
pub fn any_moves() -> impl Strategy<Value = Vec<Move>> {
    let length = prop_oneof![
        Just(0.0..0.1_f64),
        Just(1.0..5.0),
        Just(4.0..6.0),
        Just(6.0..9.0)
    ];
    let entry = prop_oneof![Just(0), Just(u32::MAX), (3.0..9.0_f64).prop_map(power)];
    let one = (
        length.prop_flat_map(|range| range),
        2.0..9.3_f64,
        entry,
        1.0..2.0_f64,
        any::<bool>(),
        prop_oneof![Just(11.0), 6.0..11.0_f64],
    );
    let one = one.prop_map(
        |(length, top, entry_limit_nm_per_s, room, obeys_override, acceleration)| {
            // At most a second.
            let length = power(length) - 1;
            let top = power(top).max(length);
            let mut one = line(length.into(), top, entry_limit_nm_per_s);
            one.stretch.ceiling_nm_per_s = (f64::from(top) * room) as u32;
            one.stretch.obeys_override = obeys_override;
            // In the shortest window it reaches a speed at which it takes a second.
            let least = 1000 * u64::from(length);
            one.stretch.acceleration_nm_per_s2 = (10_f64.powf(acceleration) as u64).max(least);
            one
        },
    );
    prop::collection::vec(one, 1..60)
}

/// Machines of 0.01 to 100 m/s^2, with windows of 1 to 200 ms.
pub fn any_machine() -> impl Strategy<Value = JerkLimits> {
    (7.0..11.0_f64, -3.0..-0.7_f64, 7.5..9.5_f64).prop_map(|(acceleration, window, highest)| {
        let acceleration = 10_f64.powf(acceleration);
        JerkLimits {
            acceleration_nm_per_s2: acceleration as u64,
            jerk_nm_per_s3: (acceleration / 10_f64.powf(window)) as u64,
            highest_nm_per_s: power(highest),
        }
    })
}

fn power(exponent: f64) -> u32 {
    10_f64.powf(exponent) as u32
}
