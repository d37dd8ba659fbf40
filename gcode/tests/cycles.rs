//! Canned cycles and threads: the limits of their words, and every move of variants that differ in
//! few.

#![cfg(feature = "extended")]

use husillo_gcode::{Block, Command, Dialect, ErrorKind, Modal};

/// The commands of the last of these lines, from zero, or the reason for its refusal.
fn last<const N: usize>(lines: &[&str], dialect: Dialect) -> Result<Vec<String>, ErrorKind> {
    let mut modal = Modal::<N>::new(dialect);
    let mut made = Ok(Vec::new());
    for line in lines {
        assert!(made.is_ok(), "{lines:?}: {made:?}");
        let planned = Block::parse(line.as_bytes(), &dialect).and_then(|block| modal.plan(&block));
        made = match planned {
            Ok((next, commands)) => {
                modal = next;
                let text = |command: Command<N>| command.to_string();
                Ok(commands.map(text).collect())
            }
            Err(error) => Err(error.kind),
        };
    }
    made
}

fn mill(lines: &[&str]) -> Result<Vec<String>, ErrorKind> {
    last::<3>(lines, Dialect::RS274)
}

/// A cycle needs a position in the plane or its own depth. Its axes exist in machines of three and
/// of four.
#[test]
fn axes_of_cycles() {
    let hole = "G81 X1 Z-1 R1 F1";
    assert_eq!(mill(&["G81 R1 F1"]), Err(ErrorKind::NoAxisWords));
    let turned = last::<4>(&["G81 A1 Z-1 R1 F1"], Dialect::RS274);
    assert_eq!(turned, Err(ErrorKind::RotaryInCycle(b'A')));
    let alone = last::<4>(&["G81 A1 R1 F1"], Dialect::RS274);
    assert_eq!(alone, Err(ErrorKind::NoAxisWords));
    let flat = last::<2>(&["G81 X1 R1 F1"], Dialect::RS274);
    assert_eq!(flat, Err(ErrorKind::NoAxisWords));
    let four = last::<4>(&[hole], Dialect::RS274).map(|commands| commands.len());
    assert_eq!(four, mill(&[hole]).map(|commands| commands.len()));
}

/// A hole without depth is accepted. There is no move to a retract plane at the present height. The
/// commands after the cycle follow it.
#[test]
fn holes_move_by_move() {
    assert_eq!(
        mill(&["G81 X1 Z1 R1 F60"]).unwrap(),
        ["rapid X0 Y0 Z1", "rapid X1 Y0 Z1", "linear X1 Y0 Z1 F60"]
    );
    assert_eq!(
        mill(&["G0 Z1", "G81 X1 Z0 R1 F60 M2"]).unwrap(),
        [
            "rapid X1 Y0 Z1",
            "linear X1 Y0 Z0 F60",
            "rapid X1 Y0 Z1",
            "end"
        ]
    );
    assert_eq!(mill(&["G81 Z2 R1 F60"]), Err(ErrorKind::RetractBelowBottom));
}

/// A cycle does not announce the number of its commands; everything else does, including the rest.
#[test]
fn as_many_commands_as_stated() {
    for (line, is_known) in [
        ("G81 X1 Z0 R1 F60 M2", false),
        ("G0 X1 M3 S1 M2", true),
        ("G81 X1 Z0 R1 F60 M3 S1 M2", false),
    ] {
        let modal = Modal::<3>::new(Dialect::RS274);
        let block = Block::parse(line.as_bytes(), &Dialect::RS274).expect(line);
        let (_, mut commands) = modal.plan(&block).expect(line);
        assert_eq!(commands.size_hint().1.is_some(), is_known, "{line}");
        loop {
            let (least, most) = commands.size_hint();
            let left = commands.clone().count();
            assert!(
                least <= left && most.is_none_or(|most| most == left),
                "{line}"
            );
            assert!(most.is_some() || left > 0, "{line}");
            if commands.next().is_none() {
                break;
            }
        }
        assert_eq!(commands.size_hint(), (0, Some(0)));
    }
}

