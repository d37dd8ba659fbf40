//! Limits of acceptance: arcs and inputs just inside and just outside them.

use husillo_gcode::{Arc, Block, Command, Dialect, Direction, ErrorKind, Modal, Nm, Plane, Units};

/// The reason for refusing a line, from zero in millimetres.
fn verdict(line: &str) -> Option<ErrorKind> {
    verdict_in(Dialect::RS274, line)
}

fn verdict_in(dialect: Dialect, line: &str) -> Option<ErrorKind> {
    let modal = Modal::<3>::new(dialect);
    Block::parse(line.as_bytes(), &dialect)
        .and_then(|block| modal.plan(&block).map(|_| ()))
        .err()
        .map(|error| error.kind)
}

/// In `grbl` the end of an arc may be off its circle by 5 um, by more up to 0.1 % of the radius,
/// and never by more than 0.5 mm.
#[test]
fn ends_off_the_arc_of_grbl() {
    for (line, is_taken) in [
        ("G2 X2.005 I1 F1", true),
        ("G2 X2.006 I1 F1", false),
        ("G2 X12.006 I6 F1", true),
        ("G2 X12.006001 I6 F1", false),
        ("G2 X20.009 I10 F1", true),
        ("G2 X20.012 I10 F1", false),
        ("G2 X20.1 I10 F1", false),
        ("G2 X2000.5 I1000 F1", true),
        ("G2 X2000.501 I1000 F1", false),
        ("G2 X2001 I1000 F1", false),
    ] {
        ends_as(Dialect::GRBL, line, is_taken);
    }
}

/// Elsewhere it is LinuxCNC's rule: 28.284 um, 71.842 um in inches, more up to 0.1 % of the radius,
/// and never more than 100 times the first figure. One and a half units of the last printed digit
/// are always taken, up to half a millimetre.
#[test]
fn ends_off_the_arc() {
    for (line, is_taken) in [
        ("G2 X2.028284 I1 F1", true),
        ("G2 X2.028285 I1 F1", false),
        ("G2 X60.030 I30.000 F1", true),
        ("G2 X60.031 I30.000 F1", false),
        ("G2 X6002.828 I3000.000 F1", true),
        ("G2 X6002.829 I3000.000 F1", false),
        ("G20 G2 X0.2028 I0.1000 F1", true),
        ("G20 G2 X0.2029 I0.1000 F1", false),
        // 381 um and 150 um are 1.5 units.
        ("G20 G2 X0.21 I0.1 F1", true),
        ("G2 X2.1 I1.0 F1", true),
        ("G2 X2.2 I1.0 F1", false),
        // Of 1.5 mm only 0.5 count.
        ("G2 X3 I1 F1", false),
    ] {
        ends_as(Dialect::RS274, line, is_taken);
    }
}

/// Lengths in micrometres have the slack of Grbl: the micro mill steps 2.5 um.
#[test]
fn ends_off_the_arc_in_micrometres() {
    for (line, is_taken) in [
        ("G2 X2005 Y0 I1000 J0 F1", true),
        ("G2 X2006 Y0 I1000 J0 F1", false),
    ] {
        ends_as(Dialect::MICROMILL, line, is_taken);
    }
    // An arc made without a line.
    let (from, centre) = ([Nm(0); 3], [Nm(1_000_000), Nm(0), Nm(0)]);
    for (units, end_nm, is_taken) in [
        (Units::Micrometres, 2_005_000, true),
        (Units::Micrometres, 2_006_000, false),
        (Units::Millimetres, 2_028_000, true),
        (Units::Inches, 2_071_000, true),
        (Units::Inches, 2_072_000, false),
    ] {
        let to = [Nm(end_nm), Nm(0), Nm(0)];
        let arc = Arc::around(&from, to, centre, Plane::Xy, Direction::Clockwise, units);
        assert_eq!(arc.is_some(), is_taken, "{units:?} {end_nm}");
    }
}

fn ends_as(dialect: Dialect, line: &str, is_taken: bool) {
    let verdict = verdict_in(dialect, line);
    assert_eq!(verdict.is_none(), is_taken, "{line}");
    assert!(verdict.is_none_or(|kind| matches!(kind, ErrorKind::EndOffArc(_))));
}

