//! The modal state: reading it, and changing it from outside.

#![cfg(feature = "extended")]

use husillo_gcode::{
    Block, Dialect, Distance, FeedMode, Modal, Motion, Nm, PathMode, Plane, SpindleDirection, Tool,
    Units,
};

/// The state after these lines.
fn after(lines: &[&str]) -> Modal<3> {
    let mut modal = Modal::new(Dialect::RS274);
    for line in lines {
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
        modal = modal.plan(&block).expect(line).0;
    }
    modal
}

/// A program starts with everything off, nothing set, and no motion.
#[test]
fn the_state_at_the_start() {
    let modal = after(&[]);
    assert_eq!(modal.position(), [Nm(0); 3]);
    assert_eq!(modal.motion(), None);
    assert_eq!(
        (modal.plane(), modal.units()),
        (Plane::Xy, Units::Millimetres)
    );
    assert_eq!(modal.distance(), Distance::Absolute);
    assert_eq!(modal.centre_distance(), Distance::Incremental);
    assert_eq!(
        (modal.feed_mode(), modal.feed()),
        (FeedMode::PerMinute, None)
    );
    assert_eq!(modal.spindle(), (SpindleDirection::Off, 0));
    assert_eq!(modal.coolant(), (false, false));
    assert_eq!((modal.tool(), modal.loaded_tool()), (0, 0));
    assert_eq!(modal.path(), PathMode::Blend { tolerance: None });
    assert_eq!((modal.compensation(), modal.is_diameter()), (None, false));
    assert_eq!((modal.work_system(), modal.tool_length()), (0, [Nm(0); 3]));
    assert_eq!(
        (modal.home(), modal.second_home()),
        ([Nm(0); 3], [Nm(0); 3])
    );
}

/// The state that a program sets can be read.
#[test]
fn the_state_a_program_makes() {
    let modal = after(&[
        "G90.1 G18 G20 G91 G55",
        "T3 M6",
        "T7",
        "M4 S100 M8",
        "G1 X1 F2",
    ]);
    assert_eq!(modal.position(), [25_400_000, 0, 0].map(Nm));
    assert_eq!(modal.motion(), Some(Motion::Linear));
    assert_eq!((modal.plane(), modal.units()), (Plane::Zx, Units::Inches));
    assert_eq!(modal.distance(), Distance::Incremental);
    assert_eq!(modal.centre_distance(), Distance::Absolute);
    assert_eq!(modal.feed(), Some(Nm(50_800_000)));
    assert_eq!(
        modal.spindle(),
        (SpindleDirection::CounterClockwise, 100_000)
    );
    assert_eq!(modal.coolant(), (false, true));
    assert_eq!((modal.tool(), modal.loaded_tool()), (7, 3));
    assert_eq!(modal.work_system(), 1);
    assert_eq!(after(&["M7"]).coolant(), (true, false));
    assert_eq!(after(&["G61.1"]).path(), PathMode::ExactStop);
    assert_eq!(
        after(&["G43.1 Z1"]).tool_length(),
        [0, 0, 1_000_000].map(Nm)
    );
    let homes = after(&["G0 X1", "G28.1", "X2", "G30.1"]);
    assert_eq!(homes.home(), [1_000_000, 0, 0].map(Nm));
    assert_eq!(homes.second_home(), [2_000_000, 0, 0].map(Nm));
}

/// A feed is reported under G94 only, and not when it is zero.
#[test]
fn a_feed_is_reported_under_g94_only() {
    assert_eq!(after(&["F2"]).feed(), Some(Nm(2_000_000)));
    assert_eq!(after(&["F0"]).feed(), None);
    assert_eq!(after(&["G93 F2"]).feed(), None);
    assert_eq!(after(&["F2", "G93"]).feed_mode(), FeedMode::InverseTime);
    assert_eq!(after(&["G95 F2"]).feed(), None);
}