/// 2^16 holes, and 2^16 pecks of all of them together.
#[test]
#[cfg_attr(miri, ignore = "many commands")]
fn the_most_holes_and_pecks() {
    let most = ErrorKind::TooManyPasses;
    let refused = |line| mill(&["G0 Z0", line]).err();
    assert_eq!(refused("G91 G81 X1 Z-1 R0 F1 L65536"), None);
    assert_eq!(refused("G91 G81 X1 Z-1 R0 F1 L65537"), Some(most));
    assert_eq!(refused("G91 G81 X1 Z-1 R0 F1 L65539"), Some(most));
    // Two pecks each.
    assert_eq!(refused("G91 G83 X1 Z-1 R0 Q0.6 F1 L32768"), None);
    assert_eq!(refused("G91 G83 X1 Z-1 R0 Q0.6 F1 L32769"), Some(most));
}

/// Taps need their own direction; bores that stop the spindle need one that turns.
#[test]
fn spindles_of_cycles() {
    let stopped = Some(ErrorKind::SpindleStopped);
    for (cycle, off, clockwise, counter_clockwise) in [
        ("G84", stopped, None, stopped),
        ("G74", stopped, stopped, None),
        ("G86", stopped, None, None),
        ("G88", stopped, None, None),
        ("G85", None, None, None),
    ] {
        let line = format!("{cycle} X1 Z-1 R1 F1");
        assert_eq!(mill(&[&line]).err(), off, "{line}");
        assert_eq!(mill(&["M3 S1", &line]).err(), clockwise, "{line}");
        assert_eq!(mill(&["M4 S1", &line]).err(), counter_clockwise, "{line}");
    }
    let bore = "G87 X1 Z-1 R1 F1 I1 J0 K-1";
    assert_eq!(mill(&[bore]).err(), stopped);
    assert_eq!(mill(&["M3 S1", bore]).err(), None);
}

/// A lead is kept for a series of G33, and no longer.
#[test]
fn a_lead_is_kept_for_a_series() {
    let lines = ["G18 M3 S1", "G33 Z-1 K1", "G33 Z-2"];
    assert_eq!(mill(&lines).unwrap(), ["thread X0 Y0 Z-2 lead 1"]);
    let lines = ["G18 M3 S1", "G33 Z-1 K1", "G0 Z0", "G33 Z-2"];
    assert_eq!(mill(&lines), Err(ErrorKind::MissingWord(b'K')));
}

/// G76 without a taper, with one at the start, at the end and at both; outside and inside; in both
/// directions.
#[test]
fn threads_with_tapers_at_their_ends() {
    let made = |line: &str| last::<3>(&["G18 M3 S1", line], Dialect::RS274);
    let told = |words: &str| made(&format!("G76 P1 J0.5 K0.5 {words}")).unwrap();
    let none = told("Z-10 I-1");
    assert_eq!(
        none,
        [
            "rapid X0 Y0 Z0",
            "rapid X-1.5 Y0 Z0",
            "thread X-1.5 Y0 Z-10 lead 1",
            "rapid X0 Y0 Z-10"
        ]
    );
    assert_eq!(told("Z-10 I-1 E2 L0"), none);
    assert_eq!(told("Z-10 I-1 E0 L3"), none);
    assert_eq!(
        told("Z-10 I-1 E2 L1"),
        [
            "rapid X0 Y0 Z0",
            "rapid X-1 Y0 Z0",
            "thread X-1.5 Y0 Z-2 lead 1",
            "thread X-1.5 Y0 Z-10 lead 1",
            "rapid X0 Y0 Z-10"
        ]
    );
    assert_eq!(
        told("Z-10 I-1 E2 L2"),
        [
            "rapid X0 Y0 Z0",
            "rapid X-1.5 Y0 Z0",
            "thread X-1.5 Y0 Z-8 lead 1",
            "thread X-1 Y0 Z-10 lead 1",
            "rapid X0 Y0 Z-10"
        ]
    );
    assert_eq!(
        told("Z10 I1 E2 L3 Q30"),
        [
            "rapid X0 Y0 Z0.288675",
            "rapid X1 Y0 Z0.288675",
            "thread X1.5 Y0 Z2.288675 lead 1",
            "thread X1.5 Y0 Z8 lead 1",
            "thread X1 Y0 Z10 lead 1",
            "rapid X0 Y0 Z10"
        ]
    );
    assert_eq!(
        told("Z-10 I1 E2 L3 Q30 H1"),
        [
            "rapid X0 Y0 Z-0.288676",
            "rapid X1 Y0 Z-0.288676",
            "thread X1.5 Y0 Z-2.288676 lead 1",
            "thread X1.5 Y0 Z-8 lead 1",
            "thread X1 Y0 Z-10 lead 1",
            "rapid X0 Y0 Z-10",
            "rapid X0 Y0 Z-0.288676",
            "rapid X1 Y0 Z-0.288676",
            "thread X1.5 Y0 Z-2.288676 lead 1",
            "thread X1.5 Y0 Z-8 lead 1",
            "thread X1 Y0 Z-10 lead 1",
            "rapid X0 Y0 Z-10"
        ]
    );
}

