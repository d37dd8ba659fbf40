//! Commands from stages before the machine, and its own stage.

use husillo_machine::gcode::{Block, Command, Compensation, ErrorKind, Feed, Modal, Nm, Tool};
use husillo_machine::{Event, Machine, Means, MoveError, Origin, Refused};
use proptest::prelude::*;

use crate::{ExtendedMachine, config, run};

const CONTOUR: [&str; 8] = [
    "G10 L1 P1 R2",
    "G0 X50 Y50 Z1",
    "T1 M6",
    "G1 G41 X60 Y60 D1 F600",
    "X100 M8",
    "G3 X120 Y80 J20",
    "G1 X60",
    "G40 X50 Y50",
];

fn steps(events: &[Event<3>]) -> Vec<Event<3>> {
    let moves = |event: &&Event<3>| matches!(event, Event::Step(_) | Event::Dwell { .. });
    events.iter().filter(moves).copied().collect()
}

/// Modal state, compensation and machine, called one after the other by the user, give the same
/// events as the machine itself.
#[test]
fn compensation_stands_before_the_machine() {
    let mut inside = Vec::new();
    run(
        &mut ExtendedMachine::new(config(true)),
        &CONTOUR,
        |_, event| inside.push(*event),
    );

    let mut machine = ExtendedMachine::new(config(true));
    let dialect = machine.config().dialect;
    let mut modal = Modal::<3>::new(dialect);
    let mut stage = Compensation::new(modal.position());
    let mut outside = Vec::new();
    for line in CONTOUR {
        let block = Block::parse(line.as_bytes(), &dialect).unwrap();
        let (next, commands) = modal.plan(&block).unwrap();
        let (after, commands) = stage.plan(commands).unwrap();
        (modal, stage) = (next, after);
        machine.commands(commands).unwrap();
        while !machine.has_room() {
            outside.push(machine.next_event().unwrap());
        }
    }
    outside.extend(core::iter::from_fn(|| machine.next_event()));
    assert_eq!(steps(&inside), steps(&outside));
    assert!(inside.len() > 10_000);
    // 2 mm to the left of X60 to X100 at Y60.
    let tool = ExtendedMachine::new(config(false));
    assert_eq!(tool.modal().tool_data(1), None::<Tool<3>>);
}

/// The axis of the tool keeps the radius from the contour, on both sides.
#[test]
fn the_tool_is_beside_the_contour() {
    for (code, offset) in [("G41", 2.0), ("G42", -2.0)] {
        let mut machine = ExtendedMachine::new(config(false));
        let mut seen = 0;
        let entry = format!("G1 {code} X60 Y60 D1 F600");
        let lines = [
            "G10 L1 P1 R2",
            "G0 X50 Y50",
            "T1 M6",
            &entry,
            "X100",
            "X140",
        ];
        run(&mut machine, &lines, |machine, event| {
            let [x, y, _] = machine
                .position_steps()
                .map(|steps| f64::from(steps) * 2.5e-3);
            if matches!(event, Event::Step(_)) && (60.0..=139.0).contains(&x) && y != 50.0 {
                seen += 1;
                if (62.0..99.0).contains(&x) {
                    assert!((y - 60.0 - offset).abs() < 0.003, "{code} X{x} Y{y}");
                }
            }
        });
        assert!(seen > 10_000, "{code}: {seen}");
        // Without G40 and M2 the last move still ends, beside its own end.
        assert_eq!(machine.position_steps()[0], 56_000);
    }
}

#[test]
fn a_plain_machine_refuses_what_it_has_no_means_for() {
    let mut machine: Machine<3> = Machine::new(config(false));
    machine.line(b"G10 L1 P1 R2").unwrap();
    for (line, means) in [
        ("G41 D1", Means::RadiusCompensation),
        ("G38.2 Z-1 F10", Means::Probe),
        ("G5 X1 Y1 I1 J0 P0 Q-1 F10", Means::Splines),
        ("M64 P0", Means::InputsAndOutputs),
        ("M67 E0 Q1", Means::InputsAndOutputs),
        ("M66 P0 L0", Means::InputsAndOutputs),
        ("G96 S100 M3", Means::SurfaceSpeed),
        ("M19 R0", Means::SpindleAngle),
        ("M60", Means::Pallets),
        ("M52 P1", Means::AdaptiveFeed),
    ] {
        assert_eq!(
            machine.line(line.as_bytes()),
            Err(Refused::Move(MoveError::Unsupported(means))),
            "{line}"
        );
        assert_eq!(machine.next_event(), None, "{line}");
    }
}

#[test]
fn an_extended_machine_refuses_what_its_equipment_lacks() {
    let mut machine = ExtendedMachine::new(config(false));
    for (line, means) in [
        ("M64 P4", Means::InputsAndOutputs),
        ("M68 E2 Q1", Means::InputsAndOutputs),
        ("M66 P4 L0", Means::InputsAndOutputs),
        ("M66 E2 L0", Means::InputsAndOutputs),
    ] {
        let refused = Err(Refused::Move(MoveError::Unsupported(means)));
        assert_eq!(machine.line(line.as_bytes()), refused, "{line}");
    }
    for line in ["M64 P3", "M68 E1 Q1", "M52 P0", "M60"] {
        machine.line(line.as_bytes()).unwrap();
        while machine.next_event().is_some() {}
    }
}

