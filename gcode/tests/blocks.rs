//! Blocks created anew and in place: their contents, earlier contents, and the code paths they
//! take.

use husillo_gcode::{Block, Command, Commands, Decimal, Dialect, ErrorKind, Modal};

/// A block that is reused keeps none of its former contents, right or wrong.
#[test]
fn a_block_is_used_again() {
    let lines = [
        "G0 X1 F2",
        "G1 Y2",
        "G2 X1 I1",
        "M3 S1",
        "M5",
        "G90 X1.2.3",
        "G91",
        "",
        "/G0 X1",
        "G1 G2",
        "N7",
        "T1 M6",
        "X1 I1",
        "H1",
    ];
    let mut block = Block::new();
    for before in lines {
        for line in lines {
            let _ = block.read(before.as_bytes(), &Dialect::RS274);
            let read = block.read(line.as_bytes(), &Dialect::RS274);
            let fresh = Block::parse(line.as_bytes(), &Dialect::RS274);
            assert_eq!(
                read,
                fresh.as_ref().map(|_| ()).map_err(|error| *error),
                "{line} behind {before}"
            );
            let fresh = fresh.unwrap_or_default();
            for letter in b'A'..=b'Z' {
                assert_eq!(
                    block.word(letter),
                    fresh.word(letter),
                    "{line} behind {before}"
                );
            }
            assert_eq!(
                (block.is_empty(), block.is_deleted(), block.line_number()),
                (fresh.is_empty(), fresh.is_deleted(), fresh.line_number()),
                "{line} behind {before}"
            );
            let modal = Modal::<3>::new(Dialect::RS274);
            let plan = |block| {
                modal
                    .plan(block)
                    .map(|(next, commands)| (next, commands.collect::<Vec<_>>()))
            };
            assert_eq!(plan(&block), plan(&fresh), "{line} behind {before}");
        }
    }
}

/// Every letter has its own slot; letters of codes have none.
#[test]
fn every_letter_keeps_its_value() {
    for letter in b'A'..=b'Z' {
        let line = format!("{}3", char::from(letter));
        let Ok(block) = Block::parse(line.as_bytes(), &Dialect::LATHE_A) else {
            // The others are increments of turning cycles, which are extended codes.
            let increment = matches!(letter, b'U' | b'W') && !cfg!(feature = "extended");
            assert!(letter == b'V' || increment, "all letters but V");
            continue;
        };
        for other in b'A'..=b'Z' {
            let expected = (other == letter && !matches!(letter, b'G' | b'M'))
                .then(|| Decimal::new(3, 0))
                .flatten();
            assert_eq!(block.word(other), expected, "{line}");
        }
    }
    let block = Block::parse(b"X1", &Dialect::RS274).expect("a block");
    for byte in (0..=255_u8).filter(|byte| !byte.is_ascii_uppercase()) {
        assert_eq!(block.word(byte), None);
    }
}

/// Numbers of lines and programs are whole numbers of 32 bits.
#[test]
fn lines_and_programs_have_numbers() {
    let block = |line: &str| Block::parse(line.as_bytes(), &Dialect::ISO).expect("a block");
    assert_eq!(block("O1234").program_number(), Some(1234));
    assert_eq!(block("N5 O1234").line_number(), Some(5));
    assert_eq!(block("N5").program_number(), None);
    assert_eq!(block("N5 G0 X1").line_number(), Some(5));
    assert_eq!(block("G0 X1").line_number(), None);
}

