//! Contour cycles compared with an independent geometry in floating point.

#![cfg(all(feature = "program", feature = "extended"))]

use husillo_gcode::contour::{Contours, needs_contours};
use husillo_gcode::{Command, Dialect, Direction, ErrorKind, Modal, Nm};
use proptest::prelude::*;

/// With line numbers.
type Numbered<T> = Vec<(usize, T)>;

/// The commands of a program with their line numbers, and its errors; a wrong line changes nothing.
fn run(text: &str, dialect: Dialect) -> (Numbered<Command<3>>, Numbered<ErrorKind>) {
    let mut contours: Contours = Contours::new(text.as_bytes(), dialect);
    let mut modal = Modal::<3>::new(dialect);
    let (mut commands, mut errors) = (Vec::new(), Vec::new());
    while let Some(line) = contours.next_line(&modal) {
        let planned = line.block.and_then(|block| modal.plan(&block));
        match planned {
            Ok((next, made)) => {
                modal = next;
                commands.extend(made.map(|command| (line.number, command)));
            }
            Err(error) => errors.push((line.number, error.kind)),
        }
        assert!(commands.len() < 1_000_000, "endless");
    }
    (commands, errors)
}

/// One move of a contour: its end, and the centre of an arc; far and up, in units.
#[derive(Clone, Copy, Debug)]
struct Piece {
    end: [i64; 2],
    centre: Option<[i64; 2]>,
}

/// Kinds of moves: a line, a fillet, a rounding; whole quarters or parts of them.
fn pieces() -> impl Strategy<Value = Vec<(u8, i64, i64)>> {
    prop::collection::vec((0u8..6, 0i64..60, 0i64..60), 1..9)
}

fn contour(steps: &[(u8, i64, i64)]) -> Vec<Piece> {
    let [mut far, mut up] = [0i64, 0i64];
    let mut pieces = Vec::new();
    for &(kind, a, b) in steps {
        let r = 50 * (a + 1);
        let (end, centre) = match kind {
            0 => ([far + 100 * a, up + 70 * b], None),
            1 => ([far + 100 * a, up], None),
            2 => ([far, up + 70 * b], None),
            3 => ([far + r, up + r], Some([far, up + r])),
            4 => ([far + r, up + r], Some([far + r, up])),
            // The first part of a fillet, by 3, 4, 5.
            _ => ([far + 4 * r / 5, up + 2 * r / 5], Some([far, up + r])),
        };
        if end != [far, up] {
            pieces.push(Piece { end, centre });
        }
        [far, up] = end;
    }
    pieces
}

/// Placement of a case: the mapping from far and up (in units) to X (radius) and Z.
#[derive(Clone, Copy, Debug)]
struct Frame {
    facing: bool,
    far_sign: i64,
    up_sign: i64,
    bottom: [i64; 2],
}

impl Frame {
    /// X and Z.
    fn point(self, [far, up]: [i64; 2]) -> [i64; 2] {
        let (far, up) = (far * self.far_sign, up * self.up_sign);
        let [x, z] = if self.facing { [far, up] } else { [up, far] };
        [x + self.bottom[0], z + self.bottom[1]]
    }

    /// Far and up of nanometres.
    fn course(self, at: [Nm; 3], unit: f64) -> [f64; 2] {
        let x = at[0].0 as f64 - self.bottom[0] as f64 * unit;
        let z = at[2].0 as f64 - self.bottom[1] as f64 * unit;
        let [far, up] = if self.facing { [x, z] } else { [z, x] };
        [far * self.far_sign as f64, up * self.up_sign as f64]
    }
}

fn number(units: i64, places: usize) -> String {
    let scale = 10i64.pow(places as u32);
    let sign = if units < 0 { "-" } else { "" };
    let magnitude = units.abs();
    format!("{sign}{}.{:0places$}", magnitude / scale, magnitude % scale)
}

/// The height where the material begins at `far`, in nanometres: the lowest point of the contour
/// there.
fn height(pieces: &[Piece], far: f64, unit: f64) -> f64 {
    let mut start = [0.0, 0.0];
    if far <= 0.0 {
        return 0.0;
    }
    for piece in pieces {
        let end = piece.end.map(|part| part as f64 * unit);
        if far <= end[0] && end[0] > start[0] {
            return match piece.centre {
                None => start[1] + (end[1] - start[1]) * (far - start[0]) / (end[0] - start[0]),
                Some(centre) => {
                    let centre = centre.map(|part| part as f64 * unit);
                    let r = (start[0] - centre[0]).hypot(start[1] - centre[1]);
                    let half = (r * r - (far - centre[0]).powi(2)).max(0.0).sqrt();
                    // A fillet lies below its centre, a rounding above.
                    if centre[1] >= end[1] {
                        centre[1] - half
                    } else {
                        centre[1] + half
                    }
                }
            };
        }
        start = end;
    }
    start[1]
}

