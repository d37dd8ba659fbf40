//! Machines with other axes than X Y Z: their letters, degrees, wrapped axes, and what F measures.
#![cfg(feature = "extended")]

use husillo_gcode::{Axes, Block, Command, Dialect, Error, Modal, Nm};
use proptest::prelude::*;

fn axes(letters: &str) -> Axes {
    Axes::new(letters.as_bytes()).expect(letters)
}

/// The state after these lines, and their commands as text.
fn run<const N: usize>(dialect: Dialect, lines: &[&str]) -> (Modal<N>, Vec<String>) {
    let (mut modal, mut made) = (Modal::<N>::new(dialect), Vec::new());
    for line in lines {
        let block = Block::parse(line.as_bytes(), &dialect).expect(line);
        let (next, commands) = modal.plan(&block).expect(line);
        made.extend(commands.map(|command| command.shown(*dialect.axes()).to_string()));
        modal = next;
    }
    (modal, made)
}

fn fault(dialect: Dialect, before: &str, line: &str) -> (u16, usize, usize, String) {
    let (modal, _) = run::<6>(dialect, &[before]);
    let block = Block::parse(line.as_bytes(), &dialect);
    let Error { kind, at, end } = block.and_then(|block| modal.plan(&block)).unwrap_err();
    (kind.code(), at, end, kind.to_string())
}

#[test]
fn words_move_the_axes_of_their_letters() {
    let dialect = Dialect::RS274.with_axes(axes("XYZBUC"));
    let lines = [
        "G20 G0 X1 U2 B3 C-4",
        "G91 G1 C1 U-1 F10",
        "G21 G90 G2 X0 I-12.7 B0 U1",
    ];
    assert_eq!(
        run::<6>(dialect, &lines).1,
        [
            "rapid X25.4 Y0 Z0 B3 U50.8 C-4",
            "linear X25.4 Y0 Z0 B3 U25.4 C-3 F254",
            "arc cw xy X0 Y0 Z0 B0 U1 C-3 centre X12.7 Y0 Z0 B3 U25.4 C-3 F254",
        ]
    );
}

#[test]
fn offsets_and_homes_are_those_of_their_letters() {
    let dialect = Dialect::RS274.with_axes(axes("XYZVA"));
    let lines = [
        "G10 L2 P1 V1 A2",
        "G92 V-1",
        "G43.1 A5",
        "G0 V10 A20",
        "G28.1",
        "G28 V0",
        "G53 G0 A1",
    ];
    assert_eq!(
        run::<5>(dialect, &lines).1,
        [
            "tool length 0 X0 Y0 Z0 V0 A5",
            "rapid X0 Y0 Z0 V11 A27",
            "rapid X0 Y0 Z0 V1 A27",
            "rapid X0 Y0 Z0 V11 A27",
            "rapid X0 Y0 Z0 V11 A1",
        ]
    );
}

#[test]
fn errors_have_the_written_letter_and_its_columns() {
    let dialect = Dialect::RS274.with_axes(axes("XYZCE"));
    for (line, code, at, end, text) in [
        ("G0 X1 A2", 201, 6, 8, "A"),
        ("G0 U2", 201, 3, 5, "U"),
        ("G0 C1 C2", 203, 6, 8, "C"),
        ("G0 E2000000000", 103, 3, 14, ""),
        ("G81 Z-1 R1 E3 F10", 215, 11, 13, "E"),
        ("M68 E1 Q2", 213, 0, 3, "E"),
    ] {
        let (found, from, to, message) = fault(dialect, "G21", line);
        assert_eq!((found, from, to), (code, at, end), "{line}: {message}");
        assert!(message.contains(text), "{line}: {message}");
    }
}

#[test]
fn a_machine_without_them_refuses_rotary_words() {
    let dialect = Dialect::RS274.with_axes(Axes::XYZ);
    assert_eq!(fault(dialect, "", "G0 X1 A2").0, 201);
    let (_, made) = run::<6>(dialect, &["G0 X1 Z-2"]);
    assert_eq!(made, ["rapid X1 Y0 Z-2"]);
}

#[test]
#[cfg(feature = "program")]
fn parameters_know_the_letters() {
    use husillo_gcode::parameters::System;
    let dialect = Dialect::RS274.with_axes(axes("XYZCW"));
    let (modal, _) = run::<5>(dialect, &["G20", "G0 X1 C90 W2"]);
    let value = |number| {
        modal
            .numbered(number)
            .map(|value| value.to_decimal().to_string())
    };
    // X, A, B, C in degrees, U, W.
    for (place, expected) in [(0, "1"), (3, "0"), (4, "0"), (5, "90"), (6, "0"), (8, "2")] {
        let text = value(5420 + place).unwrap();
        assert_eq!(
            text.parse::<f64>().unwrap().to_string(),
            expected,
            "{place}"
        );
    }
    assert_eq!(
        modal
            .named(b"C")
            .map(|value| value.to_decimal().to_string()),
        value(5425)
    );
}

