//! Moves that follow the spindle.

mod common;

use common::config;
use husillo_machine::{Event, Machine, Means, MoveError, Origin, Refused};

/// Counts of a whole event stream, its Follow events, and the positions of the waits for the index.
fn turn(program: &str) -> (u64, usize, Vec<usize>, Machine<3>) {
    let mut config = config();
    config.spindle_counts = Some(4096);
    config
        .axes
        .iter_mut()
        .for_each(|axis| axis.backlash_steps = 0);
    let mut machine: Machine<3> = Machine::new(config);
    let (mut counts, mut steps, mut indices) = (0, 0, Vec::new());
    let mut take = |machine: &mut Machine<3>| {
        let event = machine.next_event();
        match event {
            Some(Event::Follow(step)) => {
                counts += u64::from(step.wait_counts_q16);
                steps += 1;
                assert_eq!(machine.origin(), Origin::Feed);
            }
            Some(Event::Index) => indices.push(steps),
            _ => {}
        }
        event.is_some()
    };
    for line in program.lines() {
        while !machine.has_room() {
            take(&mut machine);
        }
        machine.line(line.as_bytes()).unwrap();
    }
    while take(&mut machine) {}
    (counts, steps, indices, machine)
}

#[test]
fn a_thread_has_its_pitch_and_waits_for_the_index_once() {
    // 3 mm of 1.5 mm lead are two turns; the two moves form one thread.
    let (counts, steps, indices, machine) = turn("M3 S100\nG33 Z-1.4 K1.5\nG33 Z-3 K1.5\nG0 Z0");
    // Each move rounds down to 2^-16 of a count.
    assert!(counts.abs_diff((2 * 4096) << 16) <= 2, "{counts}");
    assert_eq!(steps, 21_429);
    assert_eq!(indices, [0]);
    assert_eq!(machine.position_steps(), [0; 3]);
    // The next pass waits again.
    let (_, steps, indices, _) = turn("M3 S100\nG33 Z-1.4 K1.5\nG0 Z0\nG33 Z-1.4 K1.5");
    assert_eq!(indices, [0, steps / 2]);
}

#[test]
fn a_thread_goes_on_only_where_nothing_came_between() {
    let (_, steps, indices, _) =
        turn("M3 S100\nG33 Z-1.4 K1.5\nM5\nG4 P0\nM4 S100\nG33 Z-2.8 K1.5");
    assert_eq!(indices, [0, steps / 2]);
    // The same after an abort; a hold does not stop between two moves of one thread.
    let mut config = config();
    config.spindle_counts = Some(4096);
    let mut machine: Machine<3> = Machine::new(config);
    for line in ["M3 S100", "G33 Z-1.4 K1.5", "G33 Z-2.8 K1.5"] {
        while !machine.has_room() {
            // The spindle.
            machine.next_event();
        }
        machine.line(line.as_bytes()).unwrap();
    }
    let mut follows = 0;
    while let Some(event) = machine.next_event() {
        if matches!(event, Event::Follow(_)) {
            follows += 1;
        }
        if follows == 500 {
            machine.hold();
        }
    }
    assert_eq!(follows, 20_000);
    machine.abort();
    while machine.next_event().is_some() {}
    machine.line(b"M3 S100").unwrap();
    machine.line(b"G33 Z-1.4 K1.5").unwrap();
    machine.next_event();
    assert_eq!(machine.next_event(), Some(Event::Index));
}

#[test]
fn a_feed_a_revolution_is_one_on_lines_and_arcs() {
    let (counts, _, indices, _) = turn("M3 S100\nG95 G1 X0.3 F0.1");
    assert_eq!(counts, (3 * 4096) << 16);
    assert!(indices.is_empty());
    // A turn of radius 1 mm at 1 mm per revolution: 2 pi revolutions.
    let (counts, ..) = turn("M3 S100\nG95 G2 I1 J0 F1");
    let ideal = core::f64::consts::TAU * 4096.0 * 65536.0;
    assert!((counts as f64 / ideal - 1.0).abs() < 1e-4);
}

#[test]
fn without_an_encoder_they_are_refused() {
    let mut machine: Machine<3> = Machine::new(config());
    machine.line(b"M3 S100").unwrap();
    while machine.next_event().is_some() {}
    assert_eq!(
        machine.line(b"G33 Z-1 K1"),
        Err(Refused::Move(MoveError::Unsupported(
            Means::SpindleFeedback
        )))
    );
}
