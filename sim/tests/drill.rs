//! The controller of the drill with its mechanics, over its link, on good and bad lines.

mod drilling;

use drilling::{BOARD, Bench, STROKE, events, quick, records};
use husillo_controllers::{Drill, DrillConfig, DrillFault, DrillReport};
use husillo_sim::device::Emulation;
use husillo_sim::device::drill::Device;
use husillo_sim::{DrillRig, DrilledHole, Emulated, Random};
use husillo_transports::drill::{COUNT, Failure, Outcome, Rules, Step};

/// The original controller, of a fast and small machine.
fn original() -> DrillConfig {
    let DrillConfig {
        rate_hz,
        back_off_steps,
        stroke_steps,
        ..
    } = quick(Rules::FAITHFUL);
    DrillConfig {
        rate_hz,
        back_off_steps,
        stroke_steps,
        ..DrillConfig::ORIGINAL
    }
}

fn places(holes: &[[u16; 2]]) -> Vec<[i32; 2]> {
    holes.iter().map(|at| at.map(i32::from)).collect()
}

/// The example of the protocol at the rates of the machine: 1070 and 535 steps, 10 and 5 mm.
#[test]
fn a_hole_is_where_it_should_be() {
    for config in [DrillConfig::ORIGINAL, DrillConfig::FIXED] {
        let mut bench = Bench::<64>::new(DrillConfig {
            stroke_steps: 20,
            shortest_stroke_steps: config.shortest_stroke_steps.map(|_| STROKE),
            ..config
        });
        bench.all(&[Step::Test]);
        assert_eq!(bench.program(&records(&[[1070, 535], [7, 0]])), Ok(()));
        assert_eq!(bench.drilled(), [[1070, 535], [7, 0]]);
        assert_eq!(bench.rig.lost_steps(), [0; 3]);
        assert_eq!(bench.rig.dragged_steps(), 0);
    }
}

/// The original turns its spindle for each hole, switches it with Z up, and stops it between two
/// holes.
#[test]
fn the_spindle_of_the_original_turns_for_each_hole() {
    let mut bench = Bench::<64>::new(original());
    bench.switched.clear();
    assert_eq!(bench.program(&records(&[[5, 4], [9, 4], [2, 7]])), Ok(()));
    let places = [[5, 4, 0], [9, 4, 0], [2, 7, 0]];
    let expected = places.map(|at| [(true, at), (false, at)]).concat();
    assert_eq!(bench.switched, expected);
    assert!(bench.rig.holes().iter().all(|hole| hole.is_clean));
}

/// In the original a hole and homing stop the spindle before Z goes up, also when it was switched
/// on by hand.
#[test]
fn a_hole_and_homing_stop_the_spindle_of_the_original() {
    let mut bench = Bench::<64>::new(original());
    bench.all(&[Step::Clear, Step::Manual(4), Step::Key(b'L')]);
    bench.all(&[Step::Key(b'O')]);
    assert!(bench.rig.spindle_turns());
    bench.switched.clear();
    bench.all(&[Step::Key(b'r')]);
    assert_eq!(bench.switched, [(false, [0, 0, 4])]);
    assert_eq!(bench.rig.place(), [0; 3]);
    bench.all(&[Step::Key(b'O'), Step::Quit, Step::Begin]);
    let bytes: Vec<_> = records(&[[3, 2]]).into_iter().map(Step::Store).collect();
    bench.all(&bytes);
    bench.all(&[Step::End, Step::Execute]);
    assert_eq!(bench.switched[1..], [(true, [0; 3]), (false, [3, 2, 0])]);
    assert_eq!(bench.drilled(), [[3, 2]]);
}

/// A missing sensor signal stops the spindle of the original in the hole.
#[test]
fn a_fault_stops_the_spindle_of_the_original() {
    let mut bench = Bench::<64>::new(original());
    bench.rig.hold(3, Some(false));
    bench.switched.clear();
    assert!(bench.program(&records(&[[3, 2]])).is_err());
    let switched: Vec<_> = bench.switched.iter().map(|(on, _)| *on).collect();
    assert_eq!(switched, [true, false]);
}

