//! Cutter compensation: the path of the tool compared with that of LinuxCNC, and invariants.
#![cfg(feature = "extended")]

use husillo_gcode::{
    Arc, Block, Command, Compensation, Dialect, Error, ErrorKind, Measure, Modal, Nm, Units,
};
use proptest::prelude::*;

/// Compensated commands of a program; the first error of either stage.
fn run(lines: &[&str]) -> Result<Vec<Command<3>>, ErrorKind> {
    let dialect = Dialect::RS274;
    let mut modal = Modal::<3>::new(dialect);
    let mut stage = Compensation::new([Nm(0); 3]);
    let mut made = Vec::new();
    for line in lines {
        let (next, commands) = Block::parse(line.as_bytes(), &dialect)
            .and_then(|block| modal.plan(&block))
            .map_err(|Error { kind, .. }| kind)?;
        let (after, commands) = stage.plan(commands)?;
        made.extend(commands);
        (modal, stage) = (next, after);
    }
    made.extend(stage.finish());
    Ok(made)
}

fn text(lines: &[&str]) -> Vec<String> {
    let commands = run(lines).unwrap_or_else(|kind| panic!("{kind}"));
    commands.iter().map(ToString::to_string).collect()
}

/// The tool, half an inch wide minus a tenth, on the path of the LinuxCNC test.
#[test]
fn follows_linuxcnc() {
    let made = text(&[
        "g20 g0 x0 y0 z0",
        "g42.1 d.4",
        "g1 x1 f30",
        "y1",
        "x-1",
        "y2",
        "x1",
        "y3",
        "x0",
        "y4",
        "g3 y5 j.5",
        "g40 g1 y6",
    ]);
    let inch = |x: f64, y: f64| {
        format!(
            "X{} Y{} Z0",
            Nm((x * 25_400_000.0).round() as i64),
            Nm((y * 25_400_000.0).round() as i64)
        )
    };
    let expected = [
        format!("rapid {}", inch(0.0, 0.0)),
        format!("linear {} F762", inch(1.0, -0.2)),
        format!(
            "arc ccw xy {} centre {} F762",
            inch(1.2, 0.0),
            inch(1.0, 0.0)
        ),
        format!("linear {} F762", inch(1.2, 1.0)),
        format!(
            "arc ccw xy {} centre {} F762",
            inch(1.0, 1.2),
            inch(1.0, 1.0)
        ),
        format!("linear {} F762", inch(-0.8, 1.2)),
        format!("linear {} F762", inch(-0.8, 1.8)),
        format!("linear {} F762", inch(1.0, 1.8)),
        format!(
            "arc ccw xy {} centre {} F762",
            inch(1.2, 2.0),
            inch(1.0, 2.0)
        ),
        format!("linear {} F762", inch(1.2, 3.0)),
        format!(
            "arc ccw xy {} centre {} F762",
            inch(1.0, 3.2),
            inch(1.0, 3.0)
        ),
        format!("linear {} F762", inch(0.2, 3.2)),
    ];
    assert_eq!(made[..expected.len()], expected);
    assert_eq!(
        made.last(),
        Some(&format!("linear {} F762", inch(0.0, 6.0)))
    );
}

#[test]
fn a_tool_of_no_size_follows_the_contour() {
    // A square, a way back, and an arc at its corner: no arcs of radius zero are inserted.
    let lines = ["G1 X5", "Y5", "X0", "X3", "G2 X5 Y3 J-2", "G1 X9"];
    for start in ["G21 F100 G41.1 D0", "G21 F100 G42.1 D0"] {
        let [plain, compensated] =
            [&["G21 F100"][..], &[start][..]].map(|start| text(&[start, &lines[..]].concat()));
        assert_eq!(plain, compensated);
    }
}

#[test]
fn refuses_what_the_tool_cannot_do() {
    let fault = |lines: &[&str]| run(lines).unwrap_err();
    let start = "G21 F100 G41.1 D0.25";
    assert_eq!(
        fault(&[start, "G1 X0.1"]),
        ErrorKind::EntryTooShort(Measure::of(Nm(125_000)))
    );
    assert_eq!(fault(&[start, "G2 X1 I0.5"]), ErrorKind::CompensationEntry);
    // The example of LinuxCNC: a slot narrower than the tool.
    assert_eq!(
        fault(&[start, "G1 X1", "X2", "Y0.1", "X1"]),
        ErrorKind::Gouge
    );
    assert_eq!(
        fault(&[start, "G1 X1", "G3 Y0.2 J0.1"]),
        ErrorKind::ArcSmallerThanTool(Measure::of(Nm(125_000)))
    );
    assert_eq!(fault(&[start, "G93 G1 X1 F1"]), ErrorKind::WrongFeedMode);
    assert_eq!(
        fault(&[start, "G1 X1", "G40", "G2 X2 I0.5"]),
        ErrorKind::CompensationEntry
    );
    assert_eq!(
        fault(&[start, "G1 X1", "Z1", "Z2", "Z3", "Z4", "Z5"]),
        ErrorKind::TooManyWaiting
    );
}

