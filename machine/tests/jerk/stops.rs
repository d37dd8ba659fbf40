//! Stops that a probe or an abort causes.

use husillo_gcode::Nm;
use husillo_machine::{Event, Machine};

use crate::checker::Checker;
use crate::machines::{MACHINES, STEP, Smooth, config};

/// After a contact the path brakes within its jerk, and the next line begins where it stops.
#[test]
fn a_contact_brakes_within_the_jerk() {
    let [axes, ..] = MACHINES;
    let mut machine: Smooth<8> = Machine::new(config(axes));
    machine.line(b"G38.2 X40 F3000").unwrap();
    let mut checker = Checker::new(axes);
    let mut contact = None;
    loop {
        let at = machine.position_steps()[0];
        if f64::from(at) * STEP > 9.9e6 {
            contact = contact.or(Some(at));
            machine.set_probe(true);
        }
        match machine.next_event().unwrap() {
            Event::Step(step) => {
                checker.wait(step.wait_ticks);
                checker.step(machine.executing().unwrap(), step.delta);
            }
            Event::Probed { is_touched } => {
                assert!(is_touched);
                break;
            }
            other => panic!("{other:?}"),
        }
    }
    checker.finish();
    checker.check(50e6);
    assert_eq!(
        machine.probed().at[0],
        Nm(i64::from(contact.unwrap()) * STEP as i64)
    );
    // 50 mm/s, 866 mm/s^2, a window of 17.3 ms: v^2 / 2 a + v T / 2, and what was left of a slice.
    let way = f64::from(machine.position_steps()[0] - contact.unwrap()) * STEP / 1e6;
    assert!((1.87..1.95).contains(&way), "{way}");
}

/// An abort stops at once; the next line starts from rest within its limits.
#[test]
fn an_abort_stops_at_once() {
    let [axes, ..] = MACHINES;
    let mut machine: Smooth<8> = Machine::new(config(axes));
    machine.line(b"G1 X40 F3000").unwrap();
    for _ in 0..100_000 {
        machine.next_event();
    }
    machine.abort();
    machine.line(b"G1 X0 F3000").unwrap();
    let mut checker = Checker::new(axes);
    let start = machine.position_steps();
    while let Some(event) = machine.next_event() {
        if let Event::Step(step) = event {
            checker.wait(step.wait_ticks);
            checker.step(machine.executing().unwrap(), [-step.delta[0], 0, 0]);
        }
    }
    checker.finish();
    assert_eq!((start[0] > 0, machine.position_steps()), (true, [0; 3]));
    assert_eq!(checker.steps(), i64::from(start[0]));
}