/// In the modern mode the host switches the spindle: it keeps turning from hole to hole, and stops
/// with the program.
#[test]
fn the_spindle_of_the_modern_one_turns_from_hole_to_hole() {
    let mut bench = Bench::<64>::new(quick(Rules::FIXED));
    bench.switched.clear();
    bench.all(&[Step::Spindle(true)]);
    assert_eq!(bench.program(&records(&[[5, 4], [9, 4]])), Ok(()));
    assert_eq!(bench.switched, [(true, [0; 3]), (false, [9, 4, 0])]);
    assert!(bench.rig.holes().iter().all(|hole| hole.is_clean));
}

/// If X or Y is on its switch when homing begins, it first moves off by the back-off; the other
/// axes do not.
#[test]
fn homing_backs_off_a_closed_switch() {
    let config = DrillConfig {
        back_off_steps: 1070,
        ..quick(Rules::FAITHFUL)
    };
    let mut bench = Bench::<64>::new(config);
    assert_eq!(bench.reports, [DrillReport::Homed]);
    // From the switches: 1070 steps off and back, twice.
    let before = bench.rig.ticks();
    bench.all(&[Step::Home]);
    let steps = (bench.rig.ticks() - before) / 1000;
    assert!((4280..4300).contains(&steps), "{steps}");
    assert_eq!(bench.rig.place(), [0, 0, 0]);
    // From any other position: straight to them.
    bench.program(&records(&[[30, 20]])).expect("a good line");
    let before = bench.rig.ticks();
    bench.all(&[Step::Home]);
    assert!((bench.rig.ticks() - before) / 1000 < 60);
    assert_eq!(bench.rig.place(), [0, 0, 0]);
}

#[test]
fn a_switch_that_does_not_come_is_a_fault() {
    let faults = [
        (0, false, DrillFault::NoSwitch { axis: 0 }),
        (1, true, DrillFault::StillClosed { axis: 1 }),
        (2, false, DrillFault::NotUp),
    ];
    for (switch, closed, fault) in faults {
        let mut bench = Bench::<64>::new(DrillConfig {
            // Z, which has passed its sensor, must leave it within this distance.
            back_off_steps: 30,
            search_steps: 200,
            ..quick(Rules::FIXED)
        });
        bench.rig.hold(switch, Some(closed));
        let outcome = bench.run(Step::Home);
        assert_eq!(outcome, Ok(Outcome::Failed(Failure::Fault)), "{fault:?}");
        assert_eq!(bench.reports.last(), Some(&DrillReport::Fault(fault)));
        bench.rig.hold(switch, None);
        if switch > 0 {
            // X has passed its switch.
            bench.reset();
            bench.all(&[Step::AwaitBoot, Step::Test]);
        }
    }
    let mut bench = Bench::<64>::new(quick(Rules::FIXED));
    bench.rig.hold(3, Some(false));
    assert!(bench.program(&records(&[[1, 1]])).is_err());
    assert_eq!(
        bench.reports.last(),
        Some(&DrillReport::Fault(DrillFault::NotDown))
    );
}

/// A motor that was turned by whole cycles reaches its switch too early or too late. This is
/// reported at zero at the latest.
#[test]
fn lost_steps_are_found_at_the_switch() {
    for push in [-100, -4, 4, 60] {
        for axis in [0, 1] {
            let mut bench = Bench::<64>::new(quick(Rules::FIXED));
            let [there, back] = [[b'D', b'I'], [b'F', b'R']][axis];
            bench.all(&[Step::Clear, Step::Manual(200), Step::Key(there)]);
            assert_ne!(bench.rig.push(axis, push), 0);
            let failed = Ok(Outcome::Failed(Failure::Fault));
            assert_eq!(bench.run(Step::Key(back)), failed, "{push}");
            let lost = DrillReport::Fault(DrillFault::LostSteps { axis: axis as u8 });
            assert_eq!(bench.reports.last(), Some(&lost), "{push}");
            // There is no further report until the button is pressed.
            assert_eq!(
                bench.run(Step::Resync),
                Ok(Outcome::Failed(Failure::Silent))
            );
            bench.reset();
            bench.all(&[Step::AwaitBoot, Step::Test]);
        }
    }
}