/// A radius may be short of half the chord by 5 um and by 1 % of itself.
#[test]
fn radii_shorter_than_half_the_chord() {
    for (line, is_taken) in [
        ("G2 X2 R1 F1", true),
        ("G2 X2 R.995 F1", true),
        ("G2 X2 R.994999 F1", false),
        ("G2 X.808 R.4 F1", true),
        ("G2 X.80802 R.4 F1", false),
        ("G2 X.81 R.4 F1", false),
    ] {
        let verdict = verdict(line);
        assert_eq!(verdict.is_none(), is_taken, "{line}");
        assert!(verdict.is_none_or(|kind| matches!(kind, ErrorKind::RadiusTooSmall(_))));
    }
}

/// The arc of a line, from zero.
fn arc(line: &str) -> Arc<3> {
    let modal = Modal::<3>::new(Dialect::RS274);
    let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect("a block");
    let (_, mut commands) = modal.plan(&block).expect("a plan");
    match commands.next() {
        Some(Command::Arc { arc, .. }) => arc,
        other => panic!("{line}: {other:?}"),
    }
}

/// Centres from the radius of arcs that are almost half circles: half the chord, the height, the
/// radius and the centre are whole nanometres.
#[test]
fn centres_close_to_the_chord() {
    for m in [1_i64, 10, 31, 32, 63, 64, 127, 128, 1000, 20_000] {
        let (height, half) = (2 * m + 1, 2 * m * (m + 1));
        let nm = |value: i64| format!("{}.{:06}", value / 1_000_000, value % 1_000_000);
        for (code, sign) in [("G3", 1), ("G2", -1)] {
            let line = format!("{code} X{} R{} F1", nm(2 * half), nm(half + 1));
            let arc = arc(&line);
            assert_eq!(arc.centre, [half, sign * height, 0].map(Nm), "{line}");
            assert_eq!(
                (arc.mismatch, arc.radius),
                (Nm(0), Some(Nm(half + 1))),
                "{line}"
            );
        }
    }
}

/// The centre from a radius is rounded to a nanometre, and the resulting difference of the radii is
/// reported. So is the amount by which a radius was short, which counts as at least 1 nm.
#[test]
fn what_rounding_leaves_of_a_radius() {
    // The centre is at 1.5 nm and 1.32 nm.
    let rounded = arc("G3 X.000003 R.000002 F1");
    assert_eq!(rounded.centre, [2, 1, 0].map(Nm));
    assert_eq!((rounded.mismatch, rounded.radius), (Nm(1), Some(Nm(2))));
    // The chord is longer than 2 um by a quarter of a picometre.
    let short = arc("G3 X.002 Y.000001 R.001 F1");
    assert_eq!((short.mismatch, short.radius), (Nm(1), None));
}

/// The resolution of an arc is one unit of the finest last digit among its words, in the unit of
/// the program.
#[test]
fn resolutions_of_arcs() {
    for (line, nm) in [
        ("G2 X2 I1 F1", 1_000_000),
        ("G2 X2.00 I1 F1", 10_000),
        ("G2 X2 I1.000 F1", 1_000),
        ("G2 X2.0 I1.000 Y0.00 J0 F1", 1_000),
        ("G2 X2.000 I1.00 F1", 1_000),
        ("G2 X2.0 R1.0000 F1", 100),
        ("G2 X2.0 I1 Z1.0000 F1.00", 100_000),
        ("G20 G2 X2.00 I1.0 F1", 254_000),
    ] {
        assert_eq!(arc(line).resolution, Nm(nm), "{line}");
    }
}

/// In the mode of an arc the words of a centre need an axis word, and G92 uses that one.
#[test]
fn centres_without_an_arc() {
    let mut modal = Modal::<3>::new(Dialect::RS274);
    for (line, expected) in [
        ("G2 X2 I1 F1", None),
        ("I1", Some(ErrorKind::UnusedWord(b'I'))),
        ("G92 X2 I1", Some(ErrorKind::UnusedWord(b'I'))),
        ("X4 I1", None),
    ] {
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect("a block");
        let planned = modal.plan(&block).map(|(next, _)| modal = next);
        assert_eq!(planned.err().map(|error| error.kind), expected, "{line}");
    }
}

/// The machine may be farther out than a program can express: a chord of 2^52 nm is still computed.
#[test]
fn chords_beyond_all_coordinates() {
    let verdict = |x| {
        let mut modal = Modal::<3>::new(Dialect::RS274);
        modal.set_position([Nm(x), Nm(0), Nm(0)]);
        let block = Block::parse(b"G2 X0 R1 F1", &Dialect::RS274).expect("a block");
        modal.plan(&block).expect_err("an error").kind
    };
    assert!(matches!(verdict(1 << 52), ErrorKind::RadiusTooSmall(_)));
    for x in [(1 << 52) + 1, 1 << 53, i64::MAX] {
        assert_eq!(verdict(x), ErrorKind::NumberTooLarge, "{x}");
    }
}

