//! State of a machine in a program: system parameters by number and by name.

#![cfg(all(feature = "program", feature = "extended"))]

use husillo_gcode::parameters::{NoMachine, System};
use husillo_gcode::{Block, Dialect, Modal, Nm, Tool};

fn after(dialect: Dialect, lines: &[&str]) -> Modal<3> {
    let mut modal = Modal::new(dialect);
    let tool = Tool {
        offset: [0, 0, 7_000_000].map(Nm),
        radius: Nm(1_500_000),
    };
    assert!(modal.set_tool(4, tool));
    modal.set_home([1_000_000, 2_000_000, 3_000_000].map(Nm));
    modal.set_second_home([4_000_000, 5_000_000, 6_000_000].map(Nm));
    for line in lines {
        let block = Block::parse(line.as_bytes(), &dialect).expect(line);
        modal = modal.plan(&block).expect(line).0;
    }
    modal
}

/// Every number of the table, the axes that a machine does not have, and the numbers next to those
/// of the table.
#[test]
fn values_by_number() {
    let lines = [
        "G10 L2 P1 X10 Y20 Z30",
        "G10 L2 P2 X11 Y21 Z31",
        "G10 L2 P9 X19 Y29 Z39",
        "T4 M6 G43 H4",
        "G0 X50 Y60 Z70",
        "G92 X49",
    ];
    let modal = after(Dialect::RS274, &lines);
    for (number, expected) in [
        (5020, None),
        (5021, Some("60.000000")),
        (5023, Some("107.000000")),
        (5024, Some("0")),
        (5029, Some("0")),
        (5030, None),
        (5161, Some("1.000000")),
        (5169, Some("0")),
        (5170, None),
        (5182, Some("5.000000")),
        (5189, Some("0")),
        (5190, None),
        (5210, Some("1")),
        (5211, Some("1.000000")),
        (5219, Some("0")),
        (5220, Some("1")),
        (5221, Some("10.000000")),
        (5229, Some("0")),
        (5230, Some("0.0000000")),
        (5231, None),
        (5240, None),
        (5242, Some("21.000000")),
        (5383, Some("39.000000")),
        (5389, Some("0")),
        (5390, None),
        (5400, Some("4")),
        (5403, Some("7.000000")),
        (5409, Some("0")),
        (5410, Some("3.000000")),
        (5411, None),
        (5420, Some("49.000000")),
        (5422, Some("70.000000")),
        (5428, Some("0")),
        (5429, None),
    ] {
        let value = modal.numbered(number).map(|value| value.to_string());
        assert_eq!(value.as_deref(), expected, "#{number}");
    }
    let value = |modal: Modal<3>, number| modal.numbered(number).map(|value| value.to_string());
    let fresh = || after(Dialect::RS274, &[]);
    assert_eq!(value(fresh(), 5210).as_deref(), Some("0"));
    assert_eq!(value(fresh(), 5410).as_deref(), Some("0.000000"));
    let modal = after(Dialect::RS274, &["G20 G0 X1"]);
    assert_eq!(value(modal, 5021).as_deref(), Some("1"));
}