/// Steps lost during a program are detected by the records that lead to zero. The host receives the
/// report then, not after the longest time of a program.
#[test]
fn a_program_that_lost_steps_ends_at_zero_with_a_fault() {
    for push in [-8, 8] {
        let mut bench = Bench::<64>::new(quick(Rules::FIXED));
        bench.all(&[Step::Clear, Step::Begin]);
        let program = [records(&[[40, 30], [50, 20]]), b"X\0\0Y\0\0".to_vec()].concat();
        let bytes: Vec<_> = program.iter().map(|byte| Step::Store(*byte)).collect();
        bench.all(&bytes);
        bench.all(&[Step::End]);
        bench.start(Step::Execute);
        let mut is_pushed = false;
        let outcome = loop {
            if let Some(outcome) = bench.advance() {
                break outcome;
            }
            if !is_pushed && bench.rig.place()[0] == 45 {
                is_pushed = bench.rig.push(1, push) != 0;
            }
        };
        assert!(is_pushed);
        assert_eq!(outcome, Outcome::Failed(Failure::Fault), "{push}");
        let lost = DrillReport::Fault(DrillFault::LostSteps { axis: 1 });
        assert_eq!(bench.reports.last(), Some(&lost), "{push}");
        assert!(!bench.rig.spindle_turns());
    }
}

/// A motor that stands still leaves its switch closed. This is reported after the distance that
/// opens it.
#[test]
fn a_motor_that_stands_still_is_found_at_its_closed_switch() {
    let mut bench = Bench::<64>::new(quick(Rules::FIXED));
    bench.rig.hold(0, Some(true));
    let failed = bench.program(&records(&[[40, 30]]));
    assert!(failed.is_err());
    let fault = DrillReport::Fault(DrillFault::StillClosed { axis: 0 });
    assert_eq!(bench.reports.last(), Some(&fault));
    let mut bench = Bench::<64>::new(quick(Rules::FIXED));
    bench.all(&[Step::Clear, Step::Manual(40)]);
    bench.rig.hold(0, Some(true));
    assert_eq!(
        bench.run(Step::Key(b'D')),
        Ok(Outcome::Failed(Failure::Fault))
    );
    let fault = DrillReport::Fault(DrillFault::LostSteps { axis: 0 });
    assert_eq!(bench.reports.last(), Some(&fault));
}

/// A switch that closes up to three steps late is accepted; zero does not change.
#[test]
fn a_switch_that_closes_a_little_late_is_no_fault() {
    let mut bench = Bench::<64>::new(quick(Rules::FIXED));
    bench.all(&[Step::Clear, Step::Manual(10), Step::Key(b'D')]);
    bench.rig.hold(0, Some(false));
    bench.start(Step::Key(b'I'));
    let mut lowest = 0;
    let outcome = loop {
        if let Some(outcome) = bench.advance() {
            break outcome;
        }
        let [x, ..] = bench.rig.place();
        lowest = lowest.min(x);
        if x == -2 {
            bench.rig.hold(0, None);
        }
    };
    assert_eq!(outcome, Outcome::Done);
    // A step that was already decided is made.
    assert!((-3..=-2).contains(&lowest), "{lowest}");
    assert_eq!(bench.rig.place()[0], 0);
    assert_eq!(bench.drill.position_steps()[0], 0);
}

