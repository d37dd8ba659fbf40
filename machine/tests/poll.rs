//! Waiting with `nb::block!`.
#![cfg(feature = "nb")]

mod common;

use husillo_machine::{Machine, NotFound, Refused, ServoAxis, ServoEvents, ServoInputs, ServoStop};
use husillo_pid::{RateRule, ServoGains, ServoLaw, TotalLimit};
use husillo_planner::ServoMotion;

/// A machine with a queue of two moves: lines wait until events are taken, and all moves are made.
#[test]
fn lines_wait_for_room() {
    let mut machine =
        Machine::<3, husillo_interp::Path<3>, husillo_backlash::Backlash, 2>::new(common::config());
    let mut waits = 0;
    for line in ["G21 G90", "G1 X0.1 F60", "X0.2", "X0.3", "X0.4", "Y0.3"] {
        nb::block!({
            let result = machine.poll_line(line.as_bytes());
            if result == Err(nb::Error::WouldBlock) {
                waits += 1;
                assert!(machine.next_event().is_some());
            }
            result
        })
        .unwrap();
    }
    assert!(waits > 0);
    while machine.next_event().is_some() {}
    let wrong = machine.poll_line(b"G1 X");
    assert!(
        matches!(wrong, Err(nb::Error::Other(Refused::Program(_)))),
        "{wrong:?}"
    );
}

fn axis() -> ServoAxis {
    let gains = ServoGains {
        proportional: 256,
        output_limit: 200,
        error_limit: 1000,
        rate_divisor: 1,
        ..ServoGains::default()
    };
    ServoAxis::new(ServoLaw::new(
        &gains,
        RateRule::Loop,
        TotalLimit::BeforeScaling,
    ))
}

/// Searches the index, at 250 counts, on the way to `goal`, with an encoder that stops at `stuck`.
fn search(goal: i32, stuck: i32) -> Result<i32, NotFound> {
    let mut axis = axis();
    let mut inputs = ServoInputs {
        has_power: true,
        ..ServoInputs::default()
    };
    axis.tick(&inputs);
    axis.search(
        ServoEvents {
            index: true,
            ..ServoEvents::default()
        },
        Some(ServoStop::Smooth),
    );
    axis.load(ServoMotion::Trapezoid {
        goal,
        velocity: 3 << 16,
        acceleration: 1 << 12,
    });
    assert!(axis.start());
    nb::block!({
        // A motor that follows without delay.
        inputs.counts = axis.commanded().min(stuck);
        inputs.index = inputs.counts >= 250;
        axis.tick(&inputs);
        axis.poll_search()
    })
}

#[test]
fn a_search_ends_with_its_event_or_says_why_not() {
    let found = search(10_000, i32::MAX);
    assert!(found.is_ok_and(|at| (250..253).contains(&at)), "{found:?}");
    assert_eq!(search(200, i32::MAX), Err(NotFound::AtGoal));
    assert_eq!(search(10_000, 100), Err(NotFound::Off));
}
