//! Programs of 3D printers: the extruder, heaters and fans, and lines that only printers have.
#![cfg(feature = "extended")]

use husillo_gcode::{Axes, Block, Dialect, Error, Modal};

const PRINTER: Dialect = Dialect::PRINTER;

/// The commands of these lines as text.
fn run(lines: &[&str]) -> Vec<String> {
    let (mut modal, mut made) = (Modal::<4>::new(PRINTER), Vec::new());
    for line in lines {
        let block = Block::parse(line.as_bytes(), &PRINTER).expect(line);
        let (next, commands) = modal.plan(&block).expect(line);
        made.extend(commands.map(|command| command.shown(Axes::XYZE).to_string()));
        modal = next;
    }
    made
}

fn fault(line: &str) -> (u16, usize, usize) {
    let modal = Modal::<4>::new(PRINTER);
    let planned = Block::parse(line.as_bytes(), &PRINTER).and_then(|block| modal.plan(&block));
    let Error { kind, at, end } = planned.unwrap_err();
    (kind.code(), at, end)
}

#[test]
fn the_extruder_is_absolute_or_relative_on_its_own() {
    let lines = [
        "G1 X1 E2 F1200",
        "M83",
        "G1 X2 E0.5",
        "E.5",
        "M82",
        "G92 E0",
        "G1 E0.25",
        "G91",
        "G1 X1 E1",
        "M82",
        "G1 X1 E1",
        "G90",
        "G1 X0 E1.5",
    ];
    assert_eq!(
        run(&lines),
        [
            "linear X1 Y0 Z0 E2 F1200",
            "linear X2 Y0 Z0 E2.5 F1200",
            "linear X2 Y0 Z0 E3 F1200",
            "linear X2 Y0 Z0 E3.25 F1200",
            "linear X3 Y0 Z0 E4.25 F1200",
            "linear X4 Y0 Z0 E4 F1200",
            "linear X0 Y0 Z0 E4.5 F1200",
        ]
    );
}

#[test]
fn a_travel_move_has_its_feed() {
    let lines = ["G0 X1", "G0 X2 F6000", "G20 G0 X1 E1 F60", "G2 X2 I.5 E2"];
    assert_eq!(
        run(&lines),
        [
            "rapid X1 Y0 Z0 E0",
            "linear X2 Y0 Z0 E0 F6000",
            "linear X25.4 Y0 Z0 E25.4 F60",
            "arc cw xy X50.8 Y0 Z0 E50.8 centre X38.1 Y0 Z0 E25.4 F60",
        ]
    );
}

#[test]
fn heaters_and_fans_are_outputs() {
    let lines = [
        "M104 S215.5",
        "M109 R180",
        "M140 S60",
        "M190 S60",
        "M104 T1 S0",
        "T1",
        "M109 S200",
        "M106 S127.5",
        "M106",
        "M106 P2 S0",
        "M107",
        "M141 S40",
        "M84",
    ];
    assert_eq!(
        run(&lines),
        [
            "heat extruder 0 215.5 C",
            "heat extruder 0 180 C wait reached",
            "heat bed 60 C",
            "heat bed 60 C wait",
            "heat extruder 1 0 C",
            "tool is 1",
            "heat extruder 1 200 C wait",
            "fan 0 50 %",
            "fan 0 100 %",
            "fan 2 0 %",
            "fan 0 0 %",
            "heat chamber 40 C",
            "motors off",
        ]
    );
    for (line, error) in [
        ("M104", (213, 0, 4)),
        ("M106 S256", (505, 5, 9)),
        ("M109 S-3", (502, 5, 8)),
        ("M104 S200 Q1", (208, 10, 12)),
    ] {
        assert_eq!(fault(line), error, "{line}");
    }
}

#[test]
fn retraction_moves_the_filament_and_keeps_its_coordinate() {
    let lines = [
        "G1 X1 E5 F600",
        "G10",
        "G10",
        "G0 X9",
        "G11 S1",
        "G11",
        "G1 X10 E6",
    ];
    assert_eq!(
        run(&lines),
        [
            "linear X1 Y0 Z0 E5 F600",
            "linear X1 Y0 Z0 E2 F2700",
            "linear X9 Y0 Z0 E2 F600",
            "linear X9 Y0 Z0 E5 F2700",
            "linear X10 Y0 Z0 E6 F600",
        ]
    );
}

#[test]
fn homing_takes_axes_with_and_without_values() {
    let go = "G1 X5 Y6 Z7 E8 F600";
    for (home, end) in [
        ("G28", "X0 Y0 Z0 E8"),
        ("G28 W ; without levelling", "X0 Y0 Z0 E8"),
        ("N7 G28 X Y", "X0 Y0 Z7 E8"),
        ("g28 z0 (top)", "X5 Y6 Z0 E8"),
        ("G28 X0 Y0", "X0 Y0 Z7 E8"),
        ("G28 (the bed (not X) first) Z", "X5 Y6 Z0 E8"),
        ("G28 W (no levelling) ; X", "X0 Y0 Z0 E8"),
    ] {
        assert_eq!(run(&[go, home])[1], format!("rapid {end}"), "{home}");
    }
}

#[test]
fn settings_and_messages_have_no_effect() {
    let lines = [
        "M117 100 % done: \"ring\"",
        "M862.3 P \"MK3S\" ; model",
        "M115 U3.13.2",
        "M73 P10 R5",
        "M201 X1000 Y1000 Z200 E5000",
        "M205 S0 T0",
        "M84 X Y E",
        "M900 K0.05",
        "N3 M105",
        "G29",
        "G80",
        "G4 P150",
        "G4 S2",
        "M600 B2",
    ];
    assert_eq!(
        run(&lines),
        ["motors off", "dwell 0.15 s", "dwell 2 s", "stop"]
    );
    // A code that is not alone, and codes of no printer.
    assert_eq!(fault("G1 X1 M117 done").0, 202);
    assert_eq!(fault("M999").0, 202);
    assert_eq!(fault("G1 X1 A3").0, 201);
    // Others do not have them.
    let block = Block::parse(b"M104 S200", &Dialect::RS274);
    assert_eq!(block.unwrap_err().kind.code(), 202);
    let block = Block::parse(b"G4 S2", &Dialect::RS274).unwrap();
    let planned = Modal::<3>::new(Dialect::RS274).plan(&block);
    assert_eq!(planned.unwrap_err().kind.code(), 504);
}

#[cfg(feature = "program")]
#[test]
fn lines_of_printers_have_a_form() {
    let form = |line: &str| {
        let pieces = husillo_gcode::formatted(line.as_bytes(), &PRINTER).expect(line);
        String::from_utf8(pieces.collect::<Vec<_>>().concat()).unwrap()
    };
    assert_eq!(form("g1 x.5e+01"), "G1 X0.5 E01".replace("01", "1"));
    assert_eq!(form("M117 Hello, World"), "M117 Hello, World");
    assert_eq!(form("G28 X Y"), "G28 X Y");
}
