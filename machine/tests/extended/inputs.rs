//! M52 and M53: inputs that act on the feed.

use husillo_machine::Event;
use proptest::prelude::*;

use crate::{ExtendedMachine, config, run};

const STEPS_PER_MM: i32 = 400;
const HZ: f64 = 8e6;

/// Runs lines, with `set` before each event: it gets the machine and the time in ticks. An event
/// that does not come is asked for again, after `set` at a later time. `each` gets the waits and
/// steps. Returns the end in ticks.
fn driven(
    mill: &mut ExtendedMachine,
    lines: &[&str],
    mut set: impl FnMut(&mut ExtendedMachine, u64),
    mut each: impl FnMut(u32, [i8; 3]),
) -> u64 {
    let mut lines = lines.iter();
    let mut ticks = 0_u64;
    for _ in 0..10_000_000 {
        while mill.has_room()
            && let Some(line) = lines.next()
        {
            mill.line(line.as_bytes()).unwrap();
        }
        set(mill, ticks);
        let (wait_ticks, delta) = match mill.next_event() {
            Some(Event::Step(step)) => (step.wait_ticks, step.delta),
            Some(Event::Dwell { wait_ticks }) => (wait_ticks, [0; 3]),
            Some(_) => continue,
            None if mill.is_held() => (8_000, [0; 3]),
            None if lines.len() > 0 => continue,
            None => return ticks,
        };
        each(wait_ticks, delta);
        ticks += u64::from(wait_ticks);
    }
    panic!("the machine does not come to its end");
}

/// Time from 40 mm to 60 mm of X at 50 mm/s, if the input has this value from 10 mm on.
fn seconds(codes: &[&str], percent: u8) -> f64 {
    let mut mill = ExtendedMachine::new(config(true));
    let mut at = [0_u64; 2];
    let lines: Vec<_> = codes.iter().copied().chain(["G1 X100 F3000"]).collect();
    let set = |mill: &mut ExtendedMachine, ticks| {
        let x = mill.position_steps()[0];
        if x > 10 * STEPS_PER_MM {
            mill.set_adaptive_feed(percent);
        }
        for (at, mm) in at.iter_mut().zip([40, 60]) {
            if x <= mm * STEPS_PER_MM {
                *at = ticks;
            }
        }
    };
    driven(&mut mill, &lines, set, |_, _| ());
    (at[1] - at[0]) as f64 / HZ
}

#[test]
fn the_feed_follows_the_input_under_m52() {
    for (codes, percent, expected) in [
        (&["M52 P1"][..], 50, 0.8),
        (&["M52 P1"], 3, 20.0 / 1.5),
        (&["M52 P1"], 100, 0.4),
        (&["M52 P1"], 200, 0.2),
        (&["M52 P1", "M52 P0"], 50, 0.4),
        (&[], 50, 0.4),
        // The program forbids the override of the operator only.
        (&["M49", "M52 P1"], 50, 0.8),
    ] {
        let found = seconds(codes, percent);
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{codes:?} {percent}: {found} s"
        );
    }
}

#[test]
fn the_input_multiplies_with_the_override() {
    let mut mill = ExtendedMachine::new(config(true));
    mill.set_feed_override(40);
    mill.set_adaptive_feed(50);
    let lines = ["M52 P1", "G1 X100 F3000"];
    let slow = driven(&mut mill, &lines, |_, _| (), |_, _| ());
    // 100 mm at 10 mm/s, and 20 ms for the ramps at 500 mm/s^2.
    assert!((slow as f64 / HZ - 10.02).abs() < 0.02, "{slow}");
}