/// The original attempts to drill beyond its table.
#[test]
fn a_record_beyond_the_table_is_a_fault() {
    let config = DrillConfig {
        travel_steps: [50, 40],
        ..quick(Rules::FIXED)
    };
    let mut bench = Bench::<64>::new(config);
    assert!(bench.program(&records(&[[50, 40], [1, 41]])).is_err());
    assert_eq!(bench.drilled(), [[50, 40]]);
    let off = DrillReport::Fault(DrillFault::OffTable { axis: 1 });
    assert_eq!(bench.reports.last(), Some(&off));
    // Manual motion ends at the edge of the table.
    bench.reset();
    bench.all(&[Step::AwaitBoot, Step::Clear, Step::Manual(60)]);
    for key in [b'D', b'F'] {
        let outcome = bench.run(Step::Key(key));
        assert_eq!(outcome, Ok(Outcome::Failed(Failure::NotAll)), "it says so");
    }
    assert_eq!(bench.rig.place(), [50, 40, 0]);
    // `c` off home: the end of the table does not change.
    bench.all(&[Step::Advance(20), Step::Key(b'I'), Step::Key(b'c')]);
    assert_eq!(bench.drill.position_steps(), [0, 0]);
    bench.all(&[Step::Key(b'D')]);
    let outcome = bench.run(Step::Key(b'D'));
    assert_eq!(outcome, Ok(Outcome::Failed(Failure::NotAll)));
    assert_eq!(bench.rig.place(), [50, 40, 0]);
}

/// Jogging, manual motion of Z between its sensors, the spindle, a new advance, and a program of
/// taught positions.
#[test]
fn places_are_taught_while_jogging() {
    let mut bench = Bench::<64>::new(quick(Rules::FIXED));
    bench.all(&[Step::Clear, Step::Manual(10)]);
    bench.all(&[Step::Key(b'D'), Step::Key(b'F'), Step::Teach]);
    bench.all(&[Step::Key(b'D'), Step::Advance(4), Step::Key(b'R')]);
    bench.all(&[Step::Teach, Step::Key(b'L')]);
    assert_eq!(bench.rig.place(), [20, 6, 4]);
    let not_all = Ok(Outcome::Failed(Failure::NotAll));
    for _ in 0..2 {
        assert_eq!(bench.run(Step::Key(b'L')), not_all);
    }
    assert_eq!(bench.rig.place(), [20, 6, 6], "the lower sensor");
    bench.all(&[Step::Key(b'O')]);
    assert!(bench.rig.spindle_turns());
    bench.all(&[Step::Key(b'U')]);
    assert_eq!(bench.run(Step::Key(b'U')), not_all);
    bench.all(&[Step::Key(b'S')]);
    assert_eq!(bench.rig.place(), [20, 6, 0], "the upper sensor");
    bench.all(&[Step::Key(b'I'), Step::Advance(200)]);
    assert_eq!(bench.run(Step::Key(b'I')), not_all);
    assert_eq!(bench.rig.place(), [0, 6, 0], "not below zero");
    bench.all(&[Step::Quit, Step::Spindle(true), Step::Execute]);
    assert!(!bench.rig.spindle_turns(), "the program has ended");
    // The program is kept during another manual session.
    bench.all(&[Step::ManualKept(7), Step::Key(b'D'), Step::Teach]);
    bench.all(&[Step::Quit, Step::Spindle(true), Step::Execute]);
    let holes = &bench.rig.holes()[1..];
    assert_eq!(holes.len(), 5);
    assert_eq!(holes[4].at, [7, 0]);
    let holes = &holes[..2];
    let hole = |at| DrilledHole {
        at,
        depth: 6,
        is_clean: true,
    };
    assert_eq!(holes, [hole([10, 10]), hole([20, 6])]);
}

/// A running program reports itself when queried, and the spindle stops at its end.
#[test]
fn a_program_that_runs_says_so() {
    for rules in [Rules::FIXED, Rules::FAITHFUL] {
        let mut bench = Bench::<64>::new(quick(rules));
        if rules.has_extras {
            bench.all(&[Step::Spindle(true)]);
        }
        bench.all(&[Step::Clear, Step::Begin]);
        let bytes: Vec<_> = records(&[[90, 10]])
            .iter()
            .map(|byte| Step::Store(*byte))
            .collect();
        bench.all(&bytes);
        bench.all(&[Step::End]);
        assert_eq!(bench.host.ask_at_work(), None, "nothing was begun");
        bench.start(Step::Execute);
        for _ in 0..20 {
            assert_eq!(bench.advance(), None);
        }
        assert!(!bench.host.is_at_work());
        let byte = bench.host.ask_at_work().expect("it was begun");
        bench.drill.push(byte);
        for _ in 0..20 {
            assert_eq!(bench.advance(), None);
        }
        assert_eq!(bench.host.is_at_work(), rules.has_extras);
        let outcome = loop {
            if let Some(outcome) = bench.advance() {
                break outcome;
            }
        };
        assert_eq!(outcome, Outcome::Done);
        assert!(!bench.rig.spindle_turns());
        assert_eq!(bench.drilled(), [[90, 10]]);
    }
}