#[test]
fn commands_are_taken_all_or_none() {
    let feed = Feed::PerMinute(Nm(600_000_000));
    let to = |x: i64| [Nm(x * 1_000_000), Nm(0), Nm(0)];
    let inside = Command::Linear { to: to(10), feed };
    let beyond = Command::Linear { to: to(301), feed };
    let mut machine = ExtendedMachine::new(config(false));
    assert!(matches!(
        machine.check([inside, beyond]),
        Err(MoveError::Travel { axis: 0, .. })
    ));
    assert!(machine.command(&beyond).is_err());
    assert_eq!(machine.next_event(), None);
    machine.check([inside]).unwrap();
    machine.command(&inside).unwrap();
    assert_eq!(machine.modal().position(), to(10));
    assert_eq!(core::iter::from_fn(|| machine.next_event()).count(), 4_000);
    assert_eq!(machine.origin(), Origin::Feed);
    // The same for a block whose second hole is beyond the travel.
    let mut modal = Modal::<3>::new(machine.config().dialect);
    modal.set_position(to(10));
    let holes = Block::parse(b"G91 G81 X200 Z-1 R0 L2 F600", modal.dialect()).unwrap();
    let (_, commands) = modal.plan(&holes).unwrap();
    let (_, commands) = Compensation::new(to(10)).plan(commands).unwrap();
    assert!(machine.commands(commands).is_err());
    assert_eq!(machine.next_event(), None);
    assert_eq!(machine.modal().position(), to(10));
}

#[test]
fn an_error_of_the_stage_changes_nothing() {
    let mut machine = ExtendedMachine::new(config(false));
    for line in ["G10 L1 P1 R2", "G0 X50 Y50", "G1 G41 X60 D1 F600", "X62"] {
        machine.line(line.as_bytes()).unwrap();
        while machine.next_event().is_some() {}
    }
    let before = (machine.position_steps(), machine.modal().position());
    // The inside corner leaves no room for the tool.
    let refused = machine.line(b"Y50.5");
    let Err(Refused::Program(error)) = refused else {
        panic!("{refused:?}")
    };
    assert_eq!(error.kind, ErrorKind::Gouge);
    assert_eq!(
        (machine.position_steps(), machine.modal().position()),
        before
    );
}

/// Moves of every kind that a plain machine makes.
const MOVES: [&str; 18] = [
    "G0 X1 Y1 Z0.5",
    "G1 X2 F600.5",
    "G2 X3 Y0 J-1 P2",
    "G3 X3 Y2 R1",
    "G2 X3 Y0.002 R1",
    "G3 X2 Y1 Z1 R-1.5",
    "G2 I0.5",
    "G18 G3 X3 Z0 R1",
    "G17 G20 G2 X0.1 Y0.05 R0.5",
    "G21 G91 G3 X0.001 R0.002",
    "G19 G2 Y0.5 Z0.5 R0.5",
    "G90 G17 G93 G1 X2 Y2 F30",
    "G2 X1 Y1 R2 F60",
    "G94 G1 Y1 F200",
    "M3 S60 G95 G1 X1.1 F0.5",
    "G2 X1.3 R0.1 F0.25",
    "G33 Z0.2 K0.1",
    "X1.5 Z0.1 K0.2",
];

/// A plain machine keeps less of a move in its queue. It reports the same moves with its events.
#[test]
fn a_plain_machine_reports_the_same_moves() {
    for has_ramps in [false, true] {
        let mut config = config(has_ramps);
        config.spindle_counts = Some(400);
        for (axis, backlash_steps) in config.axes.iter_mut().zip([7, 5, 0]) {
            axis.backlash_steps = backlash_steps;
            axis.travel = None;
        }
        let mut plain: Machine<3> = Machine::new(config);
        let mut extended = ExtendedMachine::new(config);
        let (mut moves, mut last) = (0, None);
        let mut next = |plain: &mut Machine<3>, extended: &mut ExtendedMachine| {
            let event = plain.next_event();
            assert_eq!(event, extended.next_event());
            assert_eq!(plain.executing(), extended.executing());
            moves += usize::from(last != plain.executing().copied());
            last = plain.executing().copied();
            event
        };
        for line in MOVES {
            while !plain.has_room() {
                next(&mut plain, &mut extended);
            }
            plain.line(line.as_bytes()).expect(line);
            extended.line(line.as_bytes()).expect(line);
        }
        while next(&mut plain, &mut extended).is_some() {}
        assert!(moves > 15, "{moves}");
    }
}

proptest! {
    /// An extended machine makes of plain moves exactly the events of a plain one.
    #[test]
    fn plain_moves_are_the_same(
        ends in prop::collection::vec((0_i64..2000, 0_i64..2000, 0_i64..3), 1..8),
        has_ramps: bool,
    ) {
        let mut plain: Machine<3> = Machine::new(config(has_ramps));
        let mut extended = ExtendedMachine::new(config(has_ramps));
        let (mut first, mut second) = (Vec::new(), Vec::new());
        for (x, y, code) in ends {
            let line = format!("G{} X{x}e-3 Y{y}e-3 F600", code.min(1)).replace("e-3", "");
            let line = line.replace('X', "X0.").replace('Y', "Y0.");
            for line in [line.as_bytes()] {
                while !plain.has_room() { first.extend(plain.next_event()); }
                while !extended.has_room() { second.extend(extended.next_event()); }
                prop_assert_eq!(plain.line(line), extended.line(line));
            }
        }
        first.extend(core::iter::from_fn(|| plain.next_event()));
        second.extend(core::iter::from_fn(|| extended.next_event()));
        prop_assert_eq!(first, second);
    }
}
