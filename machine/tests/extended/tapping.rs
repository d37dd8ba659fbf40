//! Rigid tapping with a spindle that takes its time to reverse.

use super::{ExtendedMachine, config};
use husillo_machine::gcode::SpindleDirection;
use husillo_machine::{Alarm, Config, Equipment, Event, Means, MoveError, Output, Refused};

const COUNTS: f64 = 4096.0;
/// Seconds of one step of the simulation.
const INSTANT: f64 = 1e-5;
/// Speed of the spindle in counts per second: 600 turns a minute.
const SPEED: f64 = 10.0 * COUNTS;

fn with_encoder(turns: Option<u8>) -> Config<3> {
    Config {
        spindle_counts: Some(4096),
        equipment: Equipment {
            tapping_overrun_turns: turns,
            ..config(true).equipment
        },
        ..config(true)
    }
}

/// A spindle that accelerates evenly. It counts up clockwise.
struct Spindle {
    counts: f64,
    speed: f64,
    wanted: f64,
    acceleration: f64,
}

impl Spindle {
    fn turn(&mut self) {
        let most = self.acceleration * INSTANT;
        self.speed += (self.wanted - self.speed).clamp(-most, most);
        self.counts += self.speed * INSTANT;
    }
}

/// What a program does with a spindle that reverses within `turns` turns, roughly.
struct Tapped {
    machine: ExtendedMachine,
    /// Directions of the spindle, in their order.
    directions: Vec<SpindleDirection>,
    /// Lowest and highest Z in steps.
    reach: [i32; 2],
    alarm: Option<Alarm>,
    /// The largest distance of Z from the thread, in steps.
    off: f64,
}

fn tap(lines: &[&str], lead_steps: f64, top: f64, turns: f64) -> Tapped {
    let mut machine = ExtendedMachine::new(with_encoder(Some(3)));
    let mut lines = lines.iter();
    let mut spindle = Spindle {
        counts: 0.0,
        speed: 0.0,
        wanted: 0.0,
        // From full speed to rest in this number of turns: v^2 = 2 a s.
        acceleration: SPEED * SPEED / (2.0 * turns * COUNTS),
    };
    let mut tapped = Tapped {
        machine: machine.clone(),
        directions: Vec::new(),
        reach: [i32::MAX, i32::MIN],
        alarm: None,
        off: 0.0,
    };
    let (mut base, mut due) = (0.0, 0.0);
    loop {
        while machine.has_room() {
            let Some(line) = lines.next() else { break };
            machine.line(line.as_bytes()).unwrap();
        }
        let Some(event) = machine.next_event() else {
            break;
        };
        match event {
            Event::Output(Output::Spindle { direction, .. }) => {
                tapped.directions.push(direction);
                spindle.wanted = match direction {
                    SpindleDirection::Off => 0.0,
                    SpindleDirection::Clockwise => SPEED,
                    SpindleDirection::CounterClockwise => -SPEED,
                };
                if tapped.directions.len() == 1 {
                    spindle.speed = spindle.wanted;
                }
            }
            Event::Index => {
                let next = (spindle.counts / COUNTS).floor() + 1.0;
                while spindle.counts < next * COUNTS {
                    spindle.turn();
                }
                (base, due) = (spindle.counts, spindle.counts);
            }
            Event::Follow(follow) => {
                let sign = if follow.turns_back { -1.0 } else { 1.0 };
                let wait = sign * f64::from(follow.wait_counts_q16) / 65536.0;
                due += wait;
                while (due - spindle.counts) * sign > 0.0 {
                    spindle.turn();
                    if machine.awaits_reversal() && spindle.speed * sign < 0.0 {
                        machine.spindle_reversed(false);
                        due -= wait;
                        break;
                    }
                }
                let z = machine.position_steps()[2];
                tapped.reach = [tapped.reach[0].min(z), tapped.reach[1].max(z)];
                let thread = top - lead_steps * (spindle.counts - base) / COUNTS;
                tapped.off = tapped.off.max((f64::from(z) - thread).abs());
            }
            Event::Alarm(alarm) => tapped.alarm = Some(alarm),
            _ => {}
        }
    }
    tapped.machine = machine;
    tapped
}