/// The Z word as a depth. Both sensors remain limits, and 0 is the full stroke. The original
/// ignores it.
#[test]
fn depths() {
    for (rules, depths) in [
        (Rules::FIXED, [4, 5, 6, 6]),
        (Rules::FAITHFUL, [6, 6, 6, 6]),
    ] {
        let mut bench = Bench::<64>::new(quick(rules));
        let program = b"X\x01\0Z\x04\0X\x02\0Z\x05\0X\x03\0Z\0\0X\x04\0Z\xff\xff";
        assert_eq!(bench.program(program), Ok(()));
        let found: Vec<_> = bench.rig.holes().iter().map(|hole| hole.depth).collect();
        assert_eq!(found, depths);
        assert!(depths.iter().all(|depth| *depth > i32::from(BOARD)));
    }
}

/// If the drill is in the board when a program begins, it is raised first. The original drags it
/// through the board.
#[test]
fn z_is_raised_before_a_move() {
    for raises_first in [true, false] {
        let mut bench = Bench::<64>::new(DrillConfig {
            raises_first,
            ..quick(Rules::FAITHFUL)
        });
        bench.all(&[Step::Clear, Step::Manual(5), Step::Key(b'L'), Step::Quit]);
        let program = records(&[[9, 9]]);
        bench.all(&[Step::Clear, Step::Begin]);
        let bytes: Vec<_> = program.iter().map(|byte| Step::Store(*byte)).collect();
        bench.all(&bytes);
        bench.all(&[Step::End, Step::Execute]);
        assert_eq!(bench.rig.dragged_steps() == 0, raises_first);
    }
}

/// The button during a drilling: spindle off at once, up, home, `B`; the program is discarded.
#[test]
fn the_emergency_stop() {
    let mut bench = Bench::<64>::new(quick(Rules::FIXED));
    bench.all(&[Step::Spindle(true), Step::Clear, Step::Begin]);
    let bytes: Vec<_> = records(&[[30, 10], [2, 2]])
        .iter()
        .map(|byte| Step::Store(*byte))
        .collect();
    bench.all(&bytes);
    bench.all(&[Step::End]);
    bench.start(Step::Execute);
    let mut is_pressed = false;
    let outcome = loop {
        if let Some(outcome) = bench.advance() {
            break outcome;
        }
        let [.., z] = bench.rig.place();
        if z > i32::from(BOARD) && !is_pressed {
            is_pressed = true;
            bench.reset();
            bench.tick();
            assert!(!bench.rig.spindle_turns());
        }
    };
    assert_eq!(outcome, Outcome::Failed(Failure::Restarted));
    assert_eq!(bench.rig.place(), [0, 0, 0]);
    assert!(bench.drilled().is_empty());
    assert!(bench.drill.stored().is_empty());
}

/// The holes of the short program. Some of its bytes are command letters.
const HOLES: [[u16; 2]; 4] = [[0x42, 0x65], [0x72, 0x66], [0x77, 0x42], [0x00, 0x6d]];

/// Every event at every byte of a short program that crosses the boundary of a small memory three
/// times.
#[test]
fn any_event_at_any_byte_is_survived_or_reported() {
    for rules in [Rules::FIXED, Rules::FAITHFUL] {
        let mut good = Bench::<10>::new(quick(rules));
        let first = good.carried;
        assert_eq!(good.program(&records(&HOLES)), Ok(()));
        assert_eq!(good.drilled(), places(&HOLES));
        let (mut reported, mut unharmed) = (0, 0);
        for place in first..good.carried {
            for event in events() {
                let mut bench = Bench::<10>::new(quick(rules));
                bench.event = Some((place, event));
                let context = format!("{rules:?}, {event:?} at {}", place - first);
                if survives(&mut bench, &HOLES, rules, &context) {
                    unharmed += 1;
                } else {
                    reported += 1;
                }
            }
        }
        println!("{reported} reported, {unharmed} without harm");
        assert!(reported > 500 && unharmed > 50, "{reported}, {unharmed}");
    }
}

