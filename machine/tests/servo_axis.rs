//! The closed-loop axis without a motor: its reaction to inputs.

use husillo_machine::{ServoAxis, ServoEvents, ServoInputs, ServoStop};
use husillo_pid::{Drive, RateRule, ServoGains, ServoLaw, TotalLimit};
use husillo_planner::ServoMotion;
use proptest::prelude::*;

const POWERED: ServoInputs = ServoInputs {
    counts: 0,
    limit_1: false,
    limit_2: false,
    index: false,
    current: 0,
    has_power: true,
};

fn law() -> ServoLaw {
    let gains = ServoGains {
        proportional: 256,
        output_limit: 200,
        error_limit: 1000,
        rate_divisor: 1,
        ..ServoGains::default()
    };
    ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling)
}

/// An axis that holds position 0 at these encoder counts.
fn holding(counts: i32) -> ServoAxis {
    let mut axis = ServoAxis::new(law());
    axis.tick(&ServoInputs { counts, ..POWERED });
    axis.stop(ServoStop::Abrupt);
    axis
}

#[test]
fn it_is_off_and_at_zero_after_power_up() {
    let mut axis = ServoAxis::new(law());
    let drive = axis.tick(&ServoInputs {
        counts: 12_345,
        ..POWERED
    });
    assert_eq!((drive, axis.position()), (Drive::default(), 0));
    let status = axis.status();
    assert!(status.position_error && status.is_done && !status.is_on);
}

#[test]
fn it_drives_back_to_where_it_is_to_be() {
    let mut axis = holding(100);
    let drive = axis.tick(&ServoInputs {
        counts: 107,
        ..POWERED
    });
    assert_eq!(
        (drive.signed(), axis.position(), axis.velocity()),
        (-7, 7, 7)
    );
}

#[test]
fn without_power_or_far_off_it_lets_go_until_it_is_commanded() {
    for lost in [
        ServoInputs {
            has_power: false,
            ..POWERED
        },
        ServoInputs {
            counts: 1001,
            ..POWERED
        },
    ] {
        let mut axis = holding(0);
        axis.clear();
        assert_eq!(axis.tick(&lost), Drive::default());
        // It stays off after the position returns.
        assert_eq!(
            axis.tick(&ServoInputs {
                counts: 50,
                ..POWERED
            }),
            Drive::default()
        );
        assert!(axis.status().position_error && !axis.status().is_on);
    }
}

#[test]
fn a_search_ends_at_the_first_change_it_waits_for() {
    let touched = |counts| ServoInputs {
        counts,
        limit_1: true,
        ..POWERED
    };
    let events = ServoEvents {
        limit_1: true,
        ..ServoEvents::default()
    };
    let mut axis = holding(0);
    axis.search(events, Some(ServoStop::Off));
    // A change of another input has no effect.
    axis.tick(&ServoInputs {
        counts: 3,
        index: true,
        ..POWERED
    });
    assert!(axis.status().is_searching && axis.status().is_on);
    axis.tick(&touched(5));
    assert_eq!(axis.home(), 5);
    assert!(!axis.status().is_searching && !axis.status().is_on);
    // The search has ended: the next change stores nothing.
    axis.tick(&ServoInputs {
        counts: 9,
        ..POWERED
    });
    assert_eq!(axis.home(), 5);
    // A search without events cancels the search.
    axis.search(events, None);
    axis.search(ServoEvents::default(), None);
    assert!(!axis.status().is_searching);
}

#[test]
fn a_position_is_not_renamed_during_a_move() {
    let mut axis = holding(0);
    axis.load(ServoMotion::Trapezoid {
        goal: 100,
        velocity: 1 << 16,
        acceleration: 1 << 12,
    });
    assert!(axis.start() && !axis.start());
    axis.tick(&POWERED);
    assert!(!axis.set_position(0));
    axis.stop(ServoStop::At(0));
    assert!(axis.set_position(1_000_000));
    assert_eq!((axis.position(), axis.commanded()), (1_000_000, 1_000_000));
}

/// A position set before the first period holds in it, whatever the counter reads.
#[test]
fn a_name_given_before_the_first_period_counts() {
    let mut axis = ServoAxis::new(law());
    assert!(axis.set_position(100));
    axis.tick(&ServoInputs {
        counts: 12_345,
        ..POWERED
    });
    assert_eq!((axis.position(), axis.commanded()), (100, 100));
    axis.tick(&ServoInputs {
        counts: 12_350,
        ..POWERED
    });
    assert_eq!(axis.position(), 105);
}

#[test]
fn going_round_the_counter_is_reported() {
    let mut axis = holding(i32::MAX);
    assert!(axis.set_position(i32::MAX));
    axis.tick(&ServoInputs {
        counts: i32::MIN,
        ..POWERED
    });
    assert_eq!((axis.position(), axis.velocity()), (i32::MIN, 1));
    assert!(axis.status().wrapped);
    axis.clear();
    assert!(!axis.status().wrapped);
}

proptest! {
    /// Whatever the counter and the position were at the start, the drive is the same.
    #[test]
    fn names_of_places_do_not_matter(
        begin in any::<i32>(),
        name in any::<i32>(),
        goal in -500i32..500,
        path in prop::collection::vec(-20i32..20, 1..200),
    ) {
        let mut plain = holding(0);
        let mut named = holding(begin);
        prop_assert!(named.set_position(name));
        let motion = |goal| ServoMotion::Trapezoid {
            goal,
            velocity: 3 << 16,
            acceleration: 1 << 13,
        };
        plain.load(motion(goal));
        named.load(motion(name.wrapping_add(goal)));
        prop_assert!(plain.start() && named.start());
        let mut counts = 0i32;
        for by in path {
            counts += by;
            let here = plain.tick(&ServoInputs { counts, ..POWERED });
            let there = named.tick(&ServoInputs { counts: begin.wrapping_add(counts), ..POWERED });
            prop_assert_eq!(here, there);
            prop_assert_eq!(plain.position().wrapping_add(name), named.position());
        }
    }
}
