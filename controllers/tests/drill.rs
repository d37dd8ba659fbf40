//! Properties of the drill's controller for any bytes of its link and any levels of its switches.

use husillo_controllers::{Drill, DrillConfig, DrillEvent, DrillInputs};
use husillo_transports::drill::Rules;
use proptest::prelude::*;

fn config(rules: Rules) -> DrillConfig {
    DrillConfig {
        back_off_steps: 3,
        search_steps: 40,
        stroke_steps: 9,
        travel_steps: [500, 400],
        spindle_by_hole: !rules.has_extras,
        rules,
        ..DrillConfig::FIXED
    }
}

fn inputs() -> impl Strategy<Value = DrillInputs> {
    // Mostly open, so that axes move.
    let switch = || prop::bool::weighted(0.1);
    (switch(), switch(), switch(), switch()).prop_map(|(x, y, is_up, is_down)| DrillInputs {
        home: [x, y],
        is_up,
        is_down,
    })
}

/// Mostly letters of the link.
fn byte() -> impl Strategy<Value = u8> {
    prop_oneof![
        prop::sample::select(&b"BcrebmXYZfwEDIFRULOSaTQn?"[..]),
        any::<u8>()
    ]
}

proptest! {
    /// One axis moves at a time, at its rate. Z never goes beyond a sensor that sees it. After
    /// homing, X and Y stay within the table, at the positions that the steps give.
    #[test]
    fn moves_are_within_bounds(
        faithful in any::<bool>(),
        course in prop::collection::vec((prop::option::weighted(0.3, byte()), inputs()), 1..3000),
    ) {
        let config = config(if faithful { Rules::FAITHFUL } else { Rules::FIXED });
        let mut drill = Drill::<24>::new(config);
        let mut spindle = true;
        // The distance of the axes beyond zero, while they search a switch that closes slightly
        // late.
        let mut beyond = [0; 2];
        for (byte, inputs) in course {
            if let Some(byte) = byte {
                drill.push(byte);
            }
            let before = drill.position_steps();
            let was_homed = drill.is_homed();
            match drill.next_event(&inputs) {
                DrillEvent::Step(step) => {
                    prop_assert_eq!(step.wait_ticks, 1_000_000 / 247);
                    let [dx, dy, dz] = step.delta;
                    prop_assert_eq!(dx.abs() + dy.abs() + dz.abs(), 1);
                    prop_assert!(!(inputs.is_down && dz > 0));
                    prop_assert!(!(inputs.is_up && dz < 0));
                    if was_homed {
                        let place = drill.position_steps();
                        for (axis, delta) in [(0, dx), (1, dy)] {
                            beyond[axis] += i32::from(place[axis]) - i32::from(
                                before[axis]
                            ) - i32::from(delta);
                            prop_assert!((0..=3).contains(&beyond[axis]));
                        }
                        prop_assert!(place[0] <= 500 && place[1] <= 400);
                    }
                }
                DrillEvent::Spindle(on) => {
                    prop_assert_ne!(on, spindle);
                    spindle = on;
                }
                DrillEvent::Dwell { wait_ticks } => prop_assert!(wait_ticks <= config.settle_ticks),
                DrillEvent::Report(_) | DrillEvent::Idle => {}
            }
            if !drill.is_homed() {
                beyond = [0; 2];
            }
            prop_assert_eq!(drill.spindle_turns(), spindle);
            while drill.transmit().is_some() {}
        }
    }

    /// After a reset in any state the spindle stops. With working switches the drill then homes and
    /// sends `B`.
    #[test]
    fn a_reset_leads_home(course in prop::collection::vec((byte(), inputs()), 0..300)) {
        let mut drill = Drill::<24>::new(config(Rules::FIXED));
        for (byte, inputs) in course {
            drill.push(byte);
            drill.next_event(&inputs);
        }
        while drill.transmit().is_some() {}
        drill.reset();
        let mut place = [7, 5, 4];
        for _ in 0..200 {
            let inputs = DrillInputs {
                home: [place[0] <= 0, place[1] <= 0],
                is_up: place[2] <= 0,
                is_down: place[2] >= 8,
            };
            if let DrillEvent::Step(step) = drill.next_event(&inputs) {
                for (place, delta) in place.iter_mut().zip(step.delta) {
                    *place += i32::from(delta);
                }
            }
        }
        prop_assert_eq!(place, [0; 3]);
        prop_assert!(drill.is_homed() && !drill.spindle_turns());
        prop_assert_eq!(drill.transmit(), Some(b'B'));
        prop_assert_eq!(drill.transmit(), None);
    }
}
