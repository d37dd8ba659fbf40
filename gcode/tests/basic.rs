//! Without the extended codes the list is that of Grbl in any dialect; the other codes are known
//! and refused.
#![cfg(not(feature = "extended"))]

use husillo_gcode::{Block, Commands, Dialect, ErrorKind, Modal};

/// The commands of a program, or the kind of its first error.
fn run(dialect: Dialect, lines: &[&str]) -> Result<Vec<String>, ErrorKind> {
    let mut modal = Modal::<3>::new(dialect);
    let mut commands = Commands::new();
    let mut printed = Vec::new();
    for line in lines {
        let block = Block::parse(line.as_bytes(), &dialect).map_err(|error| error.kind)?;
        modal
            .apply(&block, &mut commands)
            .map_err(|error| error.kind)?;
        printed.extend(commands.by_ref().map(|command| command.to_string()));
    }
    Ok(printed)
}

#[test]
fn the_list_of_grbl_is_there() {
    let lines = [
        "G21 G90 G17 G54 F120 M3 S1000",
        "G10 L20 P2 X1",
        "G55 G1 X2.5 Y-1",
        "G2 X3.5 I0.5",
        "G38.2 Z-1",
        "G28 Z0",
        "G4 P0.5",
        "M2",
    ];
    for dialect in [Dialect::RS274, Dialect::GRBL] {
        assert_eq!(
            run(dialect, &lines).unwrap(),
            [
                "spindle cw 1000 rpm",
                "linear X1.5 Y-1 Z0 F120",
                "arc cw xy X2.5 Y-1 Z0 centre X2 Y-1 Z0 F120",
                "probe X2.5 Y-1 Z-1 F120",
                "rapid X2.5 Y-1 Z0",
                "rapid X2.5 Y-1 Z0",
                "dwell 0.5 s",
                "end",
            ]
        );
    }
}

#[test]
fn the_other_codes_are_known_and_refused() {
    for (line, letter, tenths) in [
        ("G81 X1 Z-1 R1", b'G', 810),
        ("G41 D1", b'G', 410),
        ("G5.1 X1 I1", b'G', 51),
        ("G33 Z-1 K1", b'G', 330),
        ("G64 P0.1", b'G', 640),
        ("M62 P1", b'M', 620),
        ("G96 S100", b'G', 960),
    ] {
        assert_eq!(
            run(Dialect::RS274, &[line]),
            Err(ErrorKind::NotOfDialect(letter, tenths)),
            "{line}"
        );
    }
    assert_eq!(
        run(Dialect::RS274, &["G299"]),
        Err(ErrorKind::UnknownCode(b'G', Some(2990)))
    );
}

/// No dialect has a code that Grbl does not have, except M6 of the micro mill.
#[test]
fn nothing_beyond_grbl_is_taken() {
    for line in ["G", "M"].into_iter().flat_map(|letter| {
        (0..1_000).map(move |tenths| format!("{letter}{}.{} P1", tenths / 10, tenths % 10))
    }) {
        let [all, grbl] = [Dialect::RS274, Dialect::GRBL]
            .map(|dialect| Block::parse(line.as_bytes(), &dialect).is_ok());
        assert!(grbl || !all || line.starts_with("M6.0"), "{line}");
    }
}
