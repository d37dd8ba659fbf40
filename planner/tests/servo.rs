//! Profiles of a servo module: properties of any motion and any change on the way.

use husillo_planner::{ServoLine, ServoMotion, ServoProfile, ServoSetPoint};
use proptest::collection::vec;
use proptest::prelude::*;

const UNIT: i64 = 1 << 16;
const LARGEST: u32 = i32::MAX as u32;

fn trapezoid(goal: i32, velocity: u32, acceleration: u32) -> ServoMotion {
    ServoMotion::Trapezoid {
        goal,
        velocity,
        acceleration,
    }
}

/// Set points up to and including the first one that is done.
fn run(profile: &mut ServoProfile, motion: ServoMotion, most: usize) -> Vec<ServoSetPoint> {
    profile.start(motion);
    let mut set_points = Vec::new();
    while set_points.len() < most {
        let set_point = profile.tick();
        set_points.push(set_point);
        if set_point.is_done {
            return set_points;
        }
    }
    panic!("not done after {most} periods");
}

/// The documented rule taken literally, with a search instead of a formula.
struct Slow {
    left: i64,
    velocity: i64,
}

impl Slow {
    fn next(&mut self, top: i64, acceleration: i64) -> i64 {
        let reaches = |velocity: i64| {
            let mut way = 0;
            let mut left = velocity;
            while left > 0 {
                way += left;
                left -= acceleration;
            }
            way <= self.left
        };
        let low = (self.velocity - acceleration).max(0);
        let high = (self.velocity + acceleration).min(top);
        self.velocity = (low..=high).rev().find(|one| reaches(*one)).unwrap_or(low);
        self.left -= self.velocity;
        self.velocity
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Every period has the largest velocity that can still end at the goal, bit for bit the result
    /// of a search.
    #[test]
    fn every_period_is_as_fast_as_can_be(
        way in 1_i64..3,
        top in 1_i64..40_000,
        acceleration in 500_i64..9_000,
    ) {
        let mut profile = ServoProfile::new(0);
        let mut slow = Slow { left: way * UNIT, velocity: 0 };
        let motion = trapezoid(way as i32, top as u32, acceleration as u32);
        for set_point in run(&mut profile, motion, 300_000).iter().take(200) {
            prop_assert_eq!(i64::from(set_point.velocity), slow.next(top, acceleration));
        }
    }

    /// From rest to any goal: never beyond the goal, never faster than the top velocity, never a
    /// change above the acceleration. The position is the sum of the velocities, and the end is
    /// exact and at rest.
    #[test]
    fn moves_keep_their_limits_and_end_exactly(
        start: i32,
        way in prop_oneof![-300_i32..300, -3_000_000..3_000_000, Just(i32::MAX), Just(-i32::MAX)],
        velocity_bits in 0_u32..31,
        acceleration_bits in 0_u32..31,
        low: u32,
    ) {
        // About 10^5 periods at most.
        let units = u64::from(way.unsigned_abs()) << 16;
        let velocity =
            (1 << velocity_bits | low & ((1 << velocity_bits) - 1)).max((units >> 16) as u32);
        let velocity = velocity.min(LARGEST);
        let acceleration = (1 << acceleration_bits | low & ((1 << acceleration_bits) - 1))
            .max((units >> 31) as u32);
        let goal = start.wrapping_add(way);
        let mut profile = ServoProfile::new(start);
        let direction = i64::from(way.signum());
        let (mut done, mut last) = (0_i64, 0_i64);
        let set_points = run(&mut profile, trapezoid(goal, velocity, acceleration), 400_000);
        for set_point in &set_points {
            let now = i64::from(set_point.velocity) * direction;
            prop_assert!(0 <= now && now <= i64::from(velocity));
            prop_assert!((now - last).abs() <= i64::from(acceleration));
            done += now;
            last = now;
            prop_assert!(done <= units as i64);
            let position = (i64::from(start) + ((done * direction) >> 16)) as i32;
            prop_assert_eq!(set_point.position, position);
        }
        prop_assert_eq!(done, units as i64);
        prop_assert!(last <= i64::from(acceleration));
        prop_assert_eq!((profile.position(), profile.velocity()), (goal, 0));
        prop_assert!(profile.is_acceleration_done() && profile.is_slew_done());
        // It stays there.
        let rest = profile.tick();
        prop_assert_eq!((rest.position, rest.velocity, rest.is_done), (goal, 0, true));
    }

    /// No trapezoid in real numbers is faster by more than two periods.
    #[test]
    fn moves_take_the_least_time(
        way in 1_i32..100_000,
        velocity in 1_000_u32..1_000_000,
        acceleration in 20_u32..100_000,
    ) {
        let mut profile = ServoProfile::new(0);
        let motion = trapezoid(way, velocity, acceleration);
        let periods = run(&mut profile, motion, 8_000_000).len() as f64;
        let [way, velocity, acceleration] =
            [f64::from(way) * 65_536.0, velocity.into(), acceleration.into()];
        let velocity = velocity.min((way * acceleration).sqrt());
        let least = way / velocity + velocity / acceleration;
        prop_assert!(periods >= least - 1.0 - 1e-6, "{periods} instead of {least}");
        prop_assert!(periods <= least + 2.0, "{periods} instead of {least}");
    }

    /// Goals, velocities, accelerations and modes may change at any time. Velocities change by at
    /// most the present acceleration, except at stops that are documented as abrupt. The last goal
    /// is reached exactly.
    #[test]
    fn changes_on_the_way_end_at_the_last_goal(
        changes in vec((0_u8..6, any::<i16>(), 1_u32..200_000, 1_u32..20_000, 0_usize..300), 1..12),
    ) {
        let mut profile = ServoProfile::new(0);
        let mut acceleration = 0_i64;
        for (kind, place, velocity, rate, periods) in changes {
            let mut last = i64::from(profile.velocity());
            match kind {
                0..=2 => {
                    profile.start(trapezoid(place.into(), velocity, rate));
                    acceleration = rate.into();
                }
                3 => {
                    profile.start(ServoMotion::Velocity {
                        velocity,
                        acceleration: rate,
                        reverse: place < 0,
                    });
                    acceleration = rate.into();
                }
                4 => profile.stop_smoothly(),
                _ => {
                    profile.stop_abruptly(place.into());
                    last = 0;
                }
            }
            for _ in 0..periods {
                let before = profile.position_48();
                let set_point = profile.tick();
                let now = i64::from(set_point.velocity);
                prop_assert!((now - last).abs() <= acceleration, "{now} after {last}");
                prop_assert_eq!(profile.position_48(), before + now);
                last = now;
            }
        }
        let last = run(&mut profile, trapezoid(-77, 300_000, 3_000), 1_000_000).pop().unwrap();
        prop_assert_eq!(
            (last.position, profile.position_48(), profile.velocity()),
            (-77, -77 * UNIT, 0)
        );
    }

    /// A velocity is reached in the least number of periods and held to the bit. A smooth stop does
    /// the same to 0.
    #[test]
    fn velocities_are_reached_and_held(
        velocity in 0_u32..=LARGEST,
        acceleration in 100_000_u32..=LARGEST,
        reverse: bool,
    ) {
        let mut profile = ServoProfile::new(5);
        let motion = ServoMotion::Velocity { velocity, acceleration, reverse };
        let periods = run(&mut profile, motion, 30_000);
        prop_assert_eq!(periods.len() as u32, velocity.div_ceil(acceleration).max(1));
        let target = if reverse { -(velocity as i32) } else { velocity as i32 };
        for _ in 0..10 {
            let before = profile.position_48();
            prop_assert_eq!(profile.tick().velocity, target);
            let moved = (profile.position_48() - before) << 16 >> 16;
            prop_assert_eq!(moved, i64::from(target));
        }
        profile.stop_smoothly();
        let mut periods = 0;
        while !profile.is_done() {
            profile.tick();
            periods += 1;
        }
        prop_assert_eq!(periods, velocity.div_ceil(acceleration));
        prop_assert_eq!(profile.velocity(), 0);
        prop_assert!(profile.is_servo_on());
    }

    /// Axes started together by the time law of a line stay together within the documented bounds.
    #[test]
    fn axes_of_a_line_keep_together(
        ways in proptest::array::uniform3(-20_000_i32..20_000),
        velocity in 2_000_u32..400_000,
        acceleration in 20_u32..20_000,
    ) {
        let Some(line) = ServoLine::new(ways, velocity, acceleration) else {
            prop_assert_eq!(ways, [0; 3]);
            return Ok(());
        };
        let length = ways.iter().map(|way| f64::from(*way).powi(2)).sum::<f64>().sqrt();
        let axes = ways.iter().zip(line.velocities).zip(line.accelerations);
        for ((way, axis_velocity), axis_acceleration) in axes {
            let part = f64::from(way.abs()) / length;
            prop_assert!(f64::from(axis_velocity) <= f64::from(velocity) * part + 1.01);
            prop_assert!(f64::from(axis_acceleration) <= f64::from(acceleration) * part + 1.01);
            let least = f64::from(acceleration) * part * 15.0 / 16.0 - 1.01;
            prop_assert!(f64::from(axis_acceleration) >= least);
        }
        let mut axes = ways.map(|_| ServoProfile::new(0));
        let mut ends = Vec::new();
        for (index, axis) in axes.iter_mut().enumerate() {
            if ways[index] != 0 {
                axis.start(trapezoid(
                    ways[index],
                    line.velocities[index],
                    line.accelerations[index],
                ));
            }
        }
        let longest = (0..3).max_by_key(|index| ways[*index].abs()).unwrap();
        let mut ticks = 0_u32;
        let mut worst = 0.0_f64;
        while ends.len() < 3 {
            ticks += 1;
            prop_assert!(
                ticks < line.duration_ticks + 5,
                "{} periods are over",
                line.duration_ticks
            );
            for (index, axis) in axes.iter_mut().enumerate() {
                if !axis.is_done() || (ways[index] == 0 && ticks == 1) {
                    let set_point = axis.tick();
                    if set_point.is_done {
                        if ways[index] != 0 {
                            ends.push(ticks);
                        } else {
                            ends.push(u32::MAX);
                        }
                    }
                }
            }
            let share = axes[longest].position_48() as f64 / f64::from(ways[longest]);
            for (axis, way) in axes.iter().zip(ways) {
                worst = worst.max((axis.position_48() as f64 - share * f64::from(way)).abs());
            }
        }
        prop_assert!(
            worst + 65_536.0 <= line.deviation() as f64,
            "{worst} above {}",
            line.deviation()
        );
        let moving = ends.iter().filter(|end| **end != u32::MAX);
        let skew = moving.clone().max().unwrap() - moving.clone().min().unwrap();
        prop_assert!(skew <= line.skew_ticks(), "{skew} periods");
        prop_assert!(ticks + 3 >= line.duration_ticks);
    }

    /// No input to a profile or a line overflows.
    #[test]
    fn nothing_overflows(start: i32, goal: i32, values: [u32; 4], set: i32, ways: [i32; 3]) {
        let mut profile = ServoProfile::new(start);
        profile.start(ServoMotion::Velocity {
            velocity: values[0],
            acceleration: values[1],
            reverse: set < 0,
        });
        for _ in 0..5 {
            profile.tick();
        }
        profile.start(trapezoid(goal, values[2], values[3]));
        for _ in 0..20 {
            profile.tick();
        }
        profile.set_position(set);
        for _ in 0..20 {
            profile.tick();
        }
        if let Some(line) = ServoLine::new(ways, values[0], values[1]) {
            let _ = (line.deviation(), line.skew_ticks());
        }
        for ways in [ways, [i32::MIN, i32::MAX, 1]] {
            let _ = ServoLine::new(ways, values[0], values[1]).map(|line| line.deviation());
        }
    }
}

/// The worked example of the protocol: -500 counts, 1.0 counts per period, 1000/65536 counts per
/// period^2; about 570 periods.
#[test]
fn worked_example_of_the_module() {
    let mut profile = ServoProfile::new(0);
    let set_points = run(&mut profile, trapezoid(-500, 65_536, 1000), 1000);
    // 500 / 1.0 + 65.536 periods, minus the one that the discrete sums save.
    assert_eq!(set_points.len(), 565);
    assert_eq!(set_points[64].velocity, -65_000);
    assert_eq!(set_points[65].velocity, -65_536);
    assert_eq!(set_points.last().map(|last| last.position), Some(-500));
}

#[test]
fn acceleration_slew_and_end_are_reported() {
    let mut profile = ServoProfile::new(0);
    profile.start(trapezoid(20, 2 << 16, 1 << 15));
    let mut flags = Vec::new();
    while !profile.is_done() {
        profile.tick();
        flags.push((profile.is_acceleration_done(), profile.is_slew_done()));
    }
    // Velocities 0.5, 1, 1.5, 2, then constant, then falling; each flag is set once and stays set.
    assert_eq!(flags.iter().position(|flags| flags.0), Some(4));
    let slew_done = flags.iter().position(|flags| flags.1).unwrap();
    assert!((8..=11).contains(&slew_done), "{slew_done}");
    assert!(
        flags[slew_done..]
            .iter()
            .all(|flags| *flags == (true, true))
    );
    profile.start(trapezoid(0, 1, 1));
    assert!(!profile.is_acceleration_done() && !profile.is_slew_done());
}

#[test]
fn stops_and_duty() {
    let mut profile = ServoProfile::new(0);
    let jog = ServoMotion::Velocity {
        velocity: 65_536,
        acceleration: 65_536,
        reverse: false,
    };
    profile.start(jog);
    for _ in 0..10 {
        profile.tick();
    }
    profile.stop_abruptly(7);
    assert_eq!(
        profile.tick(),
        ServoSetPoint {
            position: 7,
            velocity: 0,
            is_done: true
        }
    );
    profile.start(jog);
    profile.tick();
    profile.stop_at(1000);
    assert_eq!((profile.tick().position, profile.is_done()), (1000, true));
    profile.set_position(0);
    assert_eq!((profile.tick().position, profile.is_done()), (0, true));
    profile.start(ServoMotion::Pwm {
        duty: 128,
        reverse: true,
    });
    assert_eq!((profile.duty(), profile.is_servo_on()), (-128, false));
    // The servo stays off after a smooth stop.
    profile.stop_smoothly();
    assert!(profile.tick().is_done && !profile.is_servo_on());
    profile.switch_off();
    assert_eq!(profile.duty(), 0);
    profile.stop_abruptly(-3);
    assert_eq!((profile.tick().position, profile.is_servo_on()), (-3, true));
}

/// A goal too near to stop at is passed and returned to.
#[test]
fn a_goal_too_near_is_returned_to() {
    let mut profile = ServoProfile::new(0);
    profile.start(trapezoid(100_000, 10 << 16, 6_554));
    for _ in 0..200 {
        profile.tick();
    }
    let near = profile.position() + 20;
    let set_points = run(&mut profile, trapezoid(near, 10 << 16, 6_554), 1000);
    let farthest = set_points.iter().map(|one| one.position).max().unwrap();
    // 10^2 / (2 0.1) counts to come to rest.
    assert!(
        (470..=490).contains(&(farthest - near)),
        "{}",
        farthest - near
    );
    assert_eq!(set_points.last().map(|last| last.position), Some(near));
}

#[test]
fn without_acceleration_nothing_changes() {
    let mut profile = ServoProfile::new(0);
    profile.start(trapezoid(10, 65_536, 0));
    for _ in 0..100 {
        assert!(!profile.tick().is_done);
    }
    assert_eq!(profile.position_48(), 0);
}

#[test]
fn size_is_that_of_the_documentation() {
    assert_eq!(size_of::<ServoProfile>(), 32);
}