#[test]
fn a_path_under_a_value_of_zero_brakes_and_waits() {
    let mut mill = ExtendedMachine::new(config(true));
    let mut stood = 0;
    let set = |mill: &mut ExtendedMachine, ticks| {
        // From 1 s to 3 s.
        let is_zero = (8_000_000..24_000_000).contains(&ticks);
        mill.set_adaptive_feed(if is_zero { 0 } else { 100 });
        if is_zero && mill.is_held() {
            stood = mill.position_steps()[0];
        }
    };
    driven(&mut mill, &["M52 P1", "G1 X100 F3000"], set, |_, _| ());
    assert_eq!(mill.position_steps()[0], 100 * STEPS_PER_MM);
    // 45 mm after 1 s, of which 50 mm/s at 500 mm/s^2 take 2.5 mm; 2.5 mm more to brake.
    assert!(
        ((50 * STEPS_PER_MM - 100)..(51 * STEPS_PER_MM)).contains(&stood),
        "{stood}"
    );
}

#[test]
fn the_stop_input_acts_under_m53_and_leaves_the_hold_of_the_operator() {
    for (code, stops) in [("M53 P1", true), ("M53 P0", false)] {
        let mut mill = ExtendedMachine::new(config(true));
        mill.line(code.as_bytes()).unwrap();
        mill.line(b"G1 X50 F3000").unwrap();
        for _ in 0..4000 {
            mill.next_event();
        }
        mill.set_feed_stop(true);
        while mill.next_event().is_some() {}
        assert_eq!(
            mill.position_steps()[0] < 50 * STEPS_PER_MM,
            stops,
            "{code}"
        );
        // The operator holds as well, so the free input alone does not start the path.
        mill.hold();
        mill.set_feed_stop(false);
        assert_eq!(mill.next_event(), None, "{code}");
        mill.set_feed_stop(true);
        mill.resume();
        if stops {
            assert_eq!(mill.next_event(), None, "{code}: the input holds");
        }
        mill.set_feed_stop(false);
        while mill.next_event().is_some() {}
        assert_eq!(mill.position_steps()[0], 50 * STEPS_PER_MM);
    }
}

/// The operator's hold comes after the contact, while the axes brake.
#[test]
fn a_hold_during_the_end_of_a_probing_move_is_kept() {
    let mut mill = ExtendedMachine::new(config(true));
    mill.line(b"G38.2 Z-20 F600").unwrap();
    let mut is_held = false;
    while mill.next_event().is_some() {
        let is_touching = mill.position_steps()[2] <= -1234;
        mill.set_probe(is_touching);
        if is_touching && !is_held {
            mill.hold();
            is_held = true;
        }
    }
    assert!(mill.probed().is_touched && mill.is_held());
    mill.line(b"G91 G0 Z1").unwrap();
    let end = mill.position_steps()[2];
    assert_eq!(mill.next_event(), None);
    mill.resume();
    run(&mut mill, &[], |_, _| ());
    assert_eq!(mill.position_steps()[2], end + STEPS_PER_MM);
}

proptest! {
    /// An input that changes each millisecond loses no step, and no axis exceeds its rate.
    #[test]
    fn an_input_that_changes_each_millisecond_loses_nothing(
        values in prop::collection::vec(prop_oneof![Just(0_u8), 1..=200_u8], 1..50),
    ) {
        let mut mill = ExtendedMachine::new(config(true));
        let lines = ["M52 P1", "G1 X3 Y1 F3000", "X4 Y5", "G2 X6 Y3 R2", "G1 X0 Y0"];
        let (mut wait, mut shortest, mut steps) = (0, u32::MAX, [0; 3]);
        let set = |mill: &mut ExtendedMachine, ticks: u64| {
            // A second of it, then the input is at 100.
            let now = (ticks / 8_000) as usize;
            mill.set_adaptive_feed(if now < 1000 { values[now % values.len()] } else { 100 });
        };
        driven(&mut mill, &lines, set, |wait_ticks, delta| {
            wait += wait_ticks;
            if delta != [0; 3] {
                shortest = shortest.min(wait);
                wait = 0;
            }
            for (sum, delta) in steps.iter_mut().zip(delta) {
                *sum += i32::from(delta);
            }
        });
        prop_assert!(shortest >= 8_000_000 / 40_000, "{}", shortest);
        prop_assert_eq!(steps, [0; 3]);
        prop_assert_eq!(mill.position_steps(), [0; 3]);
    }
}