/// Points of a move, its end included.
fn points(from: [Nm; 3], command: &Command<3>) -> Vec<[Nm; 3]> {
    let Some(to) = command.end() else {
        return Vec::new();
    };
    let at = |x: f64, z: f64| [Nm(x.round() as i64), Nm(0), Nm(z.round() as i64)];
    let mut all = Vec::new();
    for step in 1..16 {
        let part = f64::from(step) / 16.0;
        if let Command::Arc { arc, .. } = command {
            let centre = [arc.centre[0].0 as f64, arc.centre[2].0 as f64];
            let angle = |p: [Nm; 3]| (p[0].0 as f64 - centre[0]).atan2(p[2].0 as f64 - centre[1]);
            let (start, mut turn) = (angle(from), angle(to) - angle(from));
            let full = std::f64::consts::TAU;
            match arc.direction {
                Direction::CounterClockwise if turn < 0.0 => turn += full,
                Direction::Clockwise if turn > 0.0 => turn -= full,
                _ => {}
            }
            let r = (from[0].0 as f64 - centre[0]).hypot(from[2].0 as f64 - centre[1]);
            let angle = start + turn * part;
            all.push(at(centre[0] + r * angle.sin(), centre[1] + r * angle.cos()));
        } else {
            let between =
                |axis: usize| from[axis].0 as f64 + (to[axis].0 - from[axis].0) as f64 * part;
            all.push(at(between(0), between(2)));
        }
    }
    all.push(to);
    all
}

#[derive(Debug)]
struct Case {
    text: String,
    pieces: Vec<Piece>,
    frame: Frame,
    dialect: Dialect,
    unit: f64,
    /// Height of the start above the bottom, allowances and depth in units.
    top: i64,
    /// Distance of the start from the contour, in units.
    before: i64,
    shift: [i64; 2],
    depth: i64,
}

