//! G38.2 to G38.5.

use husillo_machine::gcode::Nm;
use husillo_machine::probe::{PreTravel, Tip, UnitVector};
use husillo_machine::{Alarm, Event, Output};
use proptest::prelude::*;

use crate::{ExtendedMachine, config, run};

/// Runs lines with a work piece whose top is at this step of Z. Returns the events that are no
/// steps, and the lowest step of Z.
fn probed(mill: &mut ExtendedMachine, lines: &[&str], top: i32) -> (Vec<Event<3>>, i32) {
    let (mut others, mut lowest) = (Vec::new(), i32::MAX);
    run(mill, lines, |mill, event| {
        let z = mill.position_steps()[2];
        mill.set_probe(z <= top);
        if mill.is_probing() {
            lowest = lowest.min(z);
        }
        if !matches!(event, Event::Step(_) | Event::Dwell { .. }) {
            others.push(*event);
        }
    });
    (others, lowest)
}

#[test]
fn the_position_at_the_contact_is_latched_and_the_axes_brake() {
    for has_ramps in [false, true] {
        let mut mill = ExtendedMachine::new(config(has_ramps));
        let (events, lowest) = probed(&mut mill, &["G0 X10 Z5", "G38.2 Z-20 F600"], -1234);
        assert_eq!(events, [Event::Probed { is_touched: true }]);
        assert_eq!(mill.probed().at[2], Nm(-1234 * 2500));
        assert!(mill.probed().is_touched);
        // 10 mm/s at 500 mm/s^2 take 0.1 mm: 40 steps.
        let over = -1234 - lowest;
        assert!(
            if has_ramps {
                (38..=41).contains(&over)
            } else {
                over == 0
            },
            "{over}"
        );
        assert_eq!(mill.position_steps()[2], lowest);
        assert_eq!(mill.modal().position()[2], Nm(i64::from(lowest) * 2500));
        // The next line begins where the axes stand.
        run(&mut mill, &["G91 G0 Z1"], |_, _| ());
        assert_eq!(mill.position_steps()[2], lowest + 400);
    }
}

#[test]
fn a_missed_contact_is_an_alarm_or_a_result() {
    let mut mill = ExtendedMachine::new(config(true));
    let (events, _) = probed(&mut mill, &["M3 S100", "G38.3 Z-2 F600"], -5000);
    assert_eq!(events.last(), Some(&Event::Probed { is_touched: false }));
    assert!(!mill.probed().is_touched);
    assert_eq!(mill.probed().at[2], Nm(-2_000_000));
    assert_eq!(mill.position_steps()[2], -800);

    let (events, _) = probed(&mut mill, &["G38.2 Z-3 F600"], -5000);
    assert_eq!(events.last(), Some(&Event::Alarm(Alarm::NoContact)));
    assert!(matches!(
        events[0],
        Event::Output(Output::Spindle { milli_rpm: 0, .. })
    ));
    assert_eq!(mill.position_steps()[2], -1200);
    // Lines go on from there.
    run(&mut mill, &["G0 Z0"], |_, _| ());
    assert_eq!(mill.position_steps()[2], 0);
}

#[test]
fn a_contact_that_has_changed_before_is_an_alarm() {
    for (line, is_touching) in [
        ("G38.2 Z-3 F60", true),
        ("G38.3 Z-3 F60", true),
        ("G38.4 Z3 F60", false),
        ("G38.5 Z3 F60", false),
    ] {
        let mut mill = ExtendedMachine::new(config(true));
        mill.set_probe(is_touching);
        mill.line(line.as_bytes()).unwrap();
        let events: Vec<_> = core::iter::from_fn(|| mill.next_event()).collect();
        assert_eq!(
            events.last(),
            Some(&Event::Alarm(Alarm::ContactAtStart)),
            "{line}"
        );
        assert!(
            !events.iter().any(|event| matches!(event, Event::Step(_))),
            "{line}"
        );
    }
}