/// Spindle and coolant are off after an abort.
#[test]
fn an_abort_stops_the_outputs() {
    let mut modal = after(&["M3 S100 M8", "M7"]);
    assert_eq!(modal.coolant(), (true, true));
    modal.stop_outputs();
    assert_eq!(modal.spindle().0, SpindleDirection::Off);
    assert_eq!(modal.coolant(), (false, false));
}

/// Zeros of work frames, homes and the position are kept as written, separately.
#[test]
fn places_are_written_from_outside() {
    let mut modal = after(&[]);
    let place = |system: u8| [i64::from(system) + 1, 20, 30].map(Nm);
    for system in 0..9 {
        assert!(modal.set_work_zero(system, place(system)));
    }
    for system in 0..9 {
        assert_eq!(modal.work_zero(system), Some(place(system)));
    }
    for system in [9, 255] {
        assert!(!modal.set_work_zero(system, place(0)));
        assert_eq!(modal.work_zero(system), None);
    }
    assert_eq!(modal.work_offset(), place(0));
    modal.set_home(place(20));
    modal.set_second_home(place(30));
    modal.set_position(place(40));
    assert_eq!(
        (modal.home(), modal.second_home(), modal.position()),
        (place(20), place(30), place(40))
    );
}

/// The table holds eight tools; tool 0 has no entry.
#[test]
fn tools_are_written_from_outside() {
    let mut modal = after(&[]);
    let tool = |number: u32| Tool {
        offset: [0, 0, i64::from(number)].map(Nm),
        radius: Nm(5),
    };
    assert!(!modal.set_tool(0, tool(1)));
    for number in 1..9 {
        assert_eq!(modal.tool_data(number), None);
        assert!(modal.set_tool(number, tool(number)));
    }
    assert!(!modal.set_tool(9, tool(9)));
    assert_eq!(modal.tool_data(9), None);
    for number in 1..9 {
        assert_eq!(modal.tool_data(number), Some(tool(number)));
    }
}

/// On lathes X can be a diameter; elsewhere it cannot.
#[test]
fn diameters() {
    assert!(Modal::<3>::new(Dialect::LATHE).is_diameter());
    assert!(Modal::<3>::new(Dialect::LATHE_A).is_diameter());
    assert!(!after(&["G8"]).is_diameter());
    assert!(after(&["G7"]).is_diameter());
}

/// The end of a program resets the motion mode and a feed that is not of G94.
#[test]
fn the_state_after_the_end() {
    assert_eq!(after(&["G0 X1", "M2"]).motion(), Some(Motion::Linear));
    assert_eq!(after(&["F2", "M2"]).feed(), Some(Nm(2_000_000)));
    assert_eq!(after(&["G95 F2", "M2"]).feed(), None);
}

/// A machine may have more axes than there are letters; angles are degrees in inches too.
#[test]
fn axes_of_machines() {
    fn position<const N: usize>() -> [Nm; N] {
        let block = Block::parse(b"G20 G0 X1 A1", &Dialect::RS274).expect("a block");
        let planned = Modal::<N>::new(Dialect::RS274).plan(&block);
        planned.expect("a plan").0.position()
    }
    assert_eq!(position::<4>(), [25_400_000, 0, 0, 1_000_000].map(Nm));
    assert_eq!(position::<15>()[3], Nm(1_000_000));
    assert_eq!(position::<16>()[3], Nm(1_000_000));
    assert_eq!(position::<17>()[3], Nm(1_000_000));
    let mut modal = Modal::<17>::new(Dialect::RS274);
    modal.set_position([Nm(5); 17]);
    let block = Block::parse(b"G0 X1", &Dialect::RS274).expect("a block");
    let there = modal.plan(&block).expect("a plan").0.position();
    assert_eq!((there[0], there[16]), (Nm(1_000_000), Nm(5)));
    let block = Block::parse(b"G91 G28 X0", &Dialect::RS274).expect("a block");
    let home = modal.plan(&block).expect("a plan").0.position();
    assert_eq!((home[0], home[1], home[16]), (Nm(0), Nm(5), Nm(5)));
}