prop_compose! {
    fn cases()(
        steps in pieces(),
        (facing, inches, system_a) in any::<(bool, bool, bool)>(),
        (feeds_in, is_incremental) in any::<(bool, bool)>(),
        signs in any::<(bool, bool)>(),
        bottom in (-20_000i64..20_000, -20_000i64..20_000),
        (clear, before, entry) in (0i64..3_000, 0i64..3_000, 0i64..800),
        (allow_up, allow_far) in (0i64..500, 0i64..500),
        depth in 30i64..4_000,
        retract in 0i64..900,
    ) -> Case {
        let sign = |up: bool| if up { 1 } else { -1 };
        let frame = Frame {
            facing,
            far_sign: sign(signs.0),
            up_sign: sign(signs.1),
            bottom: [bottom.0, bottom.1],
        };
        let pieces = contour(&steps);
        let end = pieces.last().map_or([0, 0], |piece| piece.end);
        let top = end[1] + clear + 1;
        let dialect = if system_a { Dialect::LATHE_A } else { Dialect::LATHE };
        let (unit, places) = if inches { (2540.0, 4) } else { (1000.0, 3) };
        let start = [-before - entry, top];
        let [x, z] = frame.point(start);
        let say = |value| number(value, places);
        let mut text = format!("{}\n", if inches { "G20" } else { "G21" });
        text += &format!("G0 X{} Z{}\nF100\n", say(2 * x), say(z));
        let moved = |by: [i64; 2]| {
            let [x, z] = Frame { bottom: [0, 0], ..frame }.point(by);
            format!("U{} W{}", say(2 * x), say(z))
        };
        let shift = [-allow_far, allow_up];
        let code = if facing { "G72" } else { "G71" };
        if is_incremental && !system_a {
            text += "G91\n";
        }
        text += &format!(
            "{code} P10 Q900 {} D{} R{}\n", moved(shift), say(depth), say(retract)
        );
        let mut from = start;
        let mut line = 10;
        let mut add = |text: &mut String, piece: Piece, entry: Option<bool>| {
            let [x, z] = frame.point(piece.end);
            let [fx, fz] = frame.point(from);
            let code = match (piece.centre, entry) {
                (None, Some(false)) => "G0".to_owned(),
                (None, _) => "G1".to_owned(),
                (Some(centre), _) => {
                    let [cx, cz] = frame.point(centre);
                    let (a, b) = ([fz - cz, fx - cx], [z - cz, x - cx]);
                    let turn = a[0] * b[1] - a[1] * b[0];
                    let code = if turn > 0 { "G3" } else { "G2" };
                    format!("{code} I{} K{}", say(cx - fx), say(cz - fz))
                }
            };
            let [tx, tz] = if is_incremental && !system_a { [x - fx, z - fz] } else { [x, z] };
            *text += &format!("N{line} {code} X{} Z{}\n", say(2 * tx), say(tz));
            line += 10;
            from = piece.end;
        };
        // In along up only, or at a slant.
        if entry > 0 {
            add(&mut text, Piece { end: [-entry, 0], centre: None }, Some(feeds_in));
        }
        add(&mut text, Piece { end: [0, 0], centre: None }, (entry == 0).then_some(feeds_in));
        for &piece in &pieces {
            add(&mut text, piece, None);
        }
        text += "N900 (the end)\n";
        text += "G70 P10 Q900\nM2\n";
        Case { text, pieces, frame, dialect, unit, top, before: before + entry, shift, depth }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// No point of a roughing pass is below the contour with its allowance, by an independent
    /// geometry. Cuts are at most as deep as programmed, and the last one is at the bottom. The
    /// number of commands is bounded. The tool ends at its start.
    #[test]
    fn roughing_keeps_off_the_contour(case in cases()) {
        let Case { text, pieces, frame, dialect, unit, top, before, shift, depth } = case;
        let far = pieces.last().map_or(0, |piece| piece.end[0]);
        let (commands, errors) = run(&text, dialect);
        if far == 0 || pieces.is_empty() {
            // A wall only: there is nothing to cut.
            return Ok(());
        }
        // Whether the start is above the contour with its allowance, to three nanometres along it.
        let [lowest, highest] = [-3.0, 3.0].map(|nm| {
            let far = (-before - shift[0]) as f64 * unit + nm;
            height(&pieces, far, unit) + shift[1] as f64 * unit
        });
        let start = top as f64 * unit;
        if top <= shift[1] || start < lowest {
            prop_assert_eq!(errors.len(), 1, "{}", text);
            return Ok(());
        }
        if start < highest && !errors.is_empty() {
            return Ok(());
        }
        prop_assert!(errors.is_empty(), "{errors:?}\n{text}");
        let cycle = text.lines().position(|line| line.starts_with("G7")).unwrap() + 1;
        let [low_far, low_up] = shift.map(|part| part as f64 * unit);
        let mut from = [Nm(0); 3];
        let mut cuts = Vec::new();
        let mut count = 0;
        let (mut start, mut end) = (None, None);
        for (line, command) in &commands {
            let Some(to) = command.end() else { continue };
            if *line == cycle {
                start = start.or(Some(from));
                end = Some(to);
                count += 1;
                let is_cut = matches!(command, Command::Linear { .. });
                for at in points(from, command) {
                    let [far, up] = frame.course(at, unit);
                    let least = height(&pieces, far - low_far - 3.0, unit) + low_up;
                    prop_assert!(up >= least - 3.0, "{far} {up} {least} of {command}\n{text}");
                }
                let level = frame.course(to, unit)[1];
                if is_cut && (frame.course(from, unit)[1] - level).abs() < 0.1 {
                    cuts.push(level);
                }
            }
            from = to;
        }
        prop_assert_eq!(start, end, "{}", text);
        let deep = top - shift[1];
        let passes = (deep + depth - 1) / depth;
        prop_assert!(count <= 5 * passes + pieces.len() as i64 + 9, "{count}\n{text}");
        // From the start down, none deeper than programmed, down to the bottom where there is
        // material.
        let mut before = top as f64 * unit;
        let mut levels = cuts;
        levels.retain(|level| *level <= before);
        for level in &levels {
            let step = before - level;
            prop_assert!(step <= depth as f64 * unit + 0.1 || step < 0.1, "{step}\n{text}");
            before = before.min(*level);
        }
        // The rest between the last cut and the bottom is a slope without length.
        let bottom = low_up;
        prop_assert!(before - bottom <= depth as f64 * unit + 0.1, "{before}\n{text}");
    }

    /// G70 is the contour itself, to the nanometre: the commands are those of its lines.
    #[test]
    fn finishing_is_the_contour(case in cases()) {
        let (commands, errors) = run(&case.text, case.dialect);
        prop_assume!(errors.is_empty());
        let first = case.text.lines().position(|line| line.starts_with("N10 ")).unwrap() + 1;
        let of_contour = |line: usize| case.text.lines().nth(line - 1).unwrap().starts_with('N');
        let made: Vec<_> = commands
            .iter()
            .filter(|(line, _)| *line >= first && of_contour(*line))
            .map(|(_, command)| *command)
            .collect();
        let plain: String = case
            .text
            .lines()
            .filter(|line| !line.starts_with("G7"))
            .map(|line| format!("{line}\n"))
            .collect();
        let (expected, errors) = run(&plain, case.dialect);
        prop_assert!(errors.is_empty());
        let expected: Vec<_> = expected
            .iter()
            .filter(|(line, _)| plain.lines().nth(line - 1).unwrap().starts_with('N'))
            .map(|(_, command)| *command)
            .collect();
        prop_assert_eq!(made, expected);
    }

    /// Any program ends, and nothing overflows.
    #[test]
    fn any_program_ends(
        lines in prop::collection::vec(
            prop_oneof![
                "N[0-9] G[0123] X-?[0-9]{1,3} Z-?[0-9]{1,3}( I-?[0-9]{1,2} K-?[0-9]{1,2})?",
                "N[0-9] [XZUW]-?[0-9]{1,3}",
                "G7[012] P[0-9] Q[0-9] U-?[0-9] W-?[0-9] D[0-9]{1,2} R[0-9]",
                "G7[012](.1)? [PQUWDRFS][0-9]{1,9} [PQUWDRXZ]-?[0-9]{1,9}",
                "(G9[01]|G2[01]|G1[789]|G[78]|G42.1 D1|G40|M3 S100|G9[459] F1|F100|M2|/?N[0-9])",
                "G76 P[0-9]{1,6} Q[0-9]{1,4}( R0.1)?",
                "G76 X-?[0-9]{1,2} Z-?[0-9]{1,2} P[0-9]{2,5} Q[0-9]{2,5} F[0-9]( R-?[0-9])?",
                "\\PC{0,20}",
            ],
            0..14,
        ),
        system_a in any::<bool>(),
    ) {
        let dialect = if system_a { Dialect::LATHE_A } else { Dialect::LATHE };
        run(&lines.join("\n"), dialect);
    }
}

fn only_error(text: &str) -> (usize, ErrorKind) {
    let (_, errors) = run(text, Dialect::LATHE);
    assert!(!errors.is_empty(), "{text}");
    errors[0]
}

/// A shaft: `lines` is its contour after N1.
fn shaft(cycle: &str, lines: &str) -> String {
    format!("G0 X40 Z2\nF100\n{cycle}\nN1 G0 X10\n{lines}\n")
}

#[test]
fn what_cannot_be_cut_is_refused_at_its_line() {
    let cycle = "G71 P1 Q9 D1";
    for (text, line, kind) in [
        (
            shaft(cycle, "G1 Z-5\nX8 Z-9\nN9 X40"),
            6,
            ErrorKind::Pocket(b'X'),
        ),
        (
            shaft(cycle, "G1 Z-5\nX20 Z-4\nN9 X40 Z-9"),
            6,
            ErrorKind::Pocket(b'Z'),
        ),
        (
            shaft(cycle, "G1 Z-5\nG2 X10 Z-15 R8\nN9 G1 X40"),
            6,
            ErrorKind::Pocket(b'X'),
        ),
        (
            shaft(cycle, "G1 Z-5\nG4 P1\nN9 X40"),
            6,
            ErrorKind::NotOfContour,
        ),
        (
            shaft(cycle, "G1 Z-5\nN8 X40"),
            3,
            ErrorKind::NoContour(b'Q'),
        ),
        (
            shaft("G71 P2 Q9 D1", "N9 G1 Z-5"),
            3,
            ErrorKind::NoContour(b'P'),
        ),
        (
            shaft("G71 P1 D1", "N9 G1 Z-5"),
            3,
            ErrorKind::MissingWord(b'Q'),
        ),
        // The start is under the contour with its allowance, seen along Z.
        (
            shaft("G71 P1 Q9 D1 U1 W10", "G1 X30 Z-5\nN9 X39.8"),
            3,
            ErrorKind::OutOfRange(b'U'),
        ),
        (
            shaft("G71 P1 Q9", "N9 G1 Z-5"),
            3,
            ErrorKind::MissingWord(b'D'),
        ),
        (
            shaft("G71 P1 Q9 D0", "N9 G1 Z-5"),
            3,
            ErrorKind::OutOfRange(b'D'),
        ),
        (
            shaft("G71 P1 Q9 D1 R-1", "N9 G1 Z-5"),
            3,
            ErrorKind::OutOfRange(b'R'),
        ),
        (
            "G0 X40 Z2\nF100\nG71 P1 Q9 D1\nN1 G2 X30 Z-3 R5\nN9 G1 Z-9".to_owned(),
            4,
            ErrorKind::NotOfContour,
        ),
        (
            shaft("G71 P1 Q9 D1 U-1", "N9 G1 Z-5"),
            3,
            ErrorKind::OutOfRange(b'U'),
        ),
        (
            shaft("G71 P1 Q9 D1 W-1", "N9 G1 Z-5"),
            3,
            ErrorKind::OutOfRange(b'W'),
        ),
        (
            shaft("G71 P1 Q9 D1 X3", "N9 G1 Z-5"),
            3,
            ErrorKind::UnusedWord(b'X'),
        ),
        (
            shaft("G71 P1 Q9 D0.0001", "N9 G1 Z-5"),
            3,
            ErrorKind::TooManyPasses,
        ),
        (
            shaft("G71.1 Q9 D1", "N9 G1 Z-5"),
            3,
            ErrorKind::NotOfDialect(b'G', 711),
        ),
        (shaft(cycle, "N9 G1 X12"), 3, ErrorKind::ContourStart),
        (
            shaft("G17 G71 P1 Q9 D1", "N9 G1 Z-5"),
            3,
            ErrorKind::TwoUsersOfWords,
        ),
        ("G0 U1".to_owned(), 1, ErrorKind::UnknownWord(b'U')),
        ("G70 P1 Q2".to_owned(), 1, ErrorKind::NoContour(b'P')),
    ] {
        assert_eq!(only_error(&text), (line, kind), "{text}");
    }
    let long: String = (0..65).map(|z| format!("G1 Z-{z}\n")).collect();
    let text = shaft(cycle, &format!("{long}N9 X40"));
    assert_eq!(only_error(&text), (69, ErrorKind::ContourTooLong));
}

#[test]
fn a_refused_cycle_is_passed_by_with_its_contour() {
    let text = shaft("G71 P1 Q9 D1", "G1 Z-5\nX8 Z-9\nN9 X40") + "G0 X50";
    let (commands, errors) = run(&text, Dialect::LATHE);
    assert_eq!(errors.len(), 1);
    let text: Vec<_> = commands
        .iter()
        .map(|(_, command)| command.to_string())
        .collect();
    assert_eq!(text, ["rapid X20 Y0 Z2", "rapid X25 Y0 Z2"]);
}

#[test]
fn two_lines_say_what_one_says() {
    let contour = "G1 Z-5\nG2 X20 Z-10 R5\nN9 G1 X42";
    let one = shaft("\nG71 P1 Q9 D1.5 R0.3 U0.4 W0.1 F80", contour);
    let two = shaft("G71 U1.5 R0.3\nG71 P1 Q9 U0.4 W0.1 F80", contour);
    for dialect in [Dialect::LATHE, Dialect::LATHE_A] {
        let (one, two) = (run(&one, dialect), run(&two, dialect));
        assert!(one.1.is_empty() && one.0.len() > 30, "{one:?}");
        assert_eq!(one, two);
    }
}

#[test]
fn a_numbered_contour_is_found_where_it_is() {
    // The same numbers twice: each G70 uses the ones before it.
    let text = "G0 X20 Z1\nF100\nG71 U1\nG71 P1 Q2\nN1 G0 X10\nN2 G1 Z-5\nG70 P1 Q2\n\
                G71 P1 Q2\n(behind it)\nN1 G0 X8\nN2 G1 Z-9\nG70 P1 Q2\n";
    let (commands, errors) = run(text, Dialect::LATHE_A);
    assert!(errors.is_empty(), "{errors:?}");
    let finishing: Vec<_> = commands
        .iter()
        .filter(|(line, _)| matches!(line, 5 | 6 | 10 | 11))
        .map(|(line, command)| format!("{line}: {command}"))
        .collect();
    assert_eq!(
        finishing,
        [
            "5: rapid X5 Y0 Z1",
            "6: linear X5 Y0 Z-5 F100",
            "10: rapid X4 Y0 Z1",
            "11: linear X4 Y0 Z-9 F100"
        ]
    );
    assert!(needs_contours(b"G76 X1", &Dialect::LATHE_A));
    assert!(!needs_contours(b"G76 X1", &Dialect::LATHE));
    assert!(needs_contours(b"N5 g71 P1 Q2", &Dialect::LATHE));
    assert!(!needs_contours(b"G71 P1 Q2", &Dialect::RS274));
    assert!(!needs_contours(b"G7 (G71)", &Dialect::LATHE));
}

#[test]
fn a_thread_is_reported_in_two_lines() {
    let program = |first: &str, second: &str| {
        format!("M3 S500\nG0 X20 Z5\nG76 {first}\nG76 {second}\nG0 Z9\n")
    };
    let text = program("P020060 Q100 R0.05", "X17.4 Z-20 P1300 Q500 F2");
    let (commands, errors) = run(&text, Dialect::LATHE_A);
    assert!(errors.is_empty(), "{errors:?}");
    let mut depths = Vec::new();
    let mut at = [Nm(0); 3];
    for (_, command) in &commands {
        if let Command::Thread { to, lead } = command {
            assert_eq!((lead.0, to[2].0), (2_000_000, -20_000_000));
            let depth = 10_000_000 - to[0].0;
            depths.push(depth);
            // Sideways by half the angle: the flank is on the line of the thread.
            let aside = (5_000_000 - at[2].0) as f64 - depth as f64 * 30f64.to_radians().tan();
            assert!(aside.abs() < 2.0, "{aside}");
        }
        at = command.end().unwrap_or(at);
    }
    assert_eq!(at[0], Nm(10_000_000));
    // By the root of the number, at least 0.1 mm more, 0.05 mm for the last, and that twice.
    let mut expected: Vec<i64> = Vec::new();
    let mut last = 0;
    for n in 1.. {
        let by_root = (500_000.0 * f64::from(n).sqrt()) as i64;
        last = by_root.max(last + 100_000).min(1_250_000);
        expected.push(last);
        if last == 1_250_000 {
            break;
        }
    }
    expected.extend([1_300_000, 1_300_000]);
    assert_eq!(depths, expected);
    let (commands, _) = run(
        &program("P011000", "X14.4 Z-20 P1300 Q1300 F2 R-1"),
        Dialect::LATHE_A,
    );
    let text: Vec<_> = commands
        .iter()
        .map(|(_, command)| command.to_string())
        .collect();
    assert_eq!(
        text[2..],
        [
            "rapid X10 Y0 Z5",
            "rapid X6.2 Y0 Z5",
            "thread X7.14 Y0 Z-18.5 lead 2.001599",
            "thread X8.7 Y0 Z-20 lead 2.001599",
            "rapid X10 Y0 Z-20",
            "rapid X10 Y0 Z5",
            "rapid X10 Y0 Z9"
        ]
    );
    for (first, second, line, kind) in [
        (
            "P010099",
            "X17 Z-9 P1 Q1 F1",
            3,
            ErrorKind::OutOfRange(b'P'),
        ),
        (
            "P010060",
            "X17 Z-9 Q100 F1",
            4,
            ErrorKind::MissingWord(b'P'),
        ),
        ("P010060", "X17 Z5 P900 Q100 F1", 4, ErrorKind::ThreadStart),
        ("P010060", "X19 Z-9 P900 Q100 F1", 4, ErrorKind::ThreadStart),
        ("P010060", "X17 Z-9 P900 Q1 F1", 4, ErrorKind::TooManyPasses),
    ] {
        let (_, errors) = run(&program(first, second), Dialect::LATHE_A);
        assert_eq!(errors, [(line, kind)], "{first} {second}");
    }
}

#[test]
fn every_kind_of_line_end_ends_one_line() {
    let lines = [
        "G18 G21 F100",
        "G0 X40 Z2",
        "(its contour)",
        "G71 P5 Q6 D2",
        "N5 G0 X20",
        "G1 Z-10",
        "N6 X40",
        "G70 P5 Q6",
    ];
    let expected = run(&lines.join("\n"), Dialect::LATHE);
    assert!(
        expected.0.len() > 20 && expected.1.is_empty(),
        "{expected:?}"
    );
    assert_eq!(run(&lines.join("\r\n"), Dialect::LATHE), expected);
    assert_eq!(run(&lines.join("\r"), Dialect::LATHE), expected);
}

/// The commands of a program, as text with their lines.
fn told(text: &str, dialect: Dialect) -> Vec<String> {
    let (commands, errors) = run(text, dialect);
    assert_eq!(errors, [], "{text}");
    commands
        .iter()
        .map(|(line, command)| format!("{line}: {command}"))
        .collect()
}

/// The moves of a cycle in order: shifted by the allowance, in at the feed where the contour begins
/// with G1, the last cut at the bottom, no retract longer than the cut, then once along the contour
/// and back to the start.
#[test]
fn a_roughing_cycle_move_by_move() {
    let text = "G0 X20 Z1\nF100\nG71 P1 Q9 D3 R0.5 U1 W0.25 F80 S5\nN1 G1 X8\nS7 M8 G64\nZ-4\n\
                N9 G3 X18 Z-9 I0 K-5\nG70 P1 Q9 F60\n";
    assert_eq!(
        told(text, Dialect::LATHE),
        [
            "1: rapid X10 Y0 Z1",
            "3: rapid X10 Y0 Z1.25",
            "3: linear X7 Y0 Z1.25 F80",
            "3: linear X7 Y0 Z-4.419872 F80",
            "3: rapid X7.5 Y0 Z-3.919872",
            "3: rapid X7.5 Y0 Z1.25",
            "3: linear X4.5 Y0 Z1.25 F80",
            "3: linear X4.5 Y0 Z-3.75 F80",
            "3: rapid X5 Y0 Z-3.25",
            "3: rapid X5 Y0 Z1.25",
            "3: linear X4.5 Y0 Z1.25 F80",
            "3: linear X4.5 Y0 Z-3.75 F80",
            "3: arc ccw zx X9.5 Y0 Z-8.75 centre X4.5 Y0 Z-8.75 F80",
            "3: rapid X10 Y0 Z-8.75",
            "3: rapid X10 Y0 Z1",
            "4: linear X4 Y0 Z1 F60",
            "5: coolant flood",
            "5: path blend",
            "6: linear X4 Y0 Z-4 F60",
            "7: arc ccw zx X9 Y0 Z-9 centre X4 Y0 Z-9 F60",
            "8: rapid X10 Y0 Z-9",
            "8: rapid X10 Y0 Z1"
        ]
    );
    // In rapid, and never beyond the start of a cut.
    let text = "G0 X12 Z0.125\nF100\nG72 P1 Q9 D1 R5\nN1 G0 Z-2\nG1 X9\nN9 X8 Z0.125\n";
    assert_eq!(
        told(text, Dialect::LATHE),
        [
            "1: rapid X6 Y0 Z0.125",
            "3: rapid X6 Y0 Z-0.875",
            "3: linear X4.235295 Y0 Z-0.875 F100",
            "3: rapid X6 Y0 Z0.889705",
            "3: rapid X6 Y0 Z-1.875",
            "3: linear X4.470589 Y0 Z-1.875 F100",
            "3: rapid X6 Y0 Z-0.345589",
            "3: rapid X6 Y0 Z-2",
            "3: linear X4.5 Y0 Z-2 F100",
            "3: rapid X6 Y0 Z-0.5",
            "3: rapid X6 Y0 Z-2",
            "3: linear X4.5 Y0 Z-2 F100",
            "3: linear X4 Y0 Z0.125 F100",
            "3: rapid X6 Y0 Z0.125"
        ]
    );
}

/// Without a retract the tool goes straight back.
#[test]
fn no_retract() {
    let text = "G0 X14 Z1\nF100\nG71 P1 Q9 D5 R0\nN1 G0 X10\nG1 Z-4\nN9 X14\n";
    assert_eq!(
        told(text, Dialect::LATHE),
        [
            "1: rapid X7 Y0 Z1",
            "3: rapid X5 Y0 Z1",
            "3: linear X5 Y0 Z-4 F100",
            "3: rapid X5 Y0 Z1",
            "3: rapid X5 Y0 Z1",
            "3: linear X5 Y0 Z-4 F100",
            "3: linear X7 Y0 Z-4 F100",
            "3: rapid X7 Y0 Z1"
        ]
    );
}

/// In and out along the same axis; from a bore inwards first. Where the way in is a slant, straight
/// back.
#[test]
fn finishing_goes_home_out_of_the_material_first() {
    let home = |way_in: &str| {
        let text = format!("G0 X20 Z2\nF100\nG70 P1 Q2\nM2\nN1 {way_in}\nG1 Z-5\nN2 X30\n");
        told(&text, Dialect::LATHE).split_off(4)
    };
    assert_eq!(home("G0 X10"), ["3: rapid X15 Y0 Z2", "3: rapid X10 Y0 Z2"]);
    assert_eq!(home("G0 X10 Z1"), ["3: rapid X10 Y0 Z2"]);
    assert_eq!(home("G0 Z-1"), ["3: rapid X15 Y0 Z2", "3: rapid X10 Y0 Z2"]);
    assert_eq!(
        home("G0 X26"),
        ["3: rapid X10 Y0 Z-5", "3: rapid X10 Y0 Z2"]
    );
}

/// States in which a contour cannot be roughed, and lines that are not part of it.
#[test]
fn what_a_contour_is_not_made_of() {
    let cycle = "G71 P1 Q9 D1";
    let after = |before: &str| format!("{before}\nG71 P1 Q9 D1\nN1 G0 X10\nN9 G1 Z-5\n");
    for (text, line, kind) in [
        (after("G0 X40 Z2"), 2, ErrorKind::NoFeed),
        (after("G0 X40 Z2 F1\nG93"), 3, ErrorKind::WrongFeedMode),
        (after("G0 X40 Z2 F1\nG17"), 3, ErrorKind::NotOfContour),
        (
            after("G0 X40 Z2 F1\nG42.1 D1"),
            3,
            ErrorKind::UnderCompensation,
        ),
        // The allowance leaves nothing to cut.
        (
            shaft("G71 P1 Q9 D1 U30", "N9 G1 X40 Z-5"),
            3,
            ErrorKind::OutOfRange(b'U'),
        ),
        (
            shaft(cycle, "G17 G2 X14 Y0 I1\nN9 G1 Z-5"),
            5,
            ErrorKind::NotOfContour,
        ),
        (
            shaft(cycle, "G1 Z-5\nG2 X20 Z-10 R5 P2\nN9 G1 Z-15"),
            6,
            ErrorKind::NotOfContour,
        ),
        (
            shaft(cycle, "G1 Z-5\nY1\nN9 G1 Z-15"),
            6,
            ErrorKind::NotOfContour,
        ),
    ] {
        assert_eq!(only_error(&text), (line, kind), "{text}");
    }
}

/// 2^16 cuts are accepted, one more is refused.
#[test]
fn the_most_cuts() {
    let refused = |x: &str| {
        let text = format!("G0 X{x} Z2\nF100\nG71 P1 Q9 D0.000001\nN1 G0 X10\nN9 G1 X60 Z-5\n");
        let mut contours: Contours = Contours::new(text.as_bytes(), Dialect::LATHE);
        let mut modal = Modal::<3>::new(Dialect::LATHE);
        for _ in 0..3 {
            let line = contours.next_line(&modal).expect("a line");
            match line.block.and_then(|block| modal.plan(&block)) {
                Ok((next, _)) => modal = next,
                Err(error) => return Some(error.kind),
            }
        }
        None
    };
    assert_eq!(refused("10.131072"), None);
    assert_eq!(refused("10.131074"), Some(ErrorKind::TooManyPasses));
}

/// A number after a block delete does not count, nor does that of the line of G70 itself.
#[test]
fn numbers_that_are_none_of_the_contour() {
    let text = "G0 X20 Z1\nF100\nN1 G0 X10\nN2 G1 Z-5\nN1 G70 P1 Q2\n";
    let told_lines = told(text, Dialect::LATHE);
    assert_eq!(
        told_lines[3..5],
        ["3: rapid X5 Y0 Z-5", "4: linear X5 Y0 Z-5 F100"]
    );
    let text = "G0 X20 Z1\nF100\n/N1 G0 X12\nN1 G0 X10\nN2 G1 Z-5\nG70 P1 Q2\n";
    let dialect = Dialect::LATHE;
    let told_lines = told(text, dialect.with_block_delete(true));
    assert_eq!(
        told_lines[3..5],
        ["4: rapid X5 Y0 Z-5", "5: linear X5 Y0 Z-5 F100"]
    );
}

/// `N` marks the last line of a contour; another letter, or a deleted line, does not.
#[test]
fn other_numbers_than_those_of_lines() {
    let text = |lines: &str| format!("G0 X40 Z2\nF100\nG70 P1 Q9\nN1 G0 X4\n{lines}N9 X40 Z-9\n");
    let dialect = Dialect::LATHE.with_block_delete(true);
    let plain = told(&text("G1 Z-1\nX9\n(N9)\n"), dialect);
    assert_eq!(told(&text("G1 Z-1\nX9\n/N9 X12\n"), dialect), plain);
    assert_eq!(plain.last().map(String::as_str), Some("3: rapid X20 Y0 Z2"));
    assert_eq!(plain.len(), 6);
}

/// Passes by the root of their number are counted where there are at most 255 by depth; otherwise
/// by the least step.
#[test]
fn the_most_passes_of_a_thread() {
    let refused = |first: &str, second: &str| {
        let text = format!("M3 S500\nG0 X12 Z2\nG76 {first}\nG76 {second}\n");
        let mut contours: Contours = Contours::new(text.as_bytes(), Dialect::LATHE_A);
        let mut modal = Modal::<3>::new(Dialect::LATHE_A);
        for _ in 0..4 {
            let line = contours.next_line(&modal).expect("a line");
            match line.block.and_then(|block| modal.plan(&block)) {
                Ok((next, _)) => modal = next,
                Err(error) => return Some(error.kind),
            }
        }
        None
    };
    let many = Some(ErrorKind::TooManyPasses);
    assert_eq!(refused("Q0", "X10 Z0 P255 Q1 F2"), None);
    assert_eq!(refused("Q0", "X10 Z0 P256 Q1 F2"), many);
    assert_eq!(refused("Q0.000001", "X10 Z0 P0.065536 Q0.000001 F2"), None);
    assert_eq!(refused("Q0.000001", "X10 Z0 P0.065537 Q0.000001 F2"), many);
}

/// Threads inside and outside, in both directions, with tapers, in inches; and the limits of the
/// ranges of their words.
#[test]
fn threads_of_all_four_kinds() {
    let thread = |before: &str, first: &str, second: &str| {
        let text = format!("M3 S500\n{before}\nG76 {first}\nG76 {second}\n");
        run(&text, Dialect::LATHE_A)
    };
    let moves = |before: &str, first: &str, second: &str| {
        let (commands, errors) = thread(before, first, second);
        assert_eq!(errors, [], "{before} {first} {second}");
        let last = commands.iter().filter(|(line, _)| *line == 4);
        last.map(|(_, command)| command.to_string())
            .collect::<Vec<_>>()
    };
    // A bore, away from the chuck, with a run-out of half a lead and a taper.
    assert_eq!(
        moves("G0 X10 Z-20", "P010560 Q0 R0", "X12 Z0 P800 Q800 F2 R0.1"),
        [
            "rapid X5 Y0 Z-19.53812",
            "rapid X6.09769 Y0 Z-19.53812",
            "thread X6.001 Y0 Z-0.2 lead 2.000024",
            "thread X5.8 Y0 Z0 lead 2.000024",
            "rapid X5 Y0 Z0",
            "rapid X5 Y0 Z-20"
        ]
    );
    assert_eq!(
        moves("G0 X10 Z-20", "P010500", "X12 Z0 P800 Q800 F2 R-0.1"),
        [
            "rapid X5 Y0 Z-20",
            "rapid X5.9 Y0 Z-20",
            "thread X5.999 Y0 Z-0.2 lead 2.000024",
            "thread X5.8 Y0 Z0 lead 2.000024",
            "rapid X5 Y0 Z0",
            "rapid X5 Y0 Z-20"
        ]
    );
    // Counts of ten-thousandths of an inch.
    assert_eq!(
        moves("G20 G0 X1 Z1", "P010000", "X0.8 Z0 P100 Q60 F0.1"),
        [
            "rapid X12.7 Y0 Z25.4",
            "rapid X10.2616 Y0 Z25.4",
            "thread X10.2616 Y0 Z0 lead 2.54",
            "rapid X12.7 Y0 Z0",
            "rapid X12.7 Y0 Z25.4",
            "rapid X10.198474 Y0 Z25.4",
            "thread X10.198474 Y0 Z0 lead 2.54",
            "rapid X12.7 Y0 Z0",
            "rapid X12.7 Y0 Z25.4",
            "rapid X10.16 Y0 Z25.4",
            "thread X10.16 Y0 Z0 lead 2.54",
            "rapid X12.7 Y0 Z0",
            "rapid X12.7 Y0 Z25.4"
        ]
    );
    // The start at the crest, and a run-out longer than the thread.
    assert_eq!(
        moves("G0 X12 Z2", "P019980", "X10 Z0 P1000 Q1000 F2"),
        [
            "rapid X6 Y0 Z1.1609",
            "rapid X5 Y0 Z1.1609",
            "thread X5 Y0 Z0 lead 2",
            "rapid X6 Y0 Z0",
            "rapid X6 Y0 Z2"
        ]
    );
    // Many small passes are few where each increases by the least step.
    assert_eq!(
        moves("G0 X12 Z2", "P010000 Q300", "X10 Z0 P1000 Q1 F2").len(),
        17
    );
    for (first, second, line, kind) in [
        ("P010081", "", 3, ErrorKind::OutOfRange(b'P')),
        ("P1000000", "", 3, ErrorKind::NotWhole(b'P')),
        ("Q-1", "", 3, ErrorKind::OutOfRange(b'Q')),
        ("R-1", "", 3, ErrorKind::OutOfRange(b'R')),
        (
            "P010000",
            "X10 Z0 P1000 Q0 F2",
            4,
            ErrorKind::OutOfRange(b'Q'),
        ),
        (
            "P010000",
            "X10 Z0 P1000 Q1000 F0",
            4,
            ErrorKind::OutOfRange(b'F'),
        ),
        (
            "P010000",
            "X10 Z0 P1001 Q1000 F1",
            4,
            ErrorKind::ThreadStart,
        ),
        // Outside at one end and inside at the other; and too little room at one end.
        (
            "P010000",
            "X10 Z0 P900 Q900 F1 R3",
            4,
            ErrorKind::ThreadStart,
        ),
        (
            "P010000",
            "X10 Z0 P900 Q900 F1 R0.5",
            4,
            ErrorKind::ThreadStart,
        ),
    ] {
        let (_, errors) = thread("G0 X12 Z2", first, second);
        assert_eq!(errors[0], (line, kind), "{first} {second}");
    }
    let (_, errors) = thread("G0 X12 Z2\nG42.1 D1", "P010000", "X10 Z0 P900 Q900 F1");
    assert_eq!(errors[0], (4, ErrorKind::UnderCompensation));
    // With I, J and K it is the cycle of one line.
    let (commands, errors) = run(
        "M3 S500\nG0 X12 Z2\nG76 P2 Z-8 I-1 J0.5 K1\n",
        Dialect::LATHE_A,
    );
    assert_eq!((commands.len(), errors), (10, vec![]));
}