/// Blocks that are only moves take a shorter code path, which they must not take with other words.
/// A `G94` that is already in effect sends every block along the long path and changes nothing.
#[test]
fn the_short_way_of_moves_is_the_same() {
    let beside = [
        "", "F5", "S100", "T3", "N9", "G90", "G91", "G20", "M3", "M8", "G54", "G55", "G43.1 Z1",
        "M6", "P2", "D1", "H1", "E1", "Q1", "L2", "U1", "A1", "G4", "G28", "G92", "G93", "M2",
        "G18", "G40", "G61", "G98",
    ];
    let moves = [
        "",
        "X1",
        "G0 X1",
        "G1 X1 Y2",
        "G2 X2 I1",
        "G3 X2 R1",
        "G5 X1 I1 J1 P1 Q1",
        "G33 Z1 K1",
        "G81 X1 Z-1 R1",
        "G80",
        "G38.2 X5",
    ];
    for first in [
        "G0 X0 F100",
        "G1 X1 F100",
        "G81 X3 Z-2 R1 F100",
        "G2 X1 I0.5 F100",
        "G80",
    ] {
        for (beside, path) in beside
            .iter()
            .flat_map(|beside| moves.map(|path| (beside, path)))
        {
            let mut one = Modal::<3>::new(Dialect::RS274);
            let Ok(block) = Block::parse(first.as_bytes(), &Dialect::RS274) else {
                continue; // a cycle, where the crate is built without them
            };
            let mut commands = Commands::new();
            one.apply(&block, &mut commands).expect("a plan");
            commands.clear();
            let mut other = one.clone();
            let line = format!("{path} {beside}");
            let parse = |line: &str| Block::parse(line.as_bytes(), &Dialect::RS274);
            let (Ok(short), Ok(long)) = (parse(&line), parse(&format!("{line} G94"))) else {
                continue;
            };
            let applied = one.apply(&short, &mut commands);
            let applied = applied.map(|()| commands.by_ref().collect::<Vec<Command<3>>>());
            let expected = other.apply(&long, &mut commands);
            assert_eq!(
                applied,
                expected.map(|()| commands.by_ref().collect()),
                "{first}, then {line}"
            );
            assert!(one == other, "{first}, then {line}");
        }
    }
}

/// Where letters U and W are known only from contours, a move does not have them.
#[test]
fn moves_of_lathes_have_no_increments() {
    let modal = Modal::<3>::new(Dialect::LATHE);
    for (line, letter) in [("G0 U1", b'U'), ("G1 X1 W2 F1", b'W')] {
        let error = Block::parse(line.as_bytes(), &Dialect::LATHE)
            .and_then(|block| modal.plan(&block).map(|_| ()))
            .expect_err(line);
        assert_eq!(error.kind, ErrorKind::UnknownWord(letter), "{line}");
    }
}

/// `P` is negative where it is a coordinate, in splines, and nowhere else.
#[test]
fn negative_p() {
    let parse = |line: &str| {
        let block = Block::parse(line.as_bytes(), &Dialect::RS274);
        block.map(|_| ()).map_err(|error| error.kind)
    };
    for line in ["G2 X2 I1 P-1 F1", "G0 P-2"] {
        assert_eq!(parse(line), Err(ErrorKind::Negative(b'P')), "{line}");
    }
    assert_eq!(parse("X2 I1 P-1"), Ok(()));
    #[cfg(feature = "extended")]
    assert_eq!(parse("G5 X2 I1 J1 P-1 Q1"), Ok(()));
}

/// A block is empty when it has no code and no word except N; a preceding slash does not matter.
#[test]
fn blocks_that_ask_for_nothing() {
    let dialect = Dialect::RS274.with_block_delete(false);
    for (line, is_empty, is_deleted) in [
        ("", true, false),
        ("N5", true, false),
        ("(note)", true, false),
        ("G0", false, false),
        ("M3", false, false),
        ("N5 M3", false, false),
        ("X1", false, false),
        ("N5 X1", false, false),
        ("/", true, true),
        ("/N5", true, true),
        ("/X1", false, true),
    ] {
        let block = Block::parse(line.as_bytes(), &dialect).expect("a block");
        assert_eq!(block.is_empty(), is_empty, "{line}");
        assert_eq!(block.is_deleted(), is_deleted, "{line}");
    }
}