/// The same at any byte of long programs.
#[test]
fn events_in_long_programs_are_survived_or_reported() {
    let (mut numbers, mut reported) = (Random::new(11), 0);
    let mut random = |below: u64| numbers.below(below);
    let events: Vec<_> = events().collect();
    for round in 0..40 {
        let holes: Vec<[u16; 2]> = (0..120)
            .map(|_| [random(300) as u16, random(300) as u16])
            .collect();
        let mut bench = Bench::<256>::new(quick(Rules::FIXED));
        let place = bench.carried + random(2 * 9 * 120);
        let event = events[random(events.len() as u64) as usize];
        bench.event = Some((place, event));
        let context = format!("round {round}, {event:?} at {place}");
        reported += u32::from(!survives(&mut bench, &holes, Rules::FIXED, &context));
    }
    assert!(reported > 20, "{reported}");
}

/// Drills these holes; returns `false` where an error was reported. The operator then continues.
/// Where the device reports its progress, that alone is used; otherwise the board is inspected,
/// which has exactly the holes that the host reported. At the end every hole exists once, at its
/// position.
fn survives<const N: usize>(
    bench: &mut Bench<N>,
    holes: &[[u16; 2]],
    rules: Rules,
    context: &str,
) -> bool {
    let program = records(holes);
    let is_well = bench.program(&program).is_ok();
    assert_eq!(bench.rig.lost_steps(), [0; 3], "{context}");
    if is_well {
        assert_eq!(bench.drilled(), places(holes), "{context}");
        return true;
    }
    let [done, begun] = [bench.host.done_bytes(), bench.host.begun_bytes()]
        .map(|bytes| (bytes as usize / 9).min(holes.len()));
    bench.rest();
    // The cable is connected again. The next byte runs a full memory.
    (bench.event, bench.is_unplugged) = (None, false);
    for _ in 0..2 {
        let _ = bench.run(Step::Resync);
        bench.rest();
    }
    assert_eq!(bench.run(Step::Resync), Ok(Outcome::Done), "{context}");
    let drilled = bench.drilled();
    let expected = places(holes);
    assert!(
        (done..=begun).contains(&drilled.len()),
        "{context}: {} holes; {done} reported done, {begun} begun",
        drilled.len()
    );
    assert_eq!(drilled, expected[..drilled.len()], "{context}");
    let mut next = drilled.len();
    if rules.has_extras {
        bench.all(&[Step::Read(COUNT)]);
        let [letter, low, high] = bench.host.record();
        let holes_done = usize::from(u16::from_le_bytes([low, high]));
        // If `c` was not received yet, nothing was run. After a reset the board has to be
        // inspected.
        if letter == b'c' {
            assert_eq!(holes_done, next, "{context}: it counts what it did");
            next = holes_done;
        }
    }
    if next < holes.len() {
        assert_eq!(bench.program(&records(&holes[next..])), Ok(()), "{context}");
    }
    assert_eq!(bench.drilled(), expected, "{context}");
    assert_eq!(bench.rig.dragged_steps(), 0, "{context}");
    false
}