/// Grbl ignores the offset perpendicular to the plane, zero or not, of an arc with a centre to a
/// point in the plane. The other dialects refuse it, as LinuxCNC does.
#[test]
fn offsets_across_the_plane() {
    let commands = |dialect, line: &str| {
        let block = Block::parse(line.as_bytes(), &dialect).expect("a block");
        let planned = Modal::<3>::new(dialect).plan(&block);
        planned
            .map(|(_, commands)| commands.collect::<Vec<_>>())
            .map_err(|error| error.kind)
    };
    let lines = [
        ("G17 G2 X2 I1", "K", b'K'),
        ("G17 G3 X1 Y1 I0 J1", "K", b'K'),
        ("G18 G2 X2 I1", "J", b'J'),
        ("G19 G3 Y2 J1", "I", b'I'),
        ("G19 G3 Y2 Z0 J1 K0", "I", b'I'),
    ];
    for (line, word, letter) in lines {
        for value in ["0", "0.0000", "-0", "3.5"] {
            let plain = format!("{line} F100");
            let with_it = format!("{line} {word}{value} F100");
            let expected = commands(Dialect::GRBL, &plain);
            assert!(expected.is_ok(), "{plain}");
            assert_eq!(commands(Dialect::GRBL, &with_it), expected, "{with_it}");
            // Elsewhere only a zero is taken, by the extended list of codes.
            let elsewhere = match value {
                _ if cfg!(not(feature = "extended")) => Err(ErrorKind::UnusedWord(letter)),
                "3.5" => Err(ErrorKind::UnusedWord(letter)),
                _ => commands(Dialect::RS274, &plain),
            };
            assert_eq!(commands(Dialect::RS274, &with_it), elsewhere, "{with_it}");
        }
    }
    // The last two look like arcs of another plane.
    for line in [
        "G2 X2 R1 K0 F100",
        "G18 G2 X2 R1 J0 F100",
        "G1 X2 K0 F100",
        "G2 I1 K0 F100",
        "G2 Z-2 I1 K-1 F100",
    ] {
        let refused = commands(Dialect::GRBL, line);
        assert!(matches!(refused, Err(ErrorKind::UnusedWord(_))), "{line}");
    }
    for line in ["G2 X2 K1 F100", "G18 G2 X2 J1 F100", "G19 G2 Y2 I1 F100"] {
        let refused = commands(Dialect::GRBL, line);
        assert_eq!(refused, Err(ErrorKind::NoCentre), "{line}");
    }
}

/// G10 rotates a work frame only with L2, and writes no tools where the dialect has none.
#[test]
fn data_that_cannot_be_set() {
    assert_eq!(verdict("G10 L2 P1 X1 R0"), None);
    if cfg!(feature = "extended") {
        assert_eq!(verdict("G10 L2 P1 X1 R10"), None);
    }
    let refused = Some(ErrorKind::OutOfRange(b'R'));
    assert_eq!(verdict("G10 L20 P1 X1 R10"), refused);
    let rotated = Block::parse(b"G10 L2 P1 X1 R10", &Dialect::GRBL).expect("a block");
    let grbl = Modal::<3>::new(Dialect::GRBL).plan(&rotated);
    assert_eq!(grbl.err().map(|error| error.kind), refused);
    for (kind, is_tool) in [(1, true), (10, true), (11, true), (2, false), (20, false)] {
        let line = format!("G10 L{kind} P1 Z1");
        let block = Block::parse(line.as_bytes(), &Dialect::GRBL).expect("a block");
        let verdict = Modal::<3>::new(Dialect::GRBL).plan(&block).err();
        let expected = is_tool.then_some(ErrorKind::OutOfRange(b'L'));
        assert_eq!(verdict.map(|error| error.kind), expected, "{line}");
    }
}

/// G10 L10 measures a tool in the work frame, G10 L11 in that of G59.3; G10 L1 writes the given
/// values.
#[test]
#[cfg(feature = "extended")]
fn tools_are_measured_in_frames() {
    for (kind, length) in [(1, 1), (10, 19), (11, 24)] {
        let mut modal = Modal::<3>::new(Dialect::RS274);
        modal.set_position([0, 0, 30_000_000].map(Nm));
        assert!(modal.set_work_zero(0, [0, 0, 10_000_000].map(Nm)));
        assert!(modal.set_work_zero(8, [0, 0, 5_000_000].map(Nm)));
        let line = format!("G10 L{kind} P7 Z1");
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect("a block");
        let (modal, _) = modal.plan(&block).expect("a plan");
        let tool = modal.tool_data(7).expect("a tool");
        assert_eq!(tool.offset, [0, 0, length * 1_000_000].map(Nm), "{line}");
    }
}