#[test]
fn probing_away_ends_where_the_contact_is_lost() {
    let mut mill = ExtendedMachine::new(config(false));
    let lines = ["G38.2 Z-10 F600", "G38.4 Z0 F60"];
    let (events, _) = probed(&mut mill, &lines, -1000);
    assert_eq!(events, [Event::Probed { is_touched: true }; 2]);
    assert_eq!(mill.position_steps()[2], -999);
}

#[test]
fn no_line_is_taken_before_the_result_is_there() {
    let mut mill = ExtendedMachine::new(config(true));
    mill.line(b"G1 X10 F600").unwrap();
    mill.line(b"G38.2 X20 F600").unwrap();
    assert!(!mill.has_room());
    while !mill.has_room() {
        mill.next_event().unwrap();
        mill.set_probe(mill.position_steps()[0] >= 6000);
    }
    assert_eq!(mill.probed().at[0], Nm(15_000_000));
    // It does not depend on whether it is the last event.
    assert_eq!(mill.next_event(), None);
}

#[test]
fn the_operator_may_hold_and_abort() {
    let mut mill = ExtendedMachine::new(config(true));
    mill.line(b"G38.2 Z-20 F600").unwrap();
    for _ in 0..1000 {
        mill.next_event().unwrap();
    }
    mill.hold();
    while mill.next_event().is_some() {}
    assert!(mill.is_probing());
    // A contact while the machine is held does not release it.
    mill.set_probe(true);
    assert_eq!(mill.next_event(), None);
    assert!(mill.is_held() && !mill.is_probing());
    mill.resume();
    assert_eq!(mill.next_event(), Some(Event::Probed { is_touched: true }));
    assert_eq!(mill.next_event(), None);

    mill.set_probe(false);
    mill.line(b"G38.2 Z-40 F600").unwrap();
    mill.next_event().unwrap();
    mill.abort();
    assert!(!mill.is_probing() && mill.has_room());
}

#[test]
fn tip_and_pre_travel_are_corrected_on_request() {
    let tip = Tip {
        radius_nm: 1_000_000,
        pre_travel: PreTravel::of(&[(UnitVector::X, 5_000), (UnitVector::Z.reversed(), 3_000)])
            .unwrap(),
    };
    let mut mill = ExtendedMachine::new(config(true));
    mill.set_tip(Some(tip));
    run(
        &mut mill,
        &["G10 L2 P1 X1 Z2", "G0 X11 Z5", "G38.2 X30 F600"],
        |mill, _| {
            mill.set_probe(mill.position_steps()[0] >= 8_000);
        },
    );
    // 20 mm - 5 um pre-travel + 1 mm radius.
    assert_eq!(mill.probed().at[0], Nm(20_995_000));
    assert_eq!(mill.probed().in_work[0], Nm(19_995_000));
}

proptest! {
    /// Wherever the work piece is, the contact is latched at its step and the axes stop within
    /// their acceleration behind it, or the end of the move is a miss.
    #[test]
    fn every_height_is_found(top in -7900_i32..400, end in -20_i64..0, feed in 50_u32..2000) {
        let mut mill = ExtendedMachine::new(config(true));
        let probe = format!("G38.3 Z{end} F{feed}");
        let (events, lowest) = probed(&mut mill, &["G0 Z2", &probe], top);
        let end = (end * 400) as i32;
        if top >= 800 {
            return Ok(());
        }
        let is_touched = top >= end;
        prop_assert_eq!(events, [Event::Probed { is_touched }]);
        let found = if is_touched { top } else { end };
        prop_assert_eq!(mill.probed().at[2], Nm(i64::from(found) * 2500));
        // v^2 / 2 a, and no farther than the end of the move.
        let speed = f64::from(feed) / 60.0;
        let over = (speed * speed / 1000.0 * 400.0).ceil() as i32 + 1;
        prop_assert!(lowest >= (found - over).max(end), "{} {}", lowest, found);
        prop_assert_eq!(mill.position_steps()[2], lowest);
    }
}