#[test]
fn commands_between_moves_keep_their_place() {
    let made = text(&[
        "G21 F60 G41.1 D2",
        "G1 X5",
        "M3 S10",
        "Z-1",
        "Y5",
        "G40",
        "X0",
    ]);
    assert_eq!(
        made,
        [
            "linear X4 Y1 Z0 F60",
            "spindle cw 10 rpm",
            "linear X4 Y1 Z-1 F60",
            "linear X4 Y5 Z-1 F60",
            "linear X0 Y5 Z-1 F60"
        ]
    );
}

#[test]
fn rapids_go_round_corners() {
    let made = text(&["G21 G42.1 D2", "G0 X5", "Y5", "X0 Y0", "G40 X9"]);
    assert_eq!(
        made[0..4],
        [
            "rapid X5 Y-1 Z0",
            "rapid X6 Y-1 Z0",
            "rapid X6 Y0 Z0",
            "rapid X6 Y5 Z0"
        ]
    );
    assert_eq!(made.len(), 9);
}

#[test]
fn arcs_and_lines_meet_inside() {
    // Down a wall into a quarter of a bowl, and up again: the tool touches both.
    let made = run(&[
        "G21 F100 G0 X0 Y20",
        "G41.1 D2",
        "G1 Y10",
        "G3 X20 I10 J0",
        "G1 Y30",
        "X10",
        "G40 Y40",
    ])
    .unwrap();
    let arc = made.iter().find_map(|command| match command {
        Command::Arc { arc, .. } => Some(*arc),
        _ => None,
    });
    let arc = arc.expect("an arc");
    assert_eq!((arc.to[0], arc.to[1]), (Nm(19_000_000), Nm(10_000_000)));
    // A wall across the bowl.
    let made = run(&[
        "G21 F100 G0 X-5 Y0",
        "G41.1 D2",
        "G1 X0",
        "G3 X20 I10 J0",
        "G1 X15 Y5",
        "G40 Y40",
    ])
    .unwrap();
    assert!(made.len() >= 4);
}

/// Distance of a point to a segment, in nm.
fn distance(point: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let d = [to[0] - from[0], to[1] - from[1]];
    let v = [point[0] - from[0], point[1] - from[1]];
    let along = ((v[0] * d[0] + v[1] * d[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
    (v[0] - along * d[0]).hypot(v[1] - along * d[1])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(miri) { 2 } else { 256 }))]

    /// Along any accepted polygon, each straight move stays one radius from its side, and each
    /// corner arc one radius from its corner, to 2 nm. A refusal changes nothing.
    #[test]
    fn one_radius_from_the_contour(
        points in prop::collection::vec((-50_000i64..50_000, -50_000i64..50_000), 3..9),
        radius in 1i64..900,
        right in any::<bool>(),
    ) {
        let side = if right { "G42.1" } else { "G41.1" };
        let mut lines = vec![
            "G21 F100".to_owned(),
            format!("{side} D{}", Nm(2_000 * radius)),
        ];
        lines.extend(
            points
                .iter()
                .map(|(x, y)| format!("G1 X{} Y{}", Nm(x * 1000), Nm(y * 1000))),
        );
        let lines: Vec<_> = lines.iter().map(String::as_str).collect();
        let Ok(made) = run(&lines) else { return Ok(()) };
        let corners: Vec<_> = points
            .iter()
            .map(|(x, y)| [*x as f64 * 1e3, *y as f64 * 1e3])
            .collect();
        let wanted = radius as f64 * 1e3;
        let (mut at, mut side) = ([0.0, 0.0], 0);
        for command in &made {
            let end = command.end().unwrap();
            let end = [end[0].0 as f64, end[1].0 as f64];
            match command {
                Command::Linear { .. } => {
                    if side > 0 {
                        for point in [at, end] {
                            prop_assert!(
                                (distance(point, corners[side - 1], corners[side]) - wanted).abs()
                                    <= 2.0
                            );
                        }
                    }
                    side += 1;
                }
                Command::Arc { arc, .. } => {
                    prop_assert_eq!(
                        [arc.centre[0].0 as f64, arc.centre[1].0 as f64],
                        corners[side - 1]
                    );
                    prop_assert!(
                        (distance(end, corners[side - 1], corners[side]) - wanted).abs() <= 2.0
                    );
                    prop_assert!(arc.mismatch <= Nm(2));
                }
                _ => {}
            }
            at = end;
        }
        prop_assert_eq!(side, corners.len());
    }

    /// Any contour of lines and arcs is accepted or refused; nothing overflows.
    #[test]
    fn any_contour_is_taken_or_refused(
        moves in prop::collection::vec(
            (0usize..4, -99i64..99, -99i64..99, -99i64..99, -99i64..99),
            1..12,
        ),
        diameter in 0i64..60,
    ) {
        let mut lines = vec!["G21 F100".to_owned(), format!("G41.1 D{diameter}")];
        lines.extend(moves.iter().map(|(code, x, y, i, j)| match code {
            0 => format!("G0 X{x} Y{y}"),
            1 => format!("G1 X{x} Y{y}"),
            2 => format!("G2 X{x} Y{y} R{}", 150 + i.abs()),
            _ => format!("G3 I{i} J{j}"),
        }));
        for count in 2..=lines.len() {
            let lines: Vec<_> = lines[..count].iter().map(String::as_str).collect();
            let _ = run(&lines);
        }
    }
}

