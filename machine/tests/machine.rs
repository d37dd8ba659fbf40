//! Lines in, events out: behaviour that a firmware author relies on.

mod common;

use common::{Screw, config, drain, limited};
use husillo_backlash::Backlash;
use husillo_gcode::{Nm, SpindleDirection};
use husillo_interp::Path;
use husillo_machine::{Event, Machine, MoveError, Origin, Output, Pause, Refused, Scale};

fn events(machine: &mut Machine<3>) -> Vec<Event<3>> {
    core::iter::from_fn(|| machine.next_event()).collect()
}

#[test]
fn circle_closes_at_the_programmed_speed_with_its_take_up() {
    let mut machine: Machine<3> = Machine::new(limited());
    let mut screw = Screw::new();
    machine.line(b"G0 X6 Y3").unwrap();
    drain(&mut machine, &mut screw);
    let start = machine.position_steps();
    machine.line(b"G2 X6 Y3 I-3 J0 F1.2").unwrap();
    let mut take_up_steps = 0;
    let (mut path_ticks, mut path_steps) = (0u64, 0u64);
    while let Some(event) = machine.next_event() {
        let Event::Step(step) = event else {
            panic!("{event:?}")
        };
        screw.step(step.delta);
        assert_eq!(screw.tool, machine.position_steps().map(i64::from));
        if machine.origin() == Origin::TakeUp {
            take_up_steps += 1;
            assert_eq!(step.delta.iter().filter(|delta| **delta != 0).count(), 1);
        } else {
            path_ticks += u64::from(step.wait_ticks);
            path_steps += 1;
        }
    }
    assert_eq!(machine.position_steps(), start);
    // Clockwise from the right: Y reverses at once, at the bottom and at the top; X reverses at
    // once and at the left.
    assert_eq!(take_up_steps, 3 * 1271 + 2 * 1457);
    let radius = 3e6 / 140.0;
    assert!(path_steps.abs_diff((4.0 * 2f64.sqrt() * radius).round() as u64) <= 4);
    let seconds = path_ticks as f64 / 1e6;
    let ideal = 2.0 * core::f64::consts::PI * 3.0 / 1.2 * 60.0;
    assert!(
        (seconds / ideal - 1.0).abs() < 1e-4,
        "{seconds} s, ideal {ideal} s"
    );
}

/// The steps of Z are finer than those of X: the circle is as fast, as round and reverses as often
/// as on equal steps.
#[test]
fn a_circle_on_unequal_steps_is_a_circle() {
    let mut config = config();
    let fine = Scale::new(1_000_000, 17_000).unwrap();
    config.axes[2].scale = fine;
    config.axes[2].max_rate_hz = 1000;
    config.axes[2].backlash_steps = 500;
    let mut machine: Machine<3> = Machine::new(config);
    machine.line(b"G18 G2 X0 Z0 I-3 K0 F1.2").unwrap();
    let (mut path_ticks, mut path_steps, mut take_up_steps) = (0_u64, 0_u64, 0);
    while let Some(event) = machine.next_event() {
        let Event::Step(step) = event else {
            panic!("{event:?}")
        };
        if machine.origin() == Origin::TakeUp {
            take_up_steps += 1;
            continue;
        }
        path_ticks += u64::from(step.wait_ticks);
        path_steps += 1;
        let [x, _, z] = machine.position_steps().map(f64::from);
        let radius = (x * 140.0 + 3e6).hypot(z * 1e6 / 17_000.0);
        assert!(
            (radius - 3e6).abs() <= 71.0,
            "{radius} nm at step {path_steps}"
        );
    }
    assert_eq!(machine.position_steps(), [0; 3]);
    // Z is the first axis of G18, so clockwise is from +X to +Z. The nuts stand at their positive
    // flanks: X reverses at once and at the left, Z at both ends of its diameter.
    assert_eq!(take_up_steps, 2 * 1457 + 2 * 500);
    let seconds = path_ticks as f64 / 1e6;
    let ideal = 2.0 * core::f64::consts::PI * 3.0 / 1.2 * 60.0;
    assert!(
        (seconds / ideal - 1.0).abs() < 2e-4,
        "{seconds} s, ideal {ideal} s"
    );
    // A helix on the same plane.
    machine.line(b"G2 X-6 Z0 I-3 K0 Y0.7").unwrap();
    events(&mut machine);
    assert_eq!(machine.position_steps(), [-42857, 5000, 0]);
}

