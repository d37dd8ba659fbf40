//! The limits of the queue compared with two passes over the whole queue.

use husillo_planner::{LookAhead, Stretch, Upper};
use proptest::prelude::*;

use crate::moves::any_moves;

/// A move, and the speed and the acceleration of its upper level if it has one.
#[derive(Copy, Clone, Debug)]
struct Leveled {
    stretch: Stretch,
    upper: Option<(u32, u64)>,
}

impl Leveled {
    fn new(mut stretch: Stretch, from_nm_per_s: u32, above: u64) -> Self {
        let below = stretch.acceleration_nm_per_s2;
        let ceiling = stretch.ceiling_nm_per_s;
        stretch.upper = Upper::new(ceiling, from_nm_per_s, [below, above]);
        // As documented: parts in 2^-16, rounded down.
        let of = |whole: u128, part: u128| (whole * ((part << 16) / whole)) >> 16;
        let upper = (from_nm_per_s < ceiling && above < below).then(|| {
            let share = ((u128::from(above) << 16) / u128::from(below)).max(1);
            (
                of(ceiling.into(), from_nm_per_s.into()).max(1) as u32,
                ((u128::from(below) * share) >> 16).max(1) as u64,
            )
        });
        Leveled { stretch, upper }
    }
}

/// The square of the speed at the end of the first move, by a backward pass from rest over the
/// queue. `is_upper` is the plan with the acceleration of the upper levels; the other one stays
/// below them.
fn pass(queue: &[Leveled], percent: u8, is_upper: bool) -> u64 {
    let mut exit = 0_u128;
    let most = |one: &Leveled| match one.upper {
        Some((from, _)) if !is_upper => one.stretch.top_at(percent).min(from),
        _ => one.stretch.top_at(percent),
    };
    for pair in queue.windows(2).rev() {
        let acceleration = match pair[1].upper {
            Some((_, above)) if is_upper => above,
            _ => pair[1].stretch.acceleration_nm_per_s2,
        };
        let gain = 2 * u128::from(acceleration) * u128::from(pair[1].stretch.length_nm);
        let [before, after] = [most(&pair[0]), most(&pair[1])];
        let limit = pair[1].stretch.entry_limit_nm_per_s.min(before).min(after);
        exit = (exit + gain).min(u128::from(limit).pow(2));
    }
    exit as u64
}

fn exit_squared(queue: &[Leveled], percent: u8) -> u64 {
    pass(queue, percent, false).max(pass(queue, percent, true))
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
    /// The limits are exactly those of the faster of two full backward passes, whatever was pushed
    /// and popped before. A push never lowers them. `every` is the distance of the moves that have
    /// an upper level.
    #[test]
    fn limits_are_those_of_full_passes(
        moves in any_moves(40),
        actions in actions(),
        every in 1_usize..20,
        (knee, share) in (0.01..1.2_f64, 0.0..1.2_f64),
    ) {
        let stretches = moves.iter().enumerate().map(|(number, one)| {
            let Stretch { ceiling_nm_per_s, acceleration_nm_per_s2: below, .. } = one.stretch;
            let from = (f64::from(ceiling_nm_per_s) * knee) as u32;
            let above = (below as f64 * share) as u64;
            if number % every == every / 2 {
                Leveled::new(one.stretch, from, above)
            } else {
                Leveled { stretch: one.stretch, upper: None }
            }
        });
        let mut coming = stretches.cycle();
        let mut queue = LookAhead::<(), 7>::new();
        let (mut model, mut percent) = (Vec::new(), 100);
        for action in actions {
            match action {
                Action::Push => {
                    let (one, before) = (coming.next().unwrap(), queue.limits().exit_squared);
                    let stretch = one.stretch;
                    match queue.push(stretch, ()) {
                        Ok(()) => model.push(one),
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
                    let expected = (!model.is_empty()).then(|| model.remove(0).stretch);
                    prop_assert_eq!(popped, expected);
                }
                Action::Override(to) => {
                    percent = to;
                    queue.set_override(to);
                }
            }
            prop_assert_eq!(queue.len(), model.len());
            let [first, last] = [model.first(), model.last()].map(|one| one.map(|one| one.stretch));
            prop_assert_eq!(queue.front().map(|(stretch, ())| *stretch), first);
            prop_assert_eq!(queue.back().map(|(stretch, ())| *stretch), last);
            prop_assert_eq!(queue.limits().exit_squared, exit_squared(&model, percent));
            let top = first.map_or(0, |stretch| stretch.top_at(percent));
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
        hz: u32, sweep: u32, total: u64, ticks: u64, from_nm_per_s: u32, above: u64,
    ) {
        let accelerations = [acceleration_nm_per_s2, above];
        let upper = Upper::new(ceiling_nm_per_s, from_nm_per_s, accelerations);
        let stretch = Stretch {
            length_nm, top_nm_per_s, ceiling_nm_per_s, obeys_override,
            acceleration_nm_per_s2, start_nm_per_s, entry_limit_nm_per_s, upper,
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
        upper: None,
        entry_limit_nm_per_s: 0,
    };
    let mut queue = LookAhead::<u8, 0>::new();
    assert_eq!(queue.push(stretch, 7), Err((stretch, 7)));
    assert_eq!(queue.pop(), None);
}