/// Every name, true and false.
#[test]
fn values_by_name() {
    let names = |dialect, lines: &[&str], expected: &[(&str, &str)]| {
        let modal = after(dialect, lines);
        for (name, expected) in expected {
            let value = modal.named(name.as_bytes()).map(|value| value.to_string());
            assert_eq!(value.as_deref(), Some(*expected), "{name} after {lines:?}");
        }
    };
    let fresh = [
        ("METRIC", "1"),
        ("IMPERIAL", "0"),
        ("ABSOLUTE", "1"),
        ("INCREMENTAL", "0"),
        ("IJK_ABSOLUTE_MODE", "0"),
        ("INVERSE_TIME", "0"),
        ("UNITS_PER_MINUTE", "1"),
        ("UNITS_PER_REV", "0"),
        ("LATHE_DIAMETER_MODE", "0"),
        ("LATHE_RADIUS_MODE", "1"),
        ("SPINDLE_ON", "0"),
        ("SPINDLE_CW", "0"),
        ("MIST", "0"),
        ("FLOOD", "0"),
        ("PLANE", "170"),
        ("CCOMP", "400"),
        ("COORD_SYSTEM", "540"),
        ("FEED", "0.000000"),
        ("RPM", "0.000"),
        ("CURRENT_TOOL", "0"),
        ("SELECTED_TOOL", "0"),
    ];
    names(Dialect::RS274, &[], &fresh);
    let lines = [
        "G20",
        "G91 G90.1 G18 G59 F2 M3 S100 M7",
        "T4 M6",
        "T5",
        "M8",
    ];
    let set = [
        ("METRIC", "0"),
        ("IMPERIAL", "1"),
        ("ABSOLUTE", "0"),
        ("INCREMENTAL", "1"),
        ("IJK_ABSOLUTE_MODE", "1"),
        ("SPINDLE_ON", "1"),
        ("SPINDLE_CW", "1"),
        ("MIST", "1"),
        ("FLOOD", "1"),
        ("PLANE", "180"),
        ("COORD_SYSTEM", "590"),
        ("FEED", "2"),
        ("RPM", "100.000"),
        ("CURRENT_TOOL", "4"),
        ("SELECTED_TOOL", "5"),
    ];
    names(Dialect::RS274, &lines, &set);
    let feeds = |line, inverse, minute, turn| {
        let expected = [
            ("INVERSE_TIME", inverse),
            ("UNITS_PER_MINUTE", minute),
            ("UNITS_PER_REV", turn),
        ];
        names(Dialect::RS274, &[line], &expected);
    };
    feeds("G93", "1", "0", "0");
    feeds("G95", "0", "0", "1");
    let lathe = [("LATHE_DIAMETER_MODE", "1"), ("LATHE_RADIUS_MODE", "0")];
    names(Dialect::LATHE, &[], &lathe);
    names(
        Dialect::RS274,
        &["M4 S1"],
        &[("SPINDLE_ON", "1"), ("SPINDLE_CW", "0")],
    );
    names(
        Dialect::RS274,
        &["G19", "G59.1"],
        &[("PLANE", "190"), ("COORD_SYSTEM", "591")],
    );
    names(Dialect::RS274, &["G41.1 D1"], &[("CCOMP", "410")]);
    names(Dialect::RS274, &["G42.1 D1"], &[("CCOMP", "420")]);
    for (line, mode) in [
        ("G0 X1", "0"),
        ("G1 X1 F1", "10"),
        ("G2 X1 I.5 F1", "20"),
        ("G3 X1 I.5 F1", "30"),
        ("G5 X3 I1 J1 P-1 Q1 F1", "50"),
        ("G5.1 X3 I1 J1 F1", "51"),
        ("M3 S1 G33 Z1 K1", "330"),
        ("G80", "800"),
    ] {
        names(Dialect::RS274, &[line], &[("MOTION_MODE", mode)]);
    }
    // Positions, in the work frame and in the machine frame.
    let lines = ["G10 L2 P1 X10", "G0 X1 Y2 Z3"];
    let places = [
        ("X", "1.000000"),
        ("ABS_X", "11.000000"),
        ("Z", "3.000000"),
        ("ABS_Z", "3.000000"),
        ("W", "0"),
        ("ABS_A", "0"),
    ];
    names(Dialect::RS274, &lines, &places);
    let modal = after(Dialect::RS274, &["G81 X1 Z-1 R1 F1"]);
    for name in ["MOTION_MODE", "Q", "ABS_Q", "XX", ""] {
        assert!(modal.named(name.as_bytes()).is_none(), "{name}");
    }
}

/// Without a machine there are no values, and a machine has no subroutines.
#[test]
fn no_machine() {
    assert!(NoMachine.numbered(5021).is_none() && NoMachine.named(b"X").is_none());
    assert!(!NoMachine.has_subroutine(b"bore"));
    assert!(!after(Dialect::RS274, &[]).has_subroutine(b"bore"));
}