#[test]
fn refused_lines_change_nothing() {
    let mut machine: Machine<3> = Machine::new(limited());
    machine.line(b"G1 X1 F1").unwrap();
    drain(&mut machine, &mut Screw::new());
    let before = machine.modal().position();
    for bad in [
        "G1 X11",
        "G2 X1 Y1",
        "X1.2.3",
        "G1 X99999999999999999999",
        "\u{1}\u{2}",
        "G0 Y-0.001",
        "G3 X1 Y0 I5 J0",
    ] {
        assert!(machine.line(bad.as_bytes()).is_err(), "{bad}");
        assert_eq!(machine.modal().position(), before, "{bad}");
        assert_eq!(machine.next_event(), None, "{bad}");
    }
    let beyond = machine.line(b"G1 X10.25");
    assert_eq!(
        beyond,
        Err(Refused::Move(MoveError::Travel {
            axis: 0,
            position: Nm(10_250_000),
            limit: Nm(10_000_000)
        }))
    );
}

#[test]
fn an_arc_that_bulges_out_of_the_travel_is_refused_though_its_ends_are_inside() {
    let mut machine: Machine<3> = Machine::new(limited());
    machine.line(b"G0 X9 Y1").unwrap();
    drain(&mut machine, &mut Screw::new());
    // A half circle to the right from (9, 1) to (9, 4): 1.5 mm beyond 9.
    assert!(matches!(
        machine.line(b"G3 X9 Y4 I0 J1.5 F1"),
        Err(Refused::Move(MoveError::Travel { axis: 0, .. }))
    ));
    // The same to the left fits.
    machine.line(b"G2 X9 Y4 I0 J1.5 F1").unwrap();
}

#[test]
fn a_full_queue_gives_the_line_back() {
    let mut machine: Machine<3, Path<3>, Backlash, 1> = Machine::new(config());
    machine.line(b"G0 X0.0014").unwrap();
    // One is in the queue, one waits for room, the next is returned.
    machine.line(b"G0 X0").unwrap();
    assert_eq!(machine.line(b"G0 X1"), Err(Refused::Busy));
    machine.next_event().unwrap();
    assert_eq!(machine.line(b"G0 X1"), Err(Refused::Busy));
    let (_, steps) = drain(
        &mut machine,
        &mut Screw {
            motor: [1, 0, 0],
            tool: [1, 0, 0],
        },
    );
    assert_eq!(steps, 9 + 1457 + 10);
    machine.line(b"G0 X1").unwrap();
}

#[test]
fn moves_shorter_than_a_step_give_their_time_to_the_next() {
    let mut machine: Machine<3> = Machine::new(config());
    let mut screw = Screw::new();
    let mut ticks = 0;
    for line in ["G91 G1 F1.2 X0.00002"].into_iter().chain(["X0.00002"; 69]) {
        machine.line(line.as_bytes()).unwrap();
        ticks += drain(&mut machine, &mut screw).0;
    }
    // 70 x 20 nm are 10 steps and 70 ms; the time of 3 moves after the last step is still carried.
    assert_eq!(machine.position_steps(), [10, 0, 0]);
    assert_eq!(ticks, 67_000);
}