#[test]
fn the_tap_follows_a_spindle_that_reverses() {
    // 1.5 mm are 600 steps; Z5 is step 2000.
    let lines = ["M3 S600", "G0 Z5", "G33.1 Z-4 K1.5", "G0 X1"];
    let tapped = tap(&lines, 600.0, 2000.0, 1.5);
    assert_eq!(tapped.alarm, None);
    use SpindleDirection::{Clockwise, CounterClockwise};
    assert_eq!(tapped.directions, [Clockwise, CounterClockwise, Clockwise]);
    // One and a half turns beyond the bottom and beyond the top.
    assert!(
        tapped.reach[0].abs_diff(-1600 - 900) < 20,
        "{:?}",
        tapped.reach
    );
    assert!(
        tapped.reach[1].abs_diff(2000 + 900) < 20,
        "{:?}",
        tapped.reach
    );
    // Never farther from its thread than a step is long, in either direction.
    assert!(tapped.off < 1.6, "{}", tapped.off);
    assert_eq!(tapped.machine.position_steps(), [400, 0, 2000]);
    // A spindle that reverses almost at once.
    let tapped = tap(&lines, 600.0, 2000.0, 1e-4);
    assert!(tapped.reach[0].abs_diff(-1600) <= 2, "{:?}", tapped.reach);
    assert!(tapped.off < 1.6, "{}", tapped.off);
    assert_eq!(tapped.machine.position_steps(), [400, 0, 2000]);
}

#[test]
fn a_spindle_that_does_not_reverse_is_an_alarm() {
    let lines = ["M3 S600", "G0 Z5", "G33.1 Z-4 K1.5"];
    let tapped = tap(&lines, 600.0, 2000.0, 20.0);
    assert_eq!(tapped.alarm, Some(Alarm::SpindleNotReversed));
    // Three turns beyond the bottom.
    assert_eq!(tapped.reach[0], -1600 - 1800);
}

#[test]
fn later_lines_wait_for_the_tap() {
    let mut machine = ExtendedMachine::new(with_encoder(Some(1)));
    for line in ["M4 S600", "G33.1 Z-4 K1.5"] {
        machine.line(line.as_bytes()).unwrap();
    }
    let mut events = 0;
    while !machine.has_room() {
        assert_eq!(machine.line(b"G0 X1"), Err(Refused::Busy));
        let event = machine.next_event().expect("room comes with events");
        if matches!(event, Event::Follow(_)) {
            machine.hold(); // Without effect within the tap.
        }
        if machine.awaits_reversal() {
            machine.spindle_reversed(true);
        }
        events += 1;
    }
    assert!(events > 2 * 1600, "{events}");
    machine.resume();
    machine.line(b"G0 X1").unwrap();
    while machine.next_event().is_some() {}
    assert_eq!(machine.position_steps(), [400, 0, 0]);
}

#[test]
fn a_machine_without_means_refuses_it() {
    for config in [with_encoder(None), config(true)] {
        let mut machine = ExtendedMachine::new(config);
        machine.line(b"M3 S600").unwrap();
        let refused = machine.line(b"G33.1 Z-4 K1.5");
        let missing = MoveError::Unsupported(Means::RigidTapping);
        assert_eq!(refused, Err(Refused::Move(missing)));
    }
    // Three turns beyond the bottom and the top must be within the travel of Z, -50 to 50 mm.
    let mut machine = ExtendedMachine::new(with_encoder(Some(3)));
    machine.line(b"M3 S600").unwrap();
    for line in ["G33.1 Z-46 K1.5", "G0 Z46"] {
        while machine.next_event().is_some() {}
        let refused = machine.line(line.as_bytes());
        let is_beyond = matches!(
            refused,
            Err(Refused::Move(MoveError::Travel { axis: 2, .. }))
        );
        assert_eq!(is_beyond, line.starts_with("G33.1"), "{line}: {refused:?}");
    }
    while machine.next_event().is_some() {}
    let refused = machine.line(b"G33.1 Z0 K1.5");
    assert!(matches!(
        refused,
        Err(Refused::Move(MoveError::Travel { axis: 2, .. }))
    ));
}