/// Surface speeds are metres per minute, or feet per minute; a spindle that stands has none.
#[test]
fn surface_speeds() {
    let made = |before: &[&str], line: &str| {
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
        after(before)
            .plan(&block)
            .expect(line)
            .1
            .collect::<Vec<_>>()
    };
    assert_eq!(made(&["G20"], "G96 S100 M3"), made(&[], "G96 S30.48 M3"));
    assert_eq!(made(&["G96 S100 M3"], "M5"), made(&["S100 M3"], "M5"));
}

/// Words at the limits of their ranges.
#[test]
fn ranges() {
    use husillo_gcode::ErrorKind;
    let verdict = |before: &[&str], line: &str| {
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
        after(before).plan(&block).err().map(|error| error.kind)
    };
    assert_eq!(verdict(&[], "G96 D1 S1"), None);
    let refused = Some(ErrorKind::OutOfRange(b'D'));
    assert_eq!(verdict(&[], "G96 D0 S1"), refused);
    assert_eq!(verdict(&[], "M19 R0 P2"), None);
    let refused = Some(ErrorKind::OutOfRange(b'P'));
    assert_eq!(verdict(&[], "M19 R0 P3"), refused);
    assert_eq!(verdict(&[], "G64 P0"), None);
    assert_eq!(verdict(&[], "G64 P-1"), Some(ErrorKind::Negative(b'P')));
    // While the contour is compensated, only the frame in effect may be programmed.
    assert_eq!(verdict(&["G41.1 D1"], "G54"), None);
    let refused = Some(ErrorKind::UnderCompensation);
    assert_eq!(verdict(&["G41.1 D1"], "G55"), refused);
    let block = Block::parse(b"G54X1", &Dialect::MICROMILL).expect("a block");
    let error = Modal::<3>::new(Dialect::MICROMILL).plan(&block).err();
    let refused = Some(ErrorKind::TwoUsersOfWords);
    assert_eq!(error.map(|error| error.kind), refused);
}

/// Dialects with checksums report it, lines that are too long have their number, and unprintable
/// bytes are named by their value.
#[test]
fn what_else_is_reported() {
    use husillo_gcode::{ErrorKind, Framing, LineTooLong};
    assert_eq!(Dialect::PRINTER.framing(), Some(Framing::PRINTER));
    assert_eq!(Dialect::GRBL.framing(), None);
    assert_eq!(LineTooLong { at: 1, end: 2 }.code(), 104);
    assert!(ErrorKind::NotALetter(b'!').to_string().starts_with("`!`"));
    assert!(!ErrorKind::NotALetter(7).to_string().contains('\u{7}'));
    let kind = |line: &str| {
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
        after(&[]).plan(&block).err().map(|error| error.kind)
    };
    assert_eq!(kind("G90.1 G2 X1 I1 F1"), Some(ErrorKind::HalfCentre));
    let spline = Block::parse(b"G5 X3 I1 J1 P-1 Q1 F1", &Dialect::RS274).expect("a block");
    let (next, mut commands) = after(&[]).plan(&spline).expect("a plan");
    let end = commands.next().and_then(|command| command.end());
    assert_eq!(end, Some(next.position()));
    let shown = |line: &str| {
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
        let (_, mut commands) = after(&[]).plan(&block).expect(line);
        commands.next().map(|command| command.to_string())
    };
    let [left, right] = ["G41.1 D2", "G42.1 D2"].map(|line| shown(line).unwrap_or_default());
    assert!(left.starts_with("compensation left xy") && right.starts_with("compensation right xy"));
}

/// Degrees stay degrees where lengths are inches.
#[test]
fn rotary_axes_have_no_inches() {
    for line in ["G0 A10", "G53 G0 A10", "G0 X1 A10", "G91 G0 A10"] {
        // With X as a diameter, axes are read one by one.
        for units in ["G20", "G20 G7"] {
            let mut modal = Modal::<4>::new(Dialect::RS274);
            for line in [units, line] {
                let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
                modal = modal.plan(&block).expect(line).0;
            }
            assert_eq!(modal.position()[3], Nm(10_000_000), "{units} {line}");
        }
    }
}