#[test]
fn outputs_stand_exactly_between_moves() {
    let mut machine: Machine<3> = Machine::new(config());
    machine.line(b"G1 X0.00014 F1.2").unwrap();
    let first = events(&mut machine);
    machine.line(b"M3 S1000 G4 P0.5").unwrap();
    let between = events(&mut machine);
    machine.line(b"M30").unwrap();
    let last = events(&mut machine);
    assert_eq!(first.len(), 1);
    assert_eq!(
        between,
        [
            Event::Output(Output::Spindle {
                direction: SpindleDirection::Clockwise,
                milli_rpm: 1_000_000
            }),
            Event::Dwell {
                wait_ticks: 500_000
            },
        ]
    );
    assert_eq!(last.len(), 3);
    assert_eq!(last[2], Event::Pause(Pause::End { rewind: true }));
}

#[test]
fn long_dwells_are_split() {
    let mut machine: Machine<3> = Machine::new(config());
    machine.line(b"G4 P5000").unwrap();
    let total: u64 = events(&mut machine)
        .iter()
        .map(|event| match event {
            Event::Dwell { wait_ticks } => u64::from(*wait_ticks),
            other => panic!("{other:?}"),
        })
        .sum();
    assert_eq!(total, 5_000_000_000);
}

#[test]
fn an_abort_in_the_middle_of_a_take_up_loses_no_step() {
    for steps_before in 0..30 {
        for next in [&b"G0 X0.0028"[..], b"G0 X-0.0028", b"G0 Y0.0014 X0.00028"] {
            let mut machine: Machine<3> = Machine::new(config());
            let mut screw = Screw::new();
            machine.line(b"G0 X0.0014").unwrap();
            drain(&mut machine, &mut screw);
            machine.line(b"G0 X0").unwrap();
            for _ in 0..steps_before * 50 {
                if let Some(Event::Step(step)) = machine.next_event() {
                    screw.step(step.delta);
                }
            }
            machine.abort();
            machine.line(next).unwrap();
            drain(&mut machine, &mut screw);
        }
    }
}

#[test]
fn a_helix_ends_exactly_and_a_tiny_arc_is_a_line() {
    let mut machine: Machine<3> = Machine::new(config());
    let mut screw = Screw::new();
    machine.line(b"G17 G3 X0 Y0 I0.5 J0 Z0.3 P3 F1").unwrap();
    drain(&mut machine, &mut screw);
    assert_eq!(machine.position_steps(), [0, 0, 2143]);
    machine.line(b"G3 X0.00005 Y0 I0.000025 J0").unwrap();
    drain(&mut machine, &mut screw);
    assert_eq!(machine.position_steps(), [0, 0, 2143]);
}

#[test]
fn arcs_whose_ends_fall_on_one_step_are_short_or_whole_as_programmed() {
    // 100 nm along a circle of 1 mm: less than a step, not a turn.
    let mut machine: Machine<3> = Machine::new(config());
    machine.line(b"G3 X0 Y0.0001 I-1 J0 F1").unwrap();
    let (_, steps) = drain(&mut machine, &mut Screw::new());
    assert!(steps <= 1, "{steps}");
    // The same end in the other direction is nearly a whole turn.
    let mut machine: Machine<3> = Machine::new(config());
    machine.line(b"G2 X0 Y0.0001 I-1 J0 F1").unwrap();
    let (_, steps) = drain(&mut machine, &mut Screw::new());
    assert!(steps > 40_000, "{steps}");
}

#[test]
fn rapid_and_feed_keep_to_the_path_speeds_of_the_machine() {
    let mut config = config();
    config
        .axes
        .iter_mut()
        .for_each(|axis| axis.max_rate_hz = 1_000_000);
    config.rapid = Some(Nm(600_000_000));
    config.top_feed = Some(Nm(60_000_000));
    let mut machine: Machine<3> = Machine::new(config);
    let mut screw = Screw::new();
    machine.line(b"G0 X3 Y4").unwrap();
    assert_eq!(drain(&mut machine, &mut screw).0, 500_000);
    machine.line(b"G1 X6 Y8 F1000").unwrap();
    assert_eq!(drain(&mut machine, &mut screw).0, 5_000_000);
}

