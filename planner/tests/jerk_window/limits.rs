//! Nothing exceeds a limit, whatever happens.

use proptest::prelude::*;

use crate::{
    checker::Seen,
    moves::{MACHINES, any_machine, any_moves, random_moves},
    runner::{Disturbance, run},
};

fn check<const CAPACITY: usize>(disturbance: Disturbance, count: usize) {
    for (number, limits) in MACHINES.into_iter().enumerate() {
        let mut seen = Seen::default();
        for seed in 0..4 {
            let mut random = oorandom::Rand64::new(seed + 10 * number as u128);
            let moves = random_moves(&mut random, count);
            seen.join(&run::<CAPACITY>(limits, &moves, disturbance, &mut random));
        }
        assert!(!seen.fault(), "{limits:?} {disturbance:?} {seen:?}");
    }
}

#[test]
fn a_full_queue_keeps_all_limits() {
    check::<32>(Disturbance::default(), 2_800);
}

#[test]
fn a_starved_queue_keeps_all_limits() {
    for moves_per_slice in [0.1, 0.3, 1.0] {
        let starved = Disturbance {
            moves_per_slice,
            changes: 0.0,
        };
        check::<16>(starved, 1_000);
    }
}

#[test]
fn holds_and_overrides_keep_all_limits() {
    for changes in [0.003, 0.05] {
        let disturbed = Disturbance {
            moves_per_slice: 0.0,
            changes,
        };
        check::<32>(disturbed, 1_500);
    }
}

/// A move with less acceleration than the path is slower, so that it keeps its own.
#[test]
fn moves_keep_their_own_acceleration() {
    let mut random = oorandom::Rand64::new(11);
    for limits in MACHINES {
        let mut moves = random_moves(&mut random, 2_000);
        for one in &mut moves {
            if random.rand_range(0..3) == 0 {
                let share = random.rand_range(2..100);
                one.stretch.acceleration_nm_per_s2 = limits.acceleration_nm_per_s2 * share / 100;
            }
        }
        for changes in [0.0, 0.02] {
            let disturbance = Disturbance {
                moves_per_slice: 0.0,
                changes,
            };
            let seen = run::<64>(limits, &moves, disturbance, &mut random);
            assert!(!seen.fault() && seen.own > 0.5, "{limits:?} {seen:?}");
        }
    }
}

proptest! {
    // A case integrates up to a minute of motion.
    #![proptest_config(ProptestConfig::with_cases(ProptestConfig::default().cases / 4))]

    /// Any moves on any machine, with queues of any length, however fast moves arrive, and with
    /// holds and overrides at random.
    #[test]
    fn anything_keeps_all_limits(
        limits in any_machine(),
        moves in any_moves(),
        moves_per_slice in prop_oneof![Just(0.0), 0.02..2.0_f64],
        changes in prop_oneof![Just(0.0), 0.001..0.1_f64],
        capacity in 0..3,
        seed: u64,
    ) {
        let disturbance = Disturbance { moves_per_slice, changes };
        let mut random = oorandom::Rand64::new(seed.into());
        let seen = match capacity {
            0 => run::<2>,
            1 => run::<5>,
            _ => run::<32>,
        }(limits, &moves, disturbance, &mut random);
        prop_assert!(!seen.fault(), "{seen:?}");
    }
}
