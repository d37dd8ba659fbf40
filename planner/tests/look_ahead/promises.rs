//! The limits of the queue compared with two passes over the whole queue.

use husillo_planner::{LookAhead, Stretch};
use proptest::prelude::*;

use crate::moves::any_moves;

/// The square of the speed at the end of the first move, by a backward pass from rest over the
/// queue.
fn exit_squared(queue: &[Stretch], percent: u8) -> u64 {
    let mut exit = 0_u128;
    for pair in queue.windows(2).rev() {
        let gain = 2 * u128::from(pair[1].acceleration_nm_per_s2) * u128::from(pair[1].length_nm);
        let limit = pair[1]
            .entry_limit_nm_per_s
            .min(pair[0].top_at(percent))
            .min(pair[1].top_at(percent));
        exit = (exit + gain).min(u128::from(limit).pow(2));
    }
    exit as u64
}

#[derive(Copy, Clone, Debug)]
enum Action {
    Push,
    Pop,
    Override(u8),
}

fn actions() -> impl Strategy<Value = Vec<Action>> {
    let action = prop_oneof![
        6 => Just(Action::Push),
        5 => Just(Action::Pop),
        1 => (10_u8..=200).prop_map(Action::Override),
    ];
    prop::collection::vec(action, 1..300)
}

proptest! {
    /// The limits are exactly those of a full backward pass, whatever was pushed and popped before.
    /// A push never lowers them.
    #[test]
    fn limits_are_those_of_a_full_pass(moves in any_moves(40), actions in actions()) {
        let mut coming = moves.iter().map(|one| one.stretch).cycle();
        let mut queue = LookAhead::<(), 7>::new();
        let (mut model, mut percent) = (Vec::new(), 100);
        for action in actions {
            match action {
                Action::Push => {
                    let (stretch, before) = (coming.next().unwrap(), queue.limits().exit_squared);
                    match queue.push(stretch, ()) {
                        Ok(()) => model.push(stretch),
                        Err((back, ())) => {
                            prop_assert_eq!(back, stretch);
                            prop_assert_eq!(model.len(), 7);
                            prop_assert!(queue.is_full());
                        }
                    }
                    prop_assert!(queue.limits().exit_squared >= before);
                }
                Action::Pop => {
                    let popped = queue.pop().map(|(stretch, ())| stretch);
                    let expected = (!model.is_empty()).then(|| model.remove(0));
                    prop_assert_eq!(popped, expected);
                }
                Action::Override(to) => {
                    percent = to;
                    queue.set_override(to);
                }
            }
            prop_assert_eq!(queue.len(), model.len());
            prop_assert_eq!(queue.front().map(|(stretch, ())| stretch), model.first());
            prop_assert_eq!(queue.back().map(|(stretch, ())| stretch), model.last());
            prop_assert_eq!(queue.limits().exit_squared, exit_squared(&model, percent));
            let top = model.first().map_or(0, |stretch| stretch.top_at(percent));
            prop_assert_eq!(queue.limits().top_nm_per_s, top);
        }
        queue.clear();
        prop_assert!(queue.is_empty());
        prop_assert_eq!(queue.limits().exit_squared, 0);
    }

    /// No input panics, and out-of-range values are taken as the nearest possible ones.
    #[test]
    fn any_numbers_do(
        length_nm: u64, top_nm_per_s: u32, ceiling_nm_per_s: u32, acceleration_nm_per_s2: u64,
        start_nm_per_s: u32, entry_limit_nm_per_s: u32, obeys_override: bool, percent: u8,
        hz: u32, sweep: u32, total: u64, ticks: u64,
    ) {
        let stretch = Stretch {
            length_nm, top_nm_per_s, ceiling_nm_per_s, obeys_override,
            acceleration_nm_per_s2, start_nm_per_s, entry_limit_nm_per_s,
        };
        let mut queue = LookAhead::<(), 3>::new();
        let mut ramp = husillo_planner::Ramp::new(hz);
        queue.set_override(percent);
        for _ in 0..4 {
            let _ = queue.push(stretch, ());
        }
        while queue.pop().is_some() {
            ramp.begin(&stretch, total, sweep, ticks);
            for _ in 0..3 {
                prop_assert!(ramp.wait(sweep, queue.limits()).is_some());
            }
            ramp.hold();
            for _ in 0..3 {
                ramp.wait(sweep, queue.limits());
            }
            ramp.resume();
        }
    }
}

/// A queue without room returns every move.
#[test]
fn no_room_at_all() {
    let stretch = Stretch {
        length_nm: 1,
        top_nm_per_s: 1,
        ceiling_nm_per_s: 1,
        obeys_override: true,
        acceleration_nm_per_s2: 1,
        start_nm_per_s: 0,
        entry_limit_nm_per_s: 0,
    };
    let mut queue = LookAhead::<u8, 0>::new();
    assert_eq!(queue.push(stretch, 7), Err((stretch, 7)));
    assert_eq!(queue.pop(), None);
}