/// All the letters that need a code, without a code: the first of them is refused.
#[test]
fn all_letters_without_a_code() {
    let line = "I1 J1 K1 R1 P1 D1 E1 H1 L1 Q1";
    let error = Block::parse(line.as_bytes(), &Dialect::RS274)
        .and_then(|block| Modal::<3>::new(Dialect::RS274).plan(&block).map(|_| ()))
        .expect_err("unused words");
    assert_eq!(
        (error.kind, error.at, error.end),
        (ErrorKind::UnusedWord(b'I'), 0, 2)
    );
}

/// Columns of the words at fault: of the first one in the line, whatever its letter, or of all of
/// them.
#[test]
fn places_of_words_at_fault() {
    fn place(line: &str) -> Option<&str> {
        let planned = Block::parse(line.as_bytes(), &Dialect::RS274)
            .and_then(|block| Modal::<3>::new(Dialect::RS274).plan(&block));
        planned.err().map(|error| &line[error.at..error.end])
    }
    assert_eq!(place("G80 X1 Y2"), Some("X1 Y2"));
    assert_eq!(place("G80 Y2 X1"), Some("Y2 X1"));
    assert_eq!(place("G80 Z3 Y2 X1 F1"), Some("Z3 Y2 X1"));
    assert_eq!(place("G2 X1 Y1 F1 J1 K1 I1"), Some("K1"));
    assert_eq!(place("G2 X9 F1 J1 I1"), Some("X9"));
    assert_eq!(place("G38.2 Y0 X0 F1"), Some("Y0 X0"));
}

/// Increments are moves of their axes where they are known, and words of contour cycles.
#[cfg(feature = "extended")]
#[test]
fn increments() {
    let plan = |dialect: Dialect, lines: &[&str]| {
        let mut modal = Modal::<3>::new(dialect);
        for line in lines {
            let block = Block::parse(line.as_bytes(), &dialect).map_err(|error| error.kind)?;
            modal = modal.plan(&block).map_err(|error| error.kind)?.0;
        }
        Ok(modal.position().map(|nm| nm.0))
    };
    let ends = plan(Dialect::LATHE_A, &["G0 X1 Z1", "U2 W3"]);
    assert_eq!(ends, Ok([1_500_000, 0, 4_000_000]));
    assert_eq!(
        plan(Dialect::LATHE, &["G0 U1"]),
        Err(ErrorKind::UnknownWord(b'U'))
    );
    let cycle = plan(Dialect::LATHE, &["F1 G71 P1 Q2 D1 U1"]);
    assert_eq!(cycle, Err(ErrorKind::ContourOfBlocks));
}

/// In a line without a code, the first word gives the columns of an error of the motion.
#[test]
fn places_of_motions_without_a_code() {
    fn place(line: &str) -> Option<&str> {
        let mut modal = Modal::<3>::new(Dialect::RS274);
        let block = Block::parse(b"G1", &Dialect::RS274).expect("a block");
        modal = modal.plan(&block).expect("a plan").0;
        let planned =
            Block::parse(line.as_bytes(), &Dialect::RS274).and_then(|block| modal.plan(&block));
        planned.err().map(|error| &line[error.at..error.end])
    }
    assert_eq!(place("Y2 X1"), Some("Y2"));
    assert_eq!(place("X1 Y2"), Some("X1"));
    assert_eq!(place("Z1 X1 Y2"), Some("Z1"));
    assert_eq!(place("Y2 Z1 X1"), Some("Y2"));
}