fn wrapped() -> Dialect {
    Dialect::RS274.with_axes(axes("XYZA").with_wrapped(b"A").unwrap())
}

#[test]
fn the_sign_of_a_wrapped_word_is_a_direction() {
    let lines = [
        "G0 A90",
        "G0 A-0",
        "G0 A270",
        "G0 A0",
        "G0 A-359.5",
        "G91 G0 A-720",
        "G90 G0 A0.5",
        "G0 A-0.",
        "G0 A0",
    ];
    let ends = [
        "90", "0", "270", "360", "359.5", "-360.5", "-359.5", "-360", "-360",
    ];
    let expected = ends.map(|end| format!("rapid X0 Y0 Z0 A{end}"));
    assert_eq!(run::<4>(wrapped(), &lines).1, expected);
}

#[test]
fn a_wrapped_word_is_less_than_a_turn() {
    for (line, at, end) in [("G0 A360", 3, 7), ("G1 F1 A-400", 6, 11)] {
        let found = fault(wrapped(), "G21", line);
        assert_eq!((found.0, found.1, found.2), (505, at, end), "{line}");
    }
}

/// Twenty turns of a wrapped axis are not turned back: it goes home by the shorter way.
#[test]
fn home_of_a_wrapped_axis_is_never_farther_than_half_a_turn() {
    let lines = ["G91 G0 A7290", "G28 A0", "G0 A-7100", "G28", "G28 A200"];
    let ends = ["7290", "7290", "7200", "100", "0", "200", "360"];
    let expected = ends.map(|end| format!("rapid X0 Y0 Z0 A{end}"));
    assert_eq!(run::<4>(wrapped(), &lines).1, expected);
    let far = Dialect::RS274.with_axes(axes("XYZA"));
    let (_, made) = run::<4>(far, &["G91 G0 A7290", "G28 A0"]);
    assert_eq!(made.last().unwrap(), "rapid X0 Y0 Z0 A0");
}

/// The rule of LinuxCNC in binary floating point.
fn unwrapped(word: f64, current: f64) -> f64 {
    let turn = (current / 360.0).floor() * 360.0;
    let end = word.abs() + turn;
    match word.is_sign_negative() {
        false if end < current - 1e-7 => end + 360.0,
        true if end > current + 1e-7 => end - 360.0,
        _ => end,
    }
}

proptest! {
    /// A wrapped axis ends where LinuxCNC's does, in every work frame, after any other moves.
    #[test]
    fn wrapped_moves_are_those_of_linuxcnc(
        zero in -1000.0..1000.0_f64,
        words in prop::collection::vec((-359.999..359.999_f64, any::<bool>()), 1..20),
    ) {
        let dialect = wrapped();
        let (mut modal, _) = run::<4>(dialect, &[&format!("G10 L2 P1 A{zero:.3}")]);
        let zero = (zero * 1000.0).round() / 1000.0;
        let mut at = -zero;
        for (word, is_increment) in words {
            let mode = if is_increment { "G91" } else { "G90" };
            let text = format!("{word:.3}");
            let line = format!("{mode} G0 A{text}");
            let block = Block::parse(line.as_bytes(), &dialect).unwrap();
            let (next, mut commands) = modal.plan(&block).unwrap();
            let word: f64 = text.parse().unwrap();
            at = if is_increment { at + word } else { unwrapped(word, at) };
            let Some(Command::Rapid { to }) = commands.next() else {
                panic!("{line}");
            };
            let end = to[3].0 as f64 / 1e6 - zero;
            prop_assert!((end - at).abs() < 1e-6, "{line}: {end}, not {at}");
            at = end;
            modal = next;
        }
    }

    /// Rotary words are the same in both units, and linear ones are 25.4 times as long in inches.
    #[test]
    fn only_lengths_have_units(angle in -99_999_i64..99_999, length in -999_i64..999) {
        let dialect = Dialect::RS274.with_axes(axes("XYZAU"));
        let ends = ["G21", "G20"].map(|units| {
            let line = format!("{units} G0 A{angle} U{length}");
            run::<5>(dialect, &[&line]).0.position()
        });
        prop_assert_eq!(ends[0][3], ends[1][3]);
        prop_assert_eq!(ends[0][3], Nm(angle * 1_000_000));
        prop_assert_eq!(ends[0][4].0 * 254, ends[1][4].0 * 10);
    }
}

#[test]
fn feed_measures_the_first_kind_of_axes_that_moves() {
    let axes = axes("XYZAUC");
    for (moves, fed) in [
        ([1, 0, 0, 1, 1, 1], 0b111),
        ([0, 0, 9, 0, 0, 1], 0b111),
        ([0, 0, 0, 1, 1, 1], 0b1_0000),
        ([0, 0, 0, 1, 0, 1], 0b10_1000),
        ([0; 6], 0b111),
    ] {
        assert_eq!(axes.fed(&moves) & 0b11_1111, fed, "{moves:?}");
    }
}
