//! Inputs, outputs and the spindle.

use husillo_machine::gcode::{Input, OrientDirection, WaitFor};
use husillo_machine::{Event, Output, Pause};
use proptest::prelude::*;

use crate::{ExtendedMachine, config, run};

/// The events that are no steps, each with the position of X before it, in steps.
fn others(mill: &mut ExtendedMachine, lines: &[&str]) -> Vec<(i32, Event<3>)> {
    let mut others = Vec::new();
    run(mill, lines, |mill, event| {
        if !matches!(event, Event::Step(_) | Event::Dwell { .. }) {
            others.push((mill.position_steps()[0], *event));
        }
        if matches!(event, Event::Await { .. }) {
            mill.answer(Some(1_000_000));
        }
    });
    others
}

const fn digital(number: u8, is_on: bool) -> Event<3> {
    Event::Output(Output::Digital { number, is_on })
}

#[test]
fn outputs_act_with_the_beginning_of_the_next_move() {
    let lines = [
        "G1 X10 F600",
        "M62 P1",
        "M67 E0 Q2.5",
        "X20",
        "M63 P1",
        "X30",
        "M64 P2",
    ];
    let analog = Event::Output(Output::Analog {
        number: 0,
        micro: 2_500_000,
    });
    for has_ramps in [false, true] {
        let seen = others(&mut ExtendedMachine::new(config(has_ramps)), &lines);
        let expected = [
            (4_000, digital(1, true)),
            (4_000, analog),
            (8_000, digital(1, false)),
            (12_000, digital(2, true)),
        ];
        assert_eq!(seen, expected);
    }
}

/// The path does not stop for M62, and does for M64.
#[test]
fn an_output_with_a_move_costs_no_stop() {
    let time = |code: &str| {
        let mut ticks = 0;
        let output = format!("{code} P1");
        let lines = ["G1 X10 F3000", &output, "X20"];
        run(
            &mut ExtendedMachine::new(config(true)),
            &lines,
            |_, event| {
                if let Event::Step(step) = event {
                    ticks += u64::from(step.wait_ticks);
                }
            },
        );
        ticks
    };
    let (with_motion, at_once) = (time("M62"), time("M64"));
    // A stop from 50 mm/s at 500 mm/s^2 costs 0.1 s.
    assert!(at_once > with_motion + 700_000, "{with_motion} {at_once}");
}

#[test]
fn more_outputs_than_fit_keep_their_order() {
    let mut lines = vec!["G1 X1 F600".to_string()];
    lines.extend((0..20).map(|n| format!("M{} P{}", 62 + n % 2, n % 4)));
    lines.push("X2".into());
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let seen = others(&mut ExtendedMachine::new(config(true)), &lines);
    let outputs: Vec<_> = seen.iter().map(|(_, event)| *event).collect();
    let expected: Vec<_> = (0..20)
        .map(|n| digital((n % 4) as u8, n % 2 == 0))
        .collect();
    assert_eq!(outputs, expected);
}

#[test]
fn a_wait_stands_until_it_is_answered() {
    let mut mill = ExtendedMachine::new(config(true));
    mill.line(b"G1 X1 F600").unwrap();
    mill.line(b"M66 P3 L3 Q2.5").unwrap();
    while mill.next_event().is_some_and(|event| {
        let expected = Event::Await {
            input: Input::Digital(3),
            until: WaitFor::High,
            timeout_micros: 2_500_000,
        };
        matches!(event, Event::Step(_)) || event == expected
    }) {}
    assert_eq!(mill.position_steps()[0], 400);
    assert!(!mill.has_room());
    assert_eq!(mill.next_event(), None);
    mill.answer(None);
    assert!(mill.has_room());
    assert_eq!(mill.input_micro(), -1_000_000);
    run(&mut mill, &["M66 E1 L0", "X2"], |mill, event| {
        if matches!(event, Event::Await { .. }) {
            mill.answer(Some(1_250_000));
        }
    });
    assert_eq!(mill.input_micro(), 1_250_000);
}

