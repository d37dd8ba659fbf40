//! What holds for every backlash and every walk.

use husillo_backlash::{Backlash, BacklashModel, Compensator, Flank, Play};
use proptest::prelude::*;

fn flank() -> impl Strategy<Value = Flank> {
    prop_oneof![
        Just(Flank::Unknown),
        Just(Flank::Positive),
        Just(Flank::Negative)
    ]
}

/// A walk on two axes, one step an event at most.
fn walk() -> impl Strategy<Value = Vec<[i8; 2]>> {
    proptest::collection::vec([-1i8..=1, -1i8..=1], 0..300)
}

/// A backlash of its own in every hundred steps of travel.
struct Regions {
    last: i8,
}

impl Regions {
    fn backlash(load: i32) -> u32 {
        load.div_euclid(100).unsigned_abs() % 7
    }
}

impl BacklashModel<2> for Regions {
    fn take_up(&mut self, axis: usize, direction: i8, load: &[i32; 2]) -> u32 {
        let load = load[axis];
        let turned = self.last * direction < 0;
        if direction != 0 {
            self.last = direction;
        }
        if turned { Self::backlash(load) } else { 0 }
    }
}

/// An axis may begin within its play: the rest is taken up, in either direction.
#[test]
fn an_axis_begins_within_its_play() {
    let owed = |ahead, directions: [i8; 4]| {
        let mut play = Play::at(10, ahead, -7);
        directions.map(|direction| BacklashModel::<1>::take_up(&mut play, 0, direction, &[0]))
    };
    assert_eq!(owed(3, [0, 1, 1, -1]), [0, 7, 0, 10]);
    assert_eq!(owed(3, [-1, -1, 0, 1]), [3, 0, 0, 10]);
    // Not more ahead than the backlash.
    assert_eq!(owed(12, [1, -1, 1, 0]), [0, 10, 10, 0]);
    assert_eq!(Play::at(10, 3, -7).load(), -7);
}

proptest! {
    /// The motor position of a load position leads back to it, everywhere in i32 and for every
    /// backlash.
    #[test]
    fn load_of_target_is_the_load(
        backlash in any::<u32>(), flank in flank(), loads in proptest::collection::vec(
            any::<i32>(),
            1..50,
        ),
    ) {
        let mut axis = Backlash::new(backlash, flank);
        for load in loads {
            let motor = axis.motor_target(load);
            prop_assert_eq!(axis.load_position(motor), load);
        }
    }

    /// Targets and take-up agree: step by step, the motor has made exactly the steps that the
    /// target asks for.
    #[test]
    fn steps_arrive_at_the_target(backlash in 0u32..50, flank in flank(), walk in walk()) {
        let mut by_steps = Backlash::new(backlash, flank);
        let mut by_target = by_steps;
        let mut motor = by_target.motor_target(0);
        let mut load = 0;
        for [delta, _] in walk {
            motor += i32::from(delta) * (by_steps.take_up(0, delta, &[load]) as i32 + 1);
            load += i32::from(delta);
            prop_assert_eq!(by_target.motor_target(load), motor);
            prop_assert_eq!(by_steps.load_position(motor), load);
        }
    }

    /// A nut with that play stands on the commanded point after every event, and never moves in a
    /// take-up.
    #[test]
    fn the_nut_is_where_it_was_sent(backlash in [0u32..20, 0u32..20], walk in walk()) {
        let axes = backlash.map(|steps| Backlash::new(steps, Flank::Positive));
        let mut stage = Compensator::new(axes);
        let (mut motor, mut nut, mut load) = ([0i32; 2], [0i32; 2], [0i32; 2]);
        for delta in walk {
            let owed = stage.before(&delta, load);
            for axis in 0..2 {
                let (play, step) = (backlash[axis] as i32, i32::from(delta[axis]));
                motor[axis] += step * owed[axis] as i32;
                let before = nut[axis];
                nut[axis] = nut[axis].clamp(motor[axis], motor[axis] + play);
                prop_assert_eq!(nut[axis], before, "take-up moves no nut");
                motor[axis] += step;
                nut[axis] = nut[axis].clamp(motor[axis], motor[axis] + play);
                load[axis] += step;
            }
            prop_assert_eq!(nut, load);
        }
    }

    /// A foreign backlash model in the compensator is asked where the load is when an axis turns
    /// round, and only then counts.
    #[test]
    fn a_foreign_backlash_serves(walk in walk(), start in -1000i32..1000) {
        let mut stage = Compensator::new([Regions { last: 0 }, Regions { last: 0 }]);
        let mut last = [0i8; 2];
        let mut load = [start; 2];
        for delta in walk {
            let owed = stage.before(&delta, load);
            for axis in 0..2 {
                let turned = delta[axis] * last[axis] < 0;
                prop_assert_eq!(owed[axis], if turned { Regions::backlash(load[axis]) } else { 0 });
                if delta[axis] != 0 {
                    last[axis] = delta[axis];
                }
                load[axis] += i32::from(delta[axis]);
            }
        }
    }

    /// Standing axes owe nothing and forget nothing.
    #[test]
    fn standing_still_is_free(backlash in 1u32..50) {
        let mut stage = Compensator::new([Backlash::new(backlash, Flank::Positive)]);
        prop_assert_eq!(stage.before(&[0], [0]), [0]);
        prop_assert_eq!(stage.before(&[-1], [0]), [backlash]);
        prop_assert_eq!(stage.before(&[0], [-1]), [0]);
        prop_assert_eq!(stage.before(&[-1], [-1]), [0]);
        prop_assert_eq!(stage.before(&[1], [-2]), [backlash]);
    }
}

/// After homing the models are set anew, and the compensator asks them again.
#[test]
fn homing_engages_the_flank_anew() {
    let mut stage = Compensator::new([Backlash::new(5, Flank::Positive)]);
    assert_eq!(stage.before(&[-1], [0]), [5]);
    stage.backlash_mut()[0] = Backlash::new(5, Flank::Positive);
    assert_eq!(stage.before(&[-1], [0]), [5]);
    assert_eq!(stage.backlash()[0].flank(), Flank::Negative);
}