/// The dialects of mills differ in the text around words; they have the same codes, except those
/// that need a whole program and those that printers use in another way.
#[test]
fn mills_have_the_same_codes() {
    let mut known = 0;
    for line in ["G", "M"].into_iter().flat_map(|letter| {
        (0..1_000).map(move |tenths| format!("{letter}{}.{} P1 L2", tenths / 10, tenths % 10))
    }) {
        let [first, others @ ..] = [Dialect::RS274, Dialect::ISO, Dialect::PRINTER]
            .map(|dialect| Block::parse(line.as_bytes(), &dialect).map_err(|error| error.kind));
        known += usize::from(first.is_ok());
        let is_flow = ["M70.0", "M71.0", "M72.0", "M73.0", "M98.0", "M99.0"];
        // Retraction, levelling and parking, the motors, files, progress, and the extruder.
        let is_own = [
            "G11.0", "G12.0", "G26.0", "G27.0", "G29.0", "G34.0", "M18.0", "M20.0", "M21.0",
            "M31.0", "M73.0", "M75.0", "M76.0", "M77.0", "M78.0", "M82.0", "M83.0", "M84.0",
        ];
        let is_own = cfg!(feature = "extended") && is_own.iter().any(|code| line.starts_with(code));
        let is_flow = is_flow.iter().any(|code| line.starts_with(code));
        for (other, is_printer) in others.into_iter().zip([false, true]) {
            if is_printer && is_own {
                assert!(other.is_ok(), "{line}");
                continue;
            }
            let expected = first.is_ok() && !(is_printer && is_flow);
            assert_eq!(expected, other.is_ok(), "{line}");
        }
    }
    assert!(known > 30, "{known}");
}

/// Commands of a block that were not taken are not lost silently: the next block is refused without
/// effect, and they are still pending.
#[test]
fn commands_that_wait_are_not_lost() {
    let dialect = Dialect::RS274;
    let mut modal = Modal::<3>::new(dialect);
    let mut commands = Commands::new();
    let block = |line: &str| Block::parse(line.as_bytes(), &dialect).expect("a block");
    modal
        .apply(&block("M3 S100 G0 X1"), &mut commands)
        .expect("a plan");
    let before = modal.clone();
    for _ in 0..2 {
        let refused = modal
            .apply(&block("G0 X2"), &mut commands)
            .expect_err("they wait");
        assert_eq!(refused.kind, ErrorKind::CommandsWaiting);
        assert!(modal == before && !commands.is_empty());
    }
    assert_eq!(commands.by_ref().count(), 2, "spindle and rapid");
    assert!(commands.is_empty());
    modal.apply(&block("G0 X2"), &mut commands).expect("a plan");
    commands.clear();
    modal
        .apply(&block("G0 X3"), &mut commands)
        .expect("dropped on purpose");
    let last: Vec<_> = commands.map(|command| command.to_string()).collect();
    assert_eq!(last, ["rapid X3 Y0 Z0"]);
}

/// What programs of CAM systems have: a zero offset aside of the plane, Mach3's units, and the
/// number of the program.
#[cfg(feature = "extended")]
#[test]
fn habits_of_cam_systems_are_taken() {
    let takes = |line: &str| {
        let block = Block::parse(line.as_bytes(), &Dialect::RS274)?;
        Modal::<3>::new(Dialect::RS274)
            .plan(&block)
            .map(|(next, _)| next)
    };
    let end = |line: &str| takes(line).unwrap().position().map(|nm| nm.0);
    assert_eq!(end("G21 G2 X2 I1 K0.000 F9"), [2_000_000, 0, 0]);
    assert_eq!(end("G18 G2 X2 I1 J0 F9"), [2_000_000, 0, 0]);
    assert!(matches!(
        takes("G2 X2 I1 K1 F9").err().unwrap().kind,
        ErrorKind::UnusedWord(b'K')
    ));
    assert_eq!(end("G70 G0 X1"), [25_400_000, 0, 0]);
    assert_eq!(end("G71 G0 X1"), [1_000_000, 0, 0]);
    let program = Block::parse(b"O0001(BRACKET)", &Dialect::RS274).unwrap();
    assert_eq!(program.program_number(), Some(1));
    assert!(takes("O1 G0 X1").is_err());
}
