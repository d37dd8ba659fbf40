//! `husillo compile` for the micro mill: the strings, the notes, and the simulated path, which is
//! that of the program.

use assert_cmd::Command;
use std::fs;
use std::path::PathBuf;

fn husillo() -> Command {
    Command::cargo_bin("husillo").expect("the program")
}

/// A file of this test's own.
fn file(name: &str, text: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("micromill");
    fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(name);
    fs::write(&path, text).expect("a file");
    path
}

/// The strings of a program, and its notes.
fn compiled(name: &str, text: &str) -> (String, String) {
    let output = husillo()
        .args(["compile", "-m", "micromill"])
        .arg(file(name, text))
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{output:?}");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (text(output.stdout), text(output.stderr))
}

/// Step events as CSV.
fn steps(name: &str, text: &str) -> String {
    let output = husillo()
        .args(["steps", "-o", "-"])
        .arg(file(name, text))
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).expect("text")
}

#[test]
fn units_increments_centres_radii_and_feeds() {
    let program = "G21 G91\nG0 X1 Y0.5\nG1 Z-0.1 F1.25\nG2 X0.2 Y0 I0.1 J0 F0.8\nG90 G20\nG3 X0.04 \
         Y0.03 R0.02 F0.03\nM8\nM30\n";
    let (strings, told) = compiled("words.nc", program);
    let lines: Vec<&str> = strings.lines().collect();
    assert_eq!(
        lines[..3],
        [
            "G00X01000.00Y00500.00;",
            "G01Z-00100.00F13;",
            "G02X01200.00Y00500.00I01100.00J00500.00F08;"
        ]
    );
    assert!(lines[3].starts_with("G03X01016.00Y00762.00I"), "{strings}");
    assert_eq!(lines[4..], ["M30;"]);
    assert!(told.contains("words.nc:3: F1.25 becomes F1.3"), "{told}");
    assert!(told.contains("words.nc:7: dropped:"), "{told}");
}

/// What the mill can do itself is made with the very same steps, where centres are whole tens of
/// nanometres as its words are.
#[test]
fn the_path_of_flat_programs_is_equal() {
    let program = "G21 G90\nG0 X1 Y1\nG1 X1.2345671 Y0.7777777 F1.1\nG1 X1.23456 Y0.77777\nG3 \
         X1.23456 Y0.77777 I-0.1 J0.05\nG0 Z0.2\nG0 X0 Y0\nM30\n";
    let (strings, _) = compiled("flat.nc", program);
    let deltas = |csv: &str| -> Vec<String> {
        let rows = csv.lines().skip(1);
        let rows = rows.map(|row| row.splitn(3, ',').nth(2).unwrap_or_default().to_owned());
        rows.filter(|row| row != "0,0,0").collect()
    };
    let ours = deltas(&steps("flat.mm", &strings));
    let theirs = deltas(&steps("same.nc", program));
    assert_eq!(ours.len(), theirs.len());
    assert!(ours == theirs, "the steps are not the same");
}

/// A slope and a helix end where they should, and Z is never half a step and a part off.
#[test]
fn slopes_and_helices_are_flattened() {
    let program =
        "G21 G90\nG0 X0.5 Y0.5\nG1 X0.6 Y0.55 Z-0.01 F1\nG2 X0.7 Y0.45 Z-0.02 I0 J-0.1 F1\nM30\n";
    let (strings, told) = compiled("slope.nc", program);
    assert!(told.contains("slope.nc:3: Z moves apart"), "{told}");
    let mut at = [0_i32; 3];
    let mut worst = 0.0_f64;
    for row in steps("slope.mm", &strings).lines().skip(1) {
        let deltas = row.split(',').skip(2);
        for (at, delta) in at.iter_mut().zip(deltas) {
            *at += delta.parse::<i32>().expect("a delta");
        }
    }
    // Motors: the backlash of X and Y is in them where they turned round.
    assert_eq!(at[2], -143, "0.02 mm in steps of 140 nm");
    // The slope, from the strings: each corner against the line.
    let mut place = [500.0_f64, 500.0, 0.0];
    for string in strings
        .lines()
        .skip(1)
        .take_while(|string| !string.starts_with("G02"))
    {
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if let Some((_, word)) = string.split_once(letter) {
                let end = word.find(|c: char| c.is_ascii_uppercase() || c == ';');
                place[axis] = word[..end.expect("an end")].parse().expect("a number");
            }
        }
        let along = (place[0] - 500.0) / 100.0;
        worst = worst.max((place[2] + 10.0 * along).abs());
    }
    assert!(worst < 0.08, "{worst} um");
}

#[test]
fn what_the_mill_cannot_do_is_an_error() {
    let program = "G21 G90\nG0 X200\nM30\n";
    husillo()
        .args(["compile", "-m", "micromill"])
        .arg(file("far.nc", program))
        .assert()
        .code(1);
}

#[test]
fn a_simulated_mill_makes_each_step() {
    husillo()
        .args(["send", "-m", "micromill"])
        .arg(file("near.nc", "G21 G90\nG0 X1\nM30\n"))
        .assert()
        .success()
        .stdout(predicates::str::contains("7,143, each as in the simulator"));
}

#[test]
fn a_program_without_a_command_is_neither_sent_nor_compiled() {
    for (name, text) in [("none.nc", "(only a comment)\n"), ("empty.nc", "")] {
        for command in ["send", "compile"] {
            husillo()
                .args([command, "-m", "micromill"])
                .arg(file(name, text))
                .assert()
                .code(2)
                .stdout("")
                .stderr(predicates::str::contains("no command for the mill"));
        }
    }
}

/// Each string waits for Enter; `q` ends the program before the next one.
#[test]
fn a_single_block_waits_for_the_operator() {
    let send = |answers: &str| {
        let output = husillo()
            .args(["send", "-m", "micromill", "--single-block"])
            .arg(file("single.mm", "G00X00001.00;\nG00X00002.00;\nM30;\n"))
            .write_stdin(answers)
            .output()
            .expect("it runs");
        let text = |bytes| String::from_utf8(bytes).expect("text");
        let texts = (text(output.stdout), text(output.stderr));
        (output.status.success(), texts.0, texts.1)
    };
    let (is_well, out, told) = send("\n\n\n");
    assert!(is_well, "{told}");
    assert!(out.contains("3 made"), "{out}");
    for string in ["G00X00001.00Y00000.00;", "G00X00002.00Y00000.00;", "M30;"] {
        assert!(
            told.contains(&format!("{string} Enter sends it (or q to end)")),
            "{told}"
        );
    }
    let (is_well, _, told) = send("\nq\n");
    assert!(!is_well);
    assert!(
        told.contains("line 2: stopped before G00X00002.00Y00000.00;"),
        "{told}"
    );
    // The end of the input is no consent.
    let (is_well, _, told) = send("");
    assert!(!is_well);
    assert!(
        told.contains("line 1: stopped before G00X00001.00Y00000.00;"),
        "{told}"
    );
}