#[test]
fn angle_and_pallet_are_given_on() {
    let seen = others(
        &mut ExtendedMachine::new(config(true)),
        &["M19 R90 P1", "M60"],
    );
    let orient = Output::Orient {
        micro_degrees: 90_000_000,
        direction: OrientDirection::Clockwise,
    };
    assert_eq!(
        seen,
        [(0, Event::Output(orient)), (0, Event::Pause(Pause::Pallet))]
    );
}

#[test]
fn an_override_takes_effect_where_the_program_permits_it() {
    let time = |lines: &[&str]| {
        let mut mill = ExtendedMachine::new(config(false));
        mill.set_feed_override(50);
        let mut ticks = 0;
        run(&mut mill, lines, |_, event| {
            if let Event::Step(step) = event {
                ticks += u64::from(step.wait_ticks);
            }
        });
        ticks
    };
    // 1 mm at 600 mm/min is 0.1 s.
    assert_eq!(time(&["G1 X1 F600"]), 1_600_000);
    assert_eq!(time(&["M49", "G1 X1 F600"]), 800_000);
    assert_eq!(time(&["M50 P0", "G1 X1 F600"]), 800_000);
    assert_eq!(time(&["M49", "G1 X1 F600", "M48", "X2"]), 2_400_000);
}

#[test]
fn the_spindle_follows_the_diameter() {
    let mut mill = ExtendedMachine::new(config(true));
    let lines = [
        "G0 X50",
        "G96 D3000 S100 M3",
        "G1 X1 F600",
        "G97 S500",
        "G0 X50",
    ];
    let (mut speed, mut seen) = (None, 0);
    run(&mut mill, &lines, |mill, event| {
        if let Event::Output(Output::Spindle { milli_rpm, .. }) = event {
            speed = Some(*milli_rpm as f64 / 1000.0);
            seen += 1;
        }
        let Some(speed) = speed.filter(|speed| *speed != 500.0) else {
            return;
        };
        if let Event::Step(_) = event {
            // The output for a step comes with the event after it.
            let x = f64::from(mill.position_steps()[0] + 1) * 2.5e-3;
            let wanted = (100_000.0 / (2.0 * std::f64::consts::PI * x)).min(3000.0);
            assert!(
                (speed / wanted - 1.0).abs() < 0.01,
                "X{x}: {speed} for {wanted}"
            );
        }
    });
    // From 318 to 3000 rpm in steps of a 128th part are about 290 outputs.
    assert!((250..350).contains(&seen), "{seen}");
    assert_eq!(speed, Some(500.0));
}

proptest! {
    /// Each output acts where the program has it: after the moves before it, and before the next.
    #[test]
    fn outputs_are_where_the_program_has_them(
        program in prop::collection::vec(0_i32..6, 1..40), has_ramps: bool,
    ) {
        let (mut lines, mut expected, mut x, mut waiting) = (Vec::new(), Vec::new(), 0, Vec::new());
        for (place, what) in program.into_iter().enumerate() {
            let number = (place % 4) as u8;
            match what {
                0 => {
                    lines.push(format!("M64 P{number}"));
                    expected.push((x, digital(number, true)));
                }
                1 | 2 => {
                    lines.push(format!("M63 P{number}"));
                    waiting.push(digital(number, false));
                }
                _ => {
                    expected.extend(waiting.drain(..).map(|event| (x, event)));
                    x += 40;
                    lines.push(format!("G1 X{}.{} F600", x / 400, x % 400 / 40));
                }
            }
        }
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        let mut seen = others(&mut ExtendedMachine::new(config(has_ramps)), &lines);
        // Those without a move after them do not act; more than fit act at standstill.
        let place = |(x, event): &(i32, Event<3>)| (*x, format!("{event:?}"));
        let mut late: Vec<_> = waiting.into_iter().map(|event| (x, event)).collect();
        expected.append(&mut late);
        seen.retain(|event| expected.contains(event));
        seen.sort_by_key(place);
        let mut wanted = expected.clone();
        wanted.sort_by_key(place);
        for event in &seen {
            prop_assert!(wanted.contains(event), "{:?}", event);
        }
        let acting = wanted.iter().filter(|(at, _)| *at < x).count();
        prop_assert_eq!(seen.iter().filter(|(at, _)| *at < x).count(), acting);
    }
}