/// While a contour is compensated a move waits, with the commands after it; the end of the program
/// releases it.
#[test]
fn what_waits() {
    let mut modal = Modal::<3>::new(Dialect::RS274);
    let mut stage = Compensation::new(modal.position());
    let mut told = Vec::new();
    for line in [
        "F100 G0 X0",
        "G41.1 D2",
        "G1 X10",
        "Y20",
        "M8",
        "G2 X20 Y30 I10",
        "M2",
    ] {
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
        let (next, commands) = modal.plan(&block).expect(line);
        let (after, made) = stage.plan(commands).expect(line);
        (modal, stage) = (next, after);
        told.push((stage.is_active(), stage.held(), made.count()));
        if let Command::Arc { arc, .. } = stage
            .clone()
            .finish()
            .last()
            .unwrap_or(Command::End { rewind: false })
        {
            // The arc that fits has its own radius and almost no mismatch.
            assert_eq!(arc.radius, None);
            assert!(arc.mismatch.0 <= 2, "{arc:?}");
        }
    }
    let expected = [
        (false, 0, 1),
        (true, 0, 0),
        (true, 1, 0),
        (true, 1, 1),
        (true, 2, 0),
        (true, 1, 2),
        (false, 0, 2),
    ];
    assert_eq!(told, expected);
}

/// Every generated arc ends as far off its circle as it reports, whatever the line said, and has no
/// radius from a word.
#[test]
fn arcs_say_how_far_they_are_off() {
    let mut at = [Nm(0); 3];
    let (mut arcs, mut off) = (0, 0);
    for lines in [
        [
            "G90.1",
            "G42.1 D2",
            "G1 X10 F100",
            "G2 X20.001 Y10 I20.001 J0.0005",
            "G1 Y30",
            "X7.3 Y41.9",
            "M2",
        ],
        [
            "G90.1",
            "G42.1 D2",
            "G1 X10 F100",
            "G2 X20.001 Y10 I20.001 J0.0005",
            "G1 Y-30",
            "X7.3 Y-41.9",
            "M2",
        ],
        [
            "G17",
            "G41.1 D2",
            "G1 X10 F100",
            "G3 X20 Y10 R10",
            "G1 Y30",
            "X-7.3 Y41.9",
            "M2",
        ],
        [
            "G17",
            "G42.1 D2",
            "G1 X10 F100",
            "G3 X17.07 Y7.07 R10.0004",
            "G1 Y30",
            "X7.3 Y1.9",
            "M2",
        ],
    ] {
        for command in run(&lines).unwrap_or_else(|kind| panic!("{lines:?}: {kind}")) {
            match command {
                Command::Arc { arc, .. } => {
                    let (to, centre, units) = (arc.to, arc.centre, Units::Millimetres);
                    let same = Arc::around(&at, to, centre, arc.plane, arc.direction, units);
                    let same = same.expect("an arc that fits");
                    assert_eq!((arc.mismatch, arc.radius), (same.mismatch, None), "{arc:?}");
                    arcs += 1;
                    off += i32::from(arc.mismatch != Nm(0));
                    at = arc.to;
                }
                Command::Rapid { to } | Command::Linear { to, .. } => at = to,
                _ => {}
            }
        }
        at = [Nm(0); 3];
    }
    assert!(arcs > 6 && off > 0, "{arcs} {off}");
}

/// A slot as wide as the tool: its end is a move of no length.
#[test]
fn a_slot_as_wide_as_the_tool() {
    let made = text(&["G41.1 D2", "G1 X10 F100", "Y2", "X0", "M2"]);
    assert_eq!(made[0], made[1]);
    assert_eq!(made[0], "linear X9 Y1 Z0 F100");
}
