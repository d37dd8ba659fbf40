//! Subprograms (M98, M99), saved modes (M70 to M73), and subroutines in files of their own.
#![cfg(all(feature = "program", feature = "extended"))]

use husillo_gcode::parameters::{File, Library, Program};
use husillo_gcode::{Command, Dialect, Modal};

/// The folder of a test: names and texts.
#[derive(Debug)]
struct Folder(&'static [(&'static str, &'static str)]);

impl Library for Folder {
    fn file<'t>(&'t self, name: &[u8]) -> Option<File<'t>> {
        let (name, text) = self.0.iter().find(|(known, _)| known.as_bytes() == name)?;
        Some(File {
            name: name.as_bytes(),
            text: text.as_bytes(),
        })
    }
}

/// `line: command` of a program in the order of execution, and its first error.
fn run_with(dialect: Dialect, text: &str, folder: &Folder) -> Vec<String> {
    let mut program: Program = Program::new(text.as_bytes(), dialect).with_library(folder);
    let mut modal = Modal::<3>::new(dialect);
    let mut printed = Vec::new();
    while let Some(line) = program.next_line(&modal) {
        let file = line.file.map(|name| String::from_utf8_lossy(name) + ":");
        let place = format!("{}{}", file.unwrap_or_default(), line.number);
        match line.block.and_then(|block| modal.plan(&block)) {
            Ok((next, commands)) => {
                modal = next;
                for command in commands {
                    printed.push(format!("{place}: {command}"));
                    if matches!(command, Command::End { .. }) {
                        return printed;
                    }
                }
            }
            Err(error) => {
                let (code, at, end) = (error.kind.code(), error.at, error.end);
                printed.push(format!("{place}: E{code:04} {at}-{end}"));
                return printed;
            }
        }
    }
    printed
}

fn run(text: &str) -> Vec<String> {
    run_with(Dialect::RS274, text, &Folder(&[]))
}

#[test]
fn subprograms_are_called_and_repeated() {
    // Two rounds of two rounds; the parameters are those of the caller.
    let text = "#1=1\nM98 P2 L2\nG0 Z#1\nM30\nO2 (outer)\nM98 P0001 L2\n#1=[#1*10]\nM99\n\
        N1 O1 ; inner\nG91 G0 X#1\nM99";
    let wanted = [
        "10: rapid X1 Y0 Z0",
        "10: rapid X2 Y0 Z0",
        "10: rapid X12 Y0 Z0",
        "10: rapid X22 Y0 Z0",
        "3: rapid X22 Y0 Z100",
        "4: end rewind",
    ];
    assert_eq!(run(text), wanted);
    // L0 calls nothing; the other words of the line come first.
    let text = "M98 P1 L0\nG0 X1 M98 P1\nM2\nO1\nY1\nM99";
    assert_eq!(
        run(text),
        ["2: rapid X1 Y0 Z0", "5: rapid X1 Y1 Z0", "3: end"]
    );
    // The number of times is in P.
    let text = "G91 G0 X1\nM98 P30007\nM2\nO7\nX1\nM99";
    let three = run_with(Dialect::ISO, text, &Folder(&[]));
    assert_eq!(three.len(), 5, "{three:?}");
    assert_eq!(run(text), ["1: rapid X1 Y0 Z0", "2: E0633 0-3"]);
}

#[test]
fn the_end_of_a_subprogram() {
    // In the main program M99 ends it; a subprogram may return elsewhere.
    assert_eq!(run("G0 X1\nM99\nX2"), ["1: rapid X1 Y0 Z0", "2: end"]);
    let text = "M98 P1\nG0 X1\nN9 X2\nM2\nO1\nM99 P9";
    assert_eq!(run(text), ["3: E0206 3-5"]);
    let text = "G0 X0\nM98 P1\nX1\nN9 X2\nM2\nO1\nM99 P9";
    assert_eq!(
        run(text),
        ["1: rapid X0 Y0 Z0", "4: rapid X2 Y0 Z0", "5: end"]
    );
    for (text, error) in [
        ("M98", "1: E0213 0-3"),
        ("M98 P5", "1: E0633 0-3"),
        ("M98 P1.5", "1: E0505 4-8"),
        ("M98 P1\nM2\nO1\nM99 P7", "4: E0643 0-3"),
        ("M98 P1\nM2\nO1\nG0", "3: E0634 0-2"),
        ("o1 sub\nM99\no1 endsub\no1 call", "2: E0636 0-3"),
        ("M98 P1\nM2\nO1\no1 endsub", "4: E0634 0-9"),
        ("o1 call\nM2\nO1\nM99", "1: E0633 0-7"),
        ("M98 P1\nO1\nM98 P1\nM99", "3: E0637 0-3"),
    ] {
        assert_eq!(run(text), [error], "{text}");
    }
    assert_eq!(
        run_with(Dialect::GRBL, "M98 P1", &Folder(&[])),
        ["1: E0212 0-3"]
    );
}