/// The lamps of the panel in each state, of both kinds of drill.
#[test]
fn lamps_show_what_the_drill_does() {
    for is_original in [false, true] {
        let mut device = Device::new(2400, is_original);
        let lit = |device: &mut Device, bytes: &[u8], ms: u32| -> Vec<String> {
            for byte in bytes {
                device.send(*byte);
                (0..20).for_each(|_| drop(device.tick()));
            }
            (0..ms).for_each(|_| drop(device.tick()));
            let lights = device.control("lights");
            let lamps = lights.split(", ");
            let lamps = lamps.filter_map(|lamp| lamp.strip_suffix(" on"));
            // The heartbeat has its own test.
            let lamps = lamps.filter(|lamp| *lamp != "ready");
            lamps.map(str::to_owned).collect()
        };
        let z: &[&str] = if is_original {
            &["home"]
        } else {
            &["home", "drill"]
        };
        assert_eq!(lit(&mut device, b"", 100), z, "Z homes first");
        assert_eq!(lit(&mut device, b"", 500), ["y", "home"]);
        assert_eq!(lit(&mut device, b"", 1500), ["x", "home"]);
        assert!(lit(&mut device, b"", 2000).is_empty());
        assert_eq!(lit(&mut device, b"m", 0), ["manual"]);
        let homes = lit(&mut device, b"\xff", 100);
        assert!(homes.contains(&"home".to_owned()) && homes.contains(&"manual".to_owned()));
        assert_eq!(lit(&mut device, b"", 20_000), ["manual"]);
        assert_eq!(lit(&mut device, b"D", 100), ["x", "manual"]);
        assert_eq!(lit(&mut device, b"", 1000), ["manual"]);
        assert_eq!(lit(&mut device, b"O", 10), ["drill", "manual"]);
        assert_eq!(lit(&mut device, b"SQ", 10), [""; 0]);
        assert_eq!(lit(&mut device, b"c", 10), [""; 0]);
        assert_eq!(lit(&mut device, b"bY\x10\0", 10), ["receive"]);
        assert_eq!(lit(&mut device, b"Z\0\0f", 10), [""; 0]);
        assert_eq!(lit(&mut device, b"e", 20), ["y"]);
        assert_eq!(lit(&mut device, b"", 1000), ["drill"]);
        // Z is up, the memory is filled.
        assert_eq!(lit(&mut device, b"", 40_000), [""; 0]);
        let rest: Vec<u8> = (0..8186).map(|place| b"X\0\0"[place % 3]).collect();
        assert_eq!(lit(&mut device, b"b", 10), ["receive"]);
        assert_eq!(lit(&mut device, &rest, 10), ["receive", "full"]);
    }
}

/// The lamp that shows that the drill is ready for commands blinks: with the clock of an emulator,
/// and as events of a controller whose firmware has none. A byte is obeyed at once all the same.
#[test]
fn the_heartbeat_blinks_while_the_drill_is_ready() {
    let period_us = u64::from(DrillConfig::HEARTBEAT_US);
    let mut device = Device::new(2400, true);
    let is_lit = |device: &mut Device| {
        let lights = device.control("lights");
        lights.contains("ready on")
    };
    let mut changes = Vec::new();
    let mut before = false;
    for ms in 0..20_000_u64 {
        device.tick();
        if is_lit(&mut device) != before {
            before = !before;
            changes.push(ms);
        }
    }
    let waits = changes.windows(2).skip(1).map(|pair| pair[1] - pair[0]);
    assert!(changes.len() > 20 && waits.clone().all(|ms| ms.abs_diff(period_us / 1000) < 2));
    assert!(changes[0] > 3000, "it homes before: {changes:?}");
    device.send(b'r');
    (0..1000).for_each(|_| {
        device.tick();
        assert!(!is_lit(&mut device) || device.control("lights").contains("home off"));
    });

    let config = DrillConfig {
        blinks: true,
        ..quick(Rules::FIXED)
    };
    let rig = DrillRig::new([3, 0, 2], 6, 3, 0);
    let mut emulated = Emulated::new(Drill::<64>::new(config), vec![rig]);
    emulated.pass(100_000, |_, _, _, _| {});
    assert_eq!(emulated.transmit(), Some(b'B'));
    let mut lit = Vec::new();
    for _ in 0..4 {
        emulated.pass(period_us, |_, _, _, _| {});
        lit.push(emulated.controller().heartbeat());
    }
    assert_eq!(lit, [true, false, true, false]);
    emulated.pass(period_us / 2, |_, _, _, _| {});
    emulated.receive(b'r');
    let mut first_us = None;
    let begin_us = emulated.now_us();
    emulated.pass(100_000, |_, at_us, _, _| {
        first_us.get_or_insert(at_us);
    });
    assert!(
        first_us.is_some_and(|us| us - begin_us < 2000),
        "{first_us:?}"
    );
    assert_eq!(emulated.transmit(), Some(b'r'));
}