#[test]
fn moves_longer_than_the_step_counter_are_refused() {
    let mut machine: Machine<3> = Machine::new(config());
    machine.line(b"G0 X250000").unwrap();
    machine.abort();
    let command = husillo_gcode::Command::Rapid {
        to: [Nm(-250_000_000_000), Nm(0), Nm(0)],
    };
    let from = [Nm(250_000_000_000), Nm(0), Nm(0)];
    assert_eq!(
        config().check(&from, &command),
        Err(MoveError::Reach { axis: 0 })
    );
    // Two turns of 1.4e9 steps each.
    assert_eq!(
        machine.line(b"G3 X0 Y0 I35000 J0 P2 F1"),
        Err(Refused::Move(MoveError::ArcTooLarge))
    );
}

#[test]
fn an_abort_stops_the_spindle_for_good() {
    let mut machine: Machine<3> = Machine::new(config());
    machine.line(b"M3 S100 M8").unwrap();
    events(&mut machine);
    machine.abort();
    assert_eq!(events(&mut machine).len(), 2);
    machine.line(b"S200").unwrap();
    assert!(events(&mut machine).iter().all(|event| !matches!(
        event,
        Event::Output(Output::Spindle {
            direction: SpindleDirection::Clockwise,
            ..
        })
    )));
}

#[test]
fn turns_too_small_for_the_grid_take_their_time() {
    let mut machine: Machine<3> = Machine::new(config());
    machine.line(b"G3 I0.00004 J0 P1000 F1").unwrap();
    drain(&mut machine, &mut Screw::new());
    machine.line(b"G1 X0.00014").unwrap();
    let (ticks, _) = drain(&mut machine, &mut Screw::new());
    // 1000 turns of 2 pi 40 nm, then 140 nm, at 1 mm/min.
    let ideal = (1000.0 * core::f64::consts::TAU * 40.0 + 140.0) * 60.0;
    assert!(
        (ticks as f64 - ideal).abs() < 60.0,
        "{ticks}, ideal {ideal}"
    );
}

#[test]
fn a_command_without_an_event_makes_room() {
    let mut machine: Machine<3> = Machine::new(config());
    machine.line(b"G4 P0").unwrap();
    machine.line(b"M3 S1").unwrap();
    assert!(!machine.has_room());
    // The dwell takes no time and makes no event; the spindle makes one.
    assert!(matches!(machine.next_event(), Some(Event::Output(_))));
    assert!(machine.has_room());
    machine.line(b"G4 P0").unwrap();
    machine.line(b"G4 P0").unwrap();
    assert!(!machine.has_room());
    assert_eq!(machine.next_event(), None);
    assert!(machine.has_room());
}

#[test]
fn an_arc_whose_ends_differ_in_radius_alone_is_no_whole_turn() {
    // A radius of 5 m whose ends are 0.45 mm further out and 0.02 mm along. On a grid of 0.1 mm
    // they are on one spoke.
    let mut config = config();
    for axis in &mut config.axes {
        axis.scale = husillo_machine::Scale::new(100_000, 1).unwrap();
        axis.backlash_steps = 0;
    }
    for (line, most) in [
        ("G2 X0.05 Y0.02 I5009.6 J0", 8),
        ("G3 X0.05 Y-0.02 I5009.6 J0", 8),
    ] {
        let mut machine: Machine<3> = Machine::new(config);
        machine.line(b"G1 X0.5 Y0 F60").unwrap();
        machine.line(line.as_bytes()).unwrap();
        let mut events = 0;
        while machine.next_event().is_some() {
            events += 1;
            assert!(machine.position_steps()[1].abs() <= 1);
        }
        assert!(events <= 5 + most, "{line}: {events}");
    }
}

/// The bytes that the README and the docs of `Machine` name.
#[test]
#[cfg(target_pointer_width = "64")]
fn a_place_in_the_queue_is_small() {
    type Queue<const QUEUE: usize> = Machine<3, Path<3>, Backlash, QUEUE>;
    let [few, more] = [size_of::<Queue<16>>(), size_of::<Queue<17>>()];
    assert_eq!(more - few, 208);
}