#[test]
fn modes_come_back() {
    let text = "G21 F200 S2500 M3\nG64 P0.1\no1 call\nG1 X1 Y1\nM2\n\
        o1 sub\nM73\nG20 G91 G18 F5 S300 M8 M4 G55 G61 G99 G90.1\nG95 F0.1\nG43.1 Z1\nG1 X0.1\n\
        o1 return\no1 endsub";
    let made = run(text);
    assert_eq!(
        made[2..],
        [
            "8: spindle ccw 300 rpm",
            "8: coolant flood",
            "8: path exact",
            "10: tool length 0 X0 Y0 Z25.4",
            "11: linear X2.54 Y0 Z0 F2.54/rev",
            "12: spindle cw 2500 rpm",
            "12: coolant off",
            "12: tool length 0 X0 Y0 Z0",
            "12: path blend 0.1",
            "4: linear X1 Y1 Z0 F200",
            "5: end",
        ][..],
        "{made:#?}"
    );
    // M70 and M72 in the main program; M71 forgets; each subroutine has its own.
    let text = "G20\nM70\nG21\nM72\nG0 X1\nG21\no1 call\nX1\nM72\nX2\nM71\nM72\n\
        o1 sub\nG20\nM73\nG21\nM71\no1 endsub";
    let wanted = [
        "5: rapid X25.4 Y0 Z0",
        "8: rapid X1 Y0 Z0",
        "10: rapid X50.8 Y0 Z0",
        "12: E0641 0-3",
    ];
    assert_eq!(run(text), wanted);
    // Coolants, in all combinations.
    for before in 0..4 {
        for after in 0..4 {
            let codes = |set: u8| match set {
                0 => "M9",
                1 => "M9\nM7",
                2 => "M9\nM8",
                _ => "M7 \nM8",
            };
            let text = format!("{}\nM70\n{}\nM72\n", codes(before), codes(after));
            let mut program: Program = Program::new(text.as_bytes(), Dialect::RS274);
            let mut modal = Modal::<3>::new(Dialect::RS274);
            while let Some(line) = program.next_line(&modal) {
                modal = modal.plan(&line.block.unwrap()).unwrap().0;
            }
            assert_eq!(
                modal.coolant(),
                (before & 1 != 0, before & 2 != 0),
                "{text}"
            );
        }
    }
}

#[test]
fn subroutines_in_files() {
    let folder = Folder(&[
        (
            "slot",
            "(a slot)\no<help> sub\nG0 Z#1\no<help> endsub\no<slot> sub\n\
            o<help> call [#1 + 1]\no<deep> call\no<slot> endsub",
        ),
        ("deep", "o<deep> sub\no<main> call\nM98 P40\no<deep> endsub"),
        ("40", "O40\nG0 Y4\nM99"),
        ("broken", "o<other> sub\no<other> endsub"),
        ("open", "o<open> sub\nG0 X9"),
    ]);
    let run = |text| run_with(Dialect::RS274, text, &folder);
    let text = "o<main> sub\nG0 X7\no<main> endsub\no<slot> call [2]\nM98 P40\nM2";
    let wanted = [
        "slot:3: rapid X0 Y0 Z3",
        "2: rapid X7 Y0 Z3",
        "40:2: rapid X7 Y4 Z3",
        "40:2: rapid X7 Y4 Z3",
        "6: end",
    ];
    assert_eq!(run(text), wanted);
    assert_eq!(run("o<broken> call"), ["1: E0633 0-14"]);
    assert_eq!(run("o<none> call"), ["1: E0633 0-12"]);
    assert_eq!(
        run("o<open> call"),
        ["open:2: rapid X9 Y0 Z0", "open:1: E0634 0-11"]
    );
    // A subroutine of the text comes first.
    let text = "o<deep> sub\no<deep> endsub\no<deep> call\nM2";
    assert_eq!(run(text), ["4: end"]);
}

/// More files than there is room for.
#[test]
fn the_number_of_files_is_bounded() {
    let folder = Folder(&[("1", "o1 sub\no1 endsub"), ("2", "o2 sub\no2 endsub")]);
    let text = b"o1 call\no2 call\nG0 X1";
    let mut program: Program<'_, 8, 8, 4, 1> =
        Program::new(text, Dialect::RS274).with_library(&folder);
    let modal = Modal::<3>::new(Dialect::RS274);
    let mut codes = Vec::new();
    while let Some(line) = program.next_line(&modal) {
        codes.extend(
            line.block
                .err()
                .map(|error| (line.number, error.kind.code())),
        );
    }
    assert_eq!(codes, [(2, 642)]);
}

/// A call that is refused makes no assignment of its line; one that is made does.
#[test]
fn a_refused_call_assigns_nothing() {
    for (line, value) in [
        ("M98 P2 #1=2", 2),
        ("M98 L2 #1=2", 0),
        ("M98 P7 #1=2", 0),
        ("#1=2 M98 P2.5", 0),
    ] {
        let text = format!("{line}\nM30\nO2\nM99\n");
        let mut program: Program = Program::new(text.as_bytes(), Dialect::RS274);
        let read = program.next_line(&Modal::<3>::new(Dialect::RS274));
        let is_made = read.is_some_and(|line| line.block.is_ok());
        assert_eq!(is_made, value != 0, "{line}");
        assert_eq!(program.parameter(1).digits(), value, "{line}");
    }
}