/// The limits of the ranges of the words of G76.
#[test]
fn words_of_threads() {
    let made = |words: &str| {
        let line = format!("G76 {words}");
        last::<3>(&["G18 M3 S1", &line], Dialect::RS274).err()
    };
    let range = |letter| Some(ErrorKind::OutOfRange(letter));
    assert_eq!(made("P1 Z-9 I-1 J1 K1"), None);
    assert_eq!(made("P0 Z-9 I-1 J1 K1"), range(b'P'));
    assert_eq!(made("P1 Z-9 I-1 J0 K1"), range(b'J'));
    assert_eq!(made("P1 Z-9 I-1 J1 K0"), range(b'K'));
    assert_eq!(made("P1 Z-9 I-1 J1 K1 R1"), None);
    assert_eq!(made("P1 Z-9 I-1 J1 K1 R0.999999"), range(b'R'));
    assert_eq!(made("P1 Z-9 I-1 J1 K1 R100"), None);
    assert_eq!(made("P1 Z-9 I-1 J1 K1 R100.000001"), range(b'R'));
    assert_eq!(made("P1 Z-9 I-1 J1 K1 Q80"), None);
    assert_eq!(made("P1 Z-9 I-1 J1 K1 Q80.000001"), range(b'Q'));
    assert_eq!(made("P1 Z-9 I-1 J1 K1 E0 L3"), None);
    assert_eq!(made("P1 Z-9 I-1 J1 K1 E-1 L3"), range(b'E'));
    assert_eq!(made("P1 Z-9 I-1 J1 K1 E1 L4"), range(b'L'));
    assert_eq!(
        made("P1 Z-9 I-1 J0.000001 K1"),
        Some(ErrorKind::TooManyPasses)
    );
}

/// Splines lie in XY, in machines of two axes too.
#[test]
fn splines_of_two_axes() {
    let line = "G5 X3 I1 J1 P-1 Q1 F60";
    let two = last::<2>(&[line], Dialect::RS274).unwrap();
    let three = mill(&[line]).unwrap();
    assert_eq!((two.len(), three.len()), (1, 1));
    assert_eq!(
        mill(&["G5 X3 Z1 I1 J1 P-1 Q1 F60"]),
        Err(ErrorKind::SplinePlane)
    );
    assert_eq!(
        mill(&["G18", "G5 X3 I1 J1 P-1 Q1 F60"]),
        Err(ErrorKind::SplinePlane)
    );
}

/// Without a distance to the crests the passes go outwards; without a length they are on one side
/// of their start.
#[test]
fn threads_without_depth_or_length() {
    let made = |words: &str| mill(&["G18 M3 S1", &format!("G76 P1 {words}")]).unwrap();
    let peaks = made("Z-5 I0 J0.5 K0.5");
    assert!(peaks.iter().any(|line| line.contains("X0.5 ")), "{peaks:?}");
    let short = made("Z0 I-1 J0.5 K0.5 Q30 E0.25 L1");
    assert!(
        short.iter().any(|line| line.contains("Z0.288")),
        "{short:?}"
    );
    assert!(!short.iter().any(|line| line.contains("Z-")), "{short:?}");
    assert!(short.iter().any(|line| line.contains("Z0.53")), "{short:?}");
}