/// A tool with a negative radius cuts on the other side, a tool without a radius on the side of its
/// code.
#[test]
#[cfg(feature = "extended")]
fn sides_of_the_contour() {
    use husillo_gcode::{Side, Tool};
    for (code, radius, side) in [
        ("G41", 1, Side::Left),
        ("G41", 0, Side::Left),
        ("G41", -1, Side::Right),
        ("G42", 1, Side::Right),
        ("G42", 0, Side::Right),
        ("G42", -1, Side::Left),
    ] {
        let mut modal = Modal::<3>::new(Dialect::RS274);
        let tool = Tool::of_radius(Nm(radius * 1_000_000));
        assert_eq!(
            (tool.offset, tool.radius.0),
            ([Nm(0); 3], radius * 1_000_000)
        );
        assert!(modal.set_tool(3, tool));
        for line in [format!("{code} D3"), format!("{code}.1 D{}", 2 * radius)] {
            let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect("a block");
            let (next, _) = modal.plan(&block).expect("a plan");
            assert_eq!(next.compensation(), Some(side), "{line}");
        }
    }
}

/// Digital inputs can be waited for in four ways, analogue ones are read at once.
#[test]
#[cfg(feature = "extended")]
fn inputs_to_wait_for() {
    for mode in 0..=5 {
        let digital = verdict(&format!("M66 P0 L{mode} Q1"));
        let analog = verdict(&format!("M66 E0 L{mode} Q1"));
        let refused = Some(ErrorKind::OutOfRange(b'L'));
        assert_eq!(digital, refused.filter(|_| mode > 4), "L{mode}");
        assert_eq!(analog, refused.filter(|_| mode > 0), "L{mode}");
    }
}

/// Turns are whole and not zero, up to 2^32 - 1; an arc needs words of its plane.
#[test]
fn turns_and_words_of_arcs() {
    assert_eq!(verdict("G2 X1 I.5 F1 P1"), None);
    assert_eq!(verdict("G2 X1 I.5 F1 P4294967295"), None);
    for wrong in ["P0", "P1.5", "P4294967296", "P4294967297"] {
        let line = format!("G2 X1 I.5 F1 {wrong}");
        assert_eq!(verdict(&line), Some(ErrorKind::NotWhole(b'P')), "{line}");
    }
    assert_eq!(verdict("G2 F1"), Some(ErrorKind::NoAxisWords));
    assert_eq!(verdict("G3 F1 R1"), Some(ErrorKind::NoEnd));
}

/// A machine of two axes has arcs in their plane, a machine of one axis has none.
#[test]
fn arcs_of_few_axes() {
    fn verdict<const N: usize>(line: &str) -> Option<ErrorKind> {
        let modal = Modal::<N>::new(Dialect::RS274);
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
        modal.plan(&block).err().map(|error| error.kind)
    }
    assert_eq!(verdict::<2>("G2 X1 I.5 F1"), None);
    assert_eq!(verdict::<2>("G18 G2 X1 I.5 F1"), Some(ErrorKind::NoCentre));
    assert_eq!(verdict::<1>("G2 X1 I.5 F1"), Some(ErrorKind::NoCentre));
    assert_eq!(verdict::<3>("G18 G2 X1 I.5 F1"), None);
}

/// A word and the position to which it is added are within 2^50 nm, and so is their sum.
#[test]
fn offsets_beyond_the_largest_coordinate() {
    let after = |line: &str| {
        let mut modal = Modal::<3>::new(Dialect::RS274);
        modal.set_position([Nm(1_125_000_000_000_000), Nm(0), Nm(0)]);
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
        modal.plan(&block).err().map(|error| error.kind)
    };
    assert_eq!(after("G2 I-1000000 F1"), None);
    let refused = Some(ErrorKind::NumberTooLarge);
    assert_eq!(after("G2 I1000000 F1"), refused);
    assert_eq!(after("G2 I-1200000000 F1"), refused);
}

/// A probe needs a feed per minute, except in Grbl; it stays the motion in effect.
#[test]
fn feeds_of_probes() {
    let verdict = |dialect: Dialect| {
        let mut modal = Modal::<3>::new(dialect);
        for line in ["G93", "G38.2 Z-1 F1"] {
            let block = Block::parse(line.as_bytes(), &dialect).expect(line);
            match modal.plan(&block) {
                Ok((next, _)) => modal = next,
                Err(error) => return Err(error.kind),
            }
        }
        Ok(modal.motion())
    };
    assert_eq!(verdict(Dialect::RS274), Err(ErrorKind::WrongFeedMode));
    let probe = husillo_gcode::Motion::Probe {
        away: false,
        must: true,
    };
    assert_eq!(verdict(Dialect::GRBL), Ok(Some(probe)));
}

/// On the drill `G92` alone makes the present position zero, whatever the zero of the frame.
#[test]
fn here_is_zero() {
    let mut modal = Modal::<3>::new(Dialect::DRILL);
    assert!(modal.set_work_zero(0, [5_000_000, 0, 0].map(Nm)));
    modal.set_position([7_000_000, 1_000_000, 0].map(Nm));
    let block = Block::parse(b"G92", &Dialect::DRILL).expect("a block");
    modal = modal.plan(&block).expect("a plan").0;
    assert_eq!(modal.work_offset(), [7_000_000, 1_000_000, 0].map(Nm));
}

/// The forms of G10 as LinuxCNC has them: frames P0 (the active one) to P9 (G59.3), tools with
/// radius, angles and orientation. The angles have no effect here.
#[test]
#[cfg(feature = "extended")]
fn forms_of_g10() {
    let modal = |line: &str| {
        let mut modal = Modal::<3>::new(Dialect::RS274);
        modal.set_position([1, 2, 3].map(|mm| Nm(mm * 1_000_000)));
        for line in ["G57", line] {
            let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
            modal = modal.plan(&block).expect(line).0;
        }
        modal
    };
    for system in 0..=9_u8 {
        // P0 is the active frame, G57.
        let place = system.checked_sub(1).unwrap_or(3);
        let set = modal(&format!("G10 L2 P{system} X5"));
        assert_eq!(
            set.work_zero(place),
            Some([5_000_000, 0, 0].map(Nm)),
            "L2 P{system}"
        );
        let here = modal(&format!("G10 L20 P{system} X5 Z0"));
        let zero = [-4_000_000, 0, 3_000_000].map(Nm);
        assert_eq!(here.work_zero(place), Some(zero), "L20 P{system}");
    }
    for line in ["G10 L2 P10 X1", "G10 L20 P10 X1"] {
        assert_eq!(verdict(line), Some(ErrorKind::OutOfRange(b'P')), "{line}");
    }
    assert_eq!(verdict("G10 L1 P0 Z1"), Some(ErrorKind::OutOfRange(b'P')));
    assert_eq!(verdict("G10 P1 Z1"), Some(ErrorKind::MissingWord(b'L')));
    assert_eq!(verdict("G10 L2 X1"), Some(ErrorKind::MissingWord(b'P')));
    for line in [
        "G10 L1 P7 X1 Z2 R3 I10 J20 Q4",
        "G10 L1 P7 Z2 R3 X1",
        "G20 G10 L1 P7 X1 Z2 R3",
    ] {
        let unit = if line.starts_with("G20") {
            25_400_000
        } else {
            1_000_000
        };
        let tool = modal(line).tool_data(7).expect("a tool");
        assert_eq!(tool.offset, [unit, 0, 2 * unit].map(Nm), "{line}");
        assert_eq!(tool.radius, Nm(3 * unit), "{line}");
    }
    // Words that are not given stay.
    let twice = {
        let mut modal = modal("G10 L1 P7 X1 Z2 R3");
        let block = Block::parse(b"G10 L1 P7 Z9", &Dialect::RS274).expect("a block");
        modal = modal.plan(&block).expect("a plan").0;
        modal.tool_data(7).expect("a tool")
    };
    assert_eq!(twice.offset, [1_000_000, 0, 9_000_000].map(Nm));
    assert_eq!(twice.radius, Nm(3_000_000));
}

/// A probe move without length is an error, whether a contact is required or not, as in Grbl and
/// LinuxCNC.
#[test]
#[cfg(feature = "extended")]
fn probe_moves_without_length() {
    for code in ["G38.2", "G38.3", "G38.4", "G38.5"] {
        for dialect in [Dialect::RS274, Dialect::GRBL] {
            let line = format!("{code} X0 F1");
            let block = Block::parse(line.as_bytes(), &dialect).expect("a block");
            let kind = Modal::<3>::new(dialect)
                .plan(&block)
                .err()
                .map(|error| error.kind);
            assert_eq!(kind, Some(ErrorKind::NoProbeMove), "{line}");
        }
    }
}
