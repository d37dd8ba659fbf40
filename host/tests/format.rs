//! `husillo format` as a user calls it, and the fixes that `husillo check` offers.

mod common;

use common::husillo;
use predicates::prelude::*;
use predicates::str::{contains, is_empty};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// A file of its own for each test.
fn scratch(name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("format");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    path
}

const UNTIDY: &[u8] = b"%\r\nn10g01x+01.50y-.5(Cut; \xe9)f 1 00\r\n  #1=[ 2 ]\r\no1 while [#1 gt \
     0]\r\n/g0z5. ; up  \r\n\
m30\r\nany text, 1 2 3";

const TIDY: &[u8] =
    b"%\nN10 G1 X1.50 Y-0.5 (Cut; \xe9) F100\n  #1=[ 2 ]\no1 while [#1 gt 0]\n/G0 Z5. ; up  \n\
M30\nany text, 1 2 3\n";

#[test]
fn a_program_in_its_form() {
    let program = scratch("untidy.nc", UNTIDY);
    husillo()
        .arg("format")
        .arg(&program)
        .assert()
        .success()
        .stdout(TIDY)
        .stderr(is_empty());
    husillo()
        .args(["format", "-"])
        .write_stdin(TIDY)
        .assert()
        .success()
        .stdout(TIDY);
    husillo()
        .args(["format", "--crlf", "-"])
        .write_stdin(&b"g0\nm2\n"[..])
        .assert()
        .success()
        .stdout("G0\r\nM2\r\n");
    husillo()
        .args(["format", "--dialect", "micromill", "-"])
        .write_stdin(&b"G90; g00 x02650.00;\n"[..])
        .assert()
        .success()
        .stdout("G90;G00X02650.00;\n");
}

#[test]
fn a_program_can_be_its_own_output() {
    let program = scratch("own.nc", UNTIDY);
    for _ in 0..2 {
        husillo()
            .arg("format")
            .arg(&program)
            .arg("-o")
            .arg(&program)
            .assert()
            .success()
            .stdout(is_empty());
        assert_eq!(fs::read(&program).unwrap(), TIDY);
    }
    let beside: Vec<_> = fs::read_dir(program.parent().unwrap())
        .unwrap()
        .filter(|entry| {
            let name = entry.as_ref().unwrap().file_name();
            name.to_string_lossy().starts_with("own.nc.")
        })
        .collect();
    assert!(beside.is_empty(), "{beside:?}");
}

#[test]
fn check_names_what_would_change() {
    let untidy = scratch("check_untidy.nc", UNTIDY);
    let tidy = scratch("check_tidy.nc", TIDY);
    let faulty = scratch("check_faulty.nc", "G1 X1.2.3\n");
    husillo()
        .args(["format", "--check"])
        .args([&untidy, &tidy])
        .assert()
        .code(1)
        .stdout(format!("{}: would change\n", untidy.display()));
    assert_eq!(fs::read(&untidy).unwrap(), UNTIDY);
    husillo()
        .args(["format", "--check"])
        .arg(&tidy)
        .assert()
        .success()
        .stdout(is_empty());
    husillo()
        .args(["format", "--check"])
        .arg(&faulty)
        .assert()
        .code(1)
        .stdout(is_empty())
        .stderr(contains("E0102"));
}

#[test]
fn lines_with_errors_stay_as_they_are() {
    let long = [b"g1 (".to_vec(), vec![b'x'; 300_000], b")".to_vec()].concat();
    let lines: [&[u8]; 5] = [
        b"g1  x1.2.3",
        b"n3 g1 x1*98",
        b"\xff g1",
        b"M117  h 1",
        &long,
    ];
    let mut program = lines.join(&b'\n');
    program.extend_from_slice(b"\ng0 x1\n");
    let mut expected = lines.join(&b'\n');
    expected.extend_from_slice(b"\nG0 X1\n");
    husillo()
        .args(["format", "-"])
        .write_stdin(program)
        .assert()
        .code(1)
        .stdout(expected)
        .stderr(contains("<input>:1:9").and(contains("5 errors")));
}

#[test]
fn wrong_usage_ends_with_two() {
    let program = scratch("usage.nc", "G0\n");
    let program = program.to_str().unwrap();
    for args in [
        &["format"][..],
        &["format", "no-such-file.nc"],
        &["format", "."],
        &["format", program, program],
        &["format", program, "--check", "-o", "x.nc"],
        &["format", program, "--dialect", "latin"],
        &["format", "board.drl"],
    ] {
        husillo().args(args).assert().code(2).stdout(is_empty());
    }
}

fn findings(program: &Path) -> Vec<Value> {
    let output = husillo()
        .args(["check", "--format", "json", "--limit", "1000"])
        .arg(program)
        .output()
        .unwrap();
    common::findings(&output.stdout)
}

/// Makes the change of a fix: line and columns count characters from 1.
fn apply(program: &str, fix: &Value) -> String {
    let number = |key: &str| fix[key].as_u64().unwrap() as usize - 1;
    let mut lines: Vec<String> = program.split('\n').map(str::to_owned).collect();
    let line: Vec<char> = lines[number("line")].chars().collect();
    let (from, to) = (number("column"), number("end"));
    let part = |part: &[char]| part.iter().collect::<String>();
    let text = fix["text"].as_str().unwrap();
    lines[number("line")] = part(&line[..from]) + text + &part(&line[to..]);
    lines.join("\n")
}

/// Whether a finding of this code is at this line, and at this column or before it: the position
/// that it has if it is the same.
fn is_there(findings: &[Value], code: &Value, line: &Value, column: u64) -> bool {
    findings.iter().any(|finding| {
        finding["code"] == *code
            && finding["line"] == *line
            && finding["column"].as_u64().unwrap_or(0) <= column
    })
}

/// Applies every fix of a program one by one, and checks that its error is gone. Returns the number
/// of fixes.
fn assert_fixes_help(name: &str, program: &str) -> usize {
    let mut fixes = 0;
    let path = scratch(name, program);
    let found = findings(&path);
    let errors = found.iter().filter(|f| f["severity"] == "error").count();
    for finding in &found {
        for fix in finding["fixes"].as_array().unwrap() {
            fixes += 1;
            let fixed = apply(program, fix);
            let path = scratch(&format!("fixed_{name}"), &fixed);
            let after = findings(&path);
            let column = fix["column"]
                .as_u64()
                .unwrap()
                .max(finding["column"].as_u64().unwrap());
            assert!(
                !is_there(&after, &finding["code"], &finding["line"], column - 1),
                "{name}: {finding}\n{fixed}\n{after:#?}"
            );
            let left = after.iter().filter(|f| f["severity"] == "error").count();
            assert!(left <= errors, "{name}: {finding}\n{fixed}\n{after:#?}");
        }
    }
    fixes
}

#[test]
fn every_fix_removes_its_error() {
    let mut fixes = 0;
    for (index, line) in [
        "G1 X1 U0.4 F100",
        "U1",
        "G1 U1X2U3",
        "G1 F100 (\u{e9}\u{4e00}) X1,5 Y2",
        "G1 F100 X1,5 Y2,5",
        "G1 F100 X1 , 5",
        "G1 F100 X1,234.5",
        "G1 F100 X1,2,3",
        "G1 F100 X,5",
        "G1 F100 X1,",
        "G1 F100 X1 K2 Y2",
        "G1 X1 F100 K#<a>",
        "G2 X1 I0.5 K1 F100",
        "G1 F100 X1 (to the end",
        "G1 F100 X1 (to the end \u{e9}  ",
        "G1 F100 (a (b) X1",
        "G0 X1 (",
        "#1=[1] G1 X#1 F100 (never closed",
        "#1=1 G1 F100 X#1 H[#1]",
        "(\u{e9}) G0 X1 D3",
    ]
    .into_iter()
    .enumerate()
    {
        fixes += assert_fixes_help(&format!("fix{index}.nc"), &format!("G21\n{line}\nG0 X0\n"));
    }
    let golden = Path::new("../gcode/tests/golden");
    for folder in ["bad", "flow/bad"] {
        for entry in fs::read_dir(golden.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            // Ten million steps, twice.
            if path.ends_with("steps.ngc") {
                continue;
            }
            let Ok(program) = fs::read_to_string(&path) else {
                continue;
            };
            let name = path.file_name().unwrap().to_str().unwrap();
            fixes += assert_fixes_help(name, &program);
        }
    }
    assert!(fixes >= 20, "{fixes}");
}

#[test]
fn columns_of_a_fix_count_characters_of_any_line() {
    // Latin-1 in a comment: each such byte is drawn as one character.
    let program = scratch("latin1.nc", b"(\xe9\xe9) G0 X1 D2 Y3\n");
    let found = findings(&program);
    let fix = &found[0]["fixes"][0];
    assert_eq!(
        (fix["column"].as_u64(), fix["end"].as_u64()),
        (Some(12), Some(15))
    );
    husillo()
        .arg("check")
        .arg(&program)
        .assert()
        .code(1)
        .stdout(contains("G0 X1 Y3"));
}

/// The commands of a program, with their lines.
fn commands(text: &str) -> String {
    let output = husillo()
        .args(["commands", "--format", "json", "-"])
        .write_stdin(text)
        .output()
        .unwrap();
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_line_ends_with_cr_too() {
    for program in ["G0 X1\nY2\nZ3\n", "G0 X1\n#1=2\nY#1\nZ3\n"] {
        let expected = commands(program);
        // The findings are one more.
        assert_eq!(expected.lines().count(), 4, "{expected}");
        for end in ["\r", "\r\n"] {
            assert_eq!(commands(&program.replace('\n', end)), expected);
        }
    }
    husillo()
        .args(["format", "-"])
        .write_stdin("g0 x1\ry2\r\nz3\r")
        .assert()
        .success()
        .stdout("G0 X1\nY2\nZ3\n");
    let old = scratch("cr.nc", "G0 X1\rY2\r");
    husillo()
        .args(["format", "--check"])
        .arg(&old)
        .assert()
        .code(1)
        .stdout(contains("would change"));
}

#[test]
fn a_byte_order_mark_is_no_part_of_the_first_line() {
    husillo()
        .args(["format", "-"])
        .write_stdin(&b"\xef\xbb\xbfg0 x1\n\xef\xbb\xbfg0\n"[..])
        .assert()
        .code(1)
        .stdout(&b"\xef\xbb\xbfG0 X1\n\xef\xbb\xbfg0\n"[..])
        .stderr(contains("<input>:2:1"));
    husillo()
        .args(["format", "--check", "-"])
        .write_stdin(&b"\xef\xbb\xbfG0 X1\n"[..])
        .assert()
        .success();
    let board = scratch(
        "mark.drl",
        &b"\xef\xbb\xbfM48\nMETRIC,TZ\nT1C0.8\n%\nT1\nX1.0Y2.0\nM30\n"[..],
    );
    husillo()
        .args(["holes", "--format", "json"])
        .arg(&board)
        .assert()
        .success()
        .stdout(contains("[[1,2,0.8]]"));
}

#[test]
fn framed_lines_keep_a_right_checksum() {
    // The sums of `N1 G0 X1`, `n2 g1  x2f60` and `N2 G1 X2 F60`.
    let sum = |text: &str| text.bytes().fold(0, |sum, byte| sum ^ byte);
    let (first, second, formed) = ("N1 G0 X1", "n2 g1  x2f60", "N2 G1 X2 F60");
    husillo()
        .args(["format", "--dialect", "printer", "-"])
        .write_stdin(format!(
            "{first}*{}\n{second}*{}\n",
            sum(first),
            sum(second)
        ))
        .assert()
        .success()
        .stdout(format!(
            "{first}*{}\n{formed}*{}\n",
            sum(first),
            sum(formed)
        ));
}

/// The findings of a program on standard input in a dialect, as JSON and text.
fn told(dialect: &str, program: &str, format: &str) -> String {
    let output = husillo()
        .args(["check", "--format", format, "--dialect", dialect, "-"])
        .write_stdin(program)
        .output()
        .unwrap();
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn no_fix_breaks_a_checksum_or_deletes_motion() {
    let line = "N1 G0 X1 P2";
    let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
    let summed = told("printer", &format!("{line}*{sum}\n"), "json");
    assert!(
        summed.contains("E0208") && summed.contains("\"fixes\":[]"),
        "{summed}"
    );
    let rotary = told("rs274", "G91 G1 A5 F100\n", "text");
    assert!(rotary.contains("this machine has no A axis"), "{rotary}");
    assert!(!rotary.contains("remove the word"), "{rotary}");
}

#[test]
fn others_are_quoted_as_they_are() {
    for (dialect, program, has, lacks) in [
        ("rs274", "M104\n", "Unknown m code used", "Unknown g code"),
        ("grbl", "G43 H1\n", "grbl: `error:20`", "LinuxCNC"),
        (
            "rs274",
            "F1 G2 X1 I0 J0\n",
            "is the start of the arc",
            "needs `I`",
        ),
        (
            "rs274",
            "G1 X1 F0\n",
            "the feed rate is zero",
            "on this line",
        ),
        ("micromill", "G91;\n", "this machine has no", "--dialect"),
        ("drill", "M30\n", "this machine has no", "--dialect"),
        ("rs274", "G0 X#1,5\n", "E0108", "write a point"),
        ("rs274", "G0 X[1,5]\n", "write a point", "bracket"),
    ] {
        let text = told(dialect, program, "text");
        assert!(text.contains(has), "{program}: {text}");
        assert!(!text.contains(lacks), "{program}: {text}");
    }
}

#[test]
fn a_compensated_move_is_reported_at_its_own_line() {
    let program = "G21 F100\nG41.1 D2\nG1 X5 Y0\nX900\nY5\nX5\nG40 X0\n";
    let output = husillo()
        .args(["check", "-m", "router", "--format", "short", "-"])
        .write_stdin(program)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<_> = text
        .lines()
        .filter(|line| line.contains(": error"))
        .collect();
    assert!(lines.iter().any(|line| line.contains(":4:")), "{text}");
    assert_eq!(
        lines.iter().filter(|line| line.contains(":4:")).count(),
        1,
        "{text}"
    );
    let output = husillo()
        .args(["commands", "--format", "json", "-"])
        .write_stdin("G21 F100\nG41.1 D2\nG1 X5 Y0\nZ1\nX9\nG40 Y9\n")
        .output()
        .unwrap();
    let commands = common::objects(&output.stdout);
    let numbers: Vec<_> = (commands.iter())
        .map(|one| one["line"].as_u64().unwrap())
        .collect();
    assert_eq!(numbers, [3, 4, 5, 6], "{commands:?}");
}

#[test]
fn lines_that_grbl_has_no_room_for_are_refused() {
    assert!(told("grbl", &format!("G0 X{}1\n", "0".repeat(76)), "short").contains("E0104"));
    assert!(
        !told(
            "grbl",
            &format!("G0 X{}1 ({})\n", "0".repeat(74), "x".repeat(90)),
            "short"
        )
        .contains("E0104")
    );
}

/// A program for another controller: what it lacks is named, and exit status 1.
#[test]
fn a_program_is_translated() {
    let program = "G20 G90 F10\nG98 G81 X1 Z-.1 R.1\nX2\nG80\nM2\nrubbish\n";
    let cycles = scratch("cycles.nc", program);
    let translate = |file: &Path, to: &str| {
        let mut command = husillo();
        command.args(["format", "--to", to]).arg(file).assert()
    };
    translate(&cycles, "grbl").success().stdout(
        "G20 G90 F10\nG21\nG0 Z2.54\nG0 X25.4\nG1 Z-2.54\nG0 Z2.54\nG0 X50.8\nG1 Z-2.54\n\
         G0 Z2.54\nG80\nM2\n",
    );
    translate(&cycles, "linuxcnc")
        .success()
        .stdout("G20 G90 F10\nG98 G81 X1 Z-0.1 R0.1\nX2\nG80\nM2\n");
    let tools = scratch("tools.nc", "G0 X1\nT3 M6\nX2\nM30\n");
    translate(&tools, "grbl")
        .code(1)
        .stdout("G0 X1\nX2\nM30\n")
        .stderr(contains("tools.nc:2:1").and(contains("E0650")));
    let loops = scratch(
        "loops.nc",
        "o1 repeat [2]\nG91 G0 X1 (step)\no1 endrepeat\nM2\n",
    );
    translate(&loops, "iso")
        .success()
        .stdout("G91 G0 X1 (step)\nG91 G0 X1 (step)\nM2\n");
    husillo()
        .args(["format", "--to", "iso", "--check"])
        .arg(&loops)
        .assert()
        .code(2);
}

/// A machine with these axes after X, Y and Z: rotary ones as A of `router4`, others as its X.
fn machine(letters: &str) -> PathBuf {
    let text = fs::read_to_string("../machines/router4.toml").unwrap();
    let section = |letter: char| {
        let start = text.find(&format!("[axis.{letter}]")).unwrap();
        let length = text[start + 1..].find("\n[").unwrap() + 2;
        text[start..start + length].to_owned()
    };
    let more = letters.chars().map(|letter| {
        let like = if "abc".contains(letter) { 'a' } else { 'x' };
        section(like).replace(&format!("axis.{like}"), &format!("axis.{letter}"))
    });
    let more: String = more.collect();
    let text = text.replace(&section('a'), &more).replace("XA", "XY");
    scratch(&format!("{letters}.toml"), text)
}

/// Axes beyond X, Y and Z stay, in whatever form their lines are written; those of a machine are
/// the ones of its file.
#[test]
fn a_translation_has_all_axes() {
    let program = "G21 G90 G94\nG0 X1 A90 B-5\nG91\nG1 A45 C10 F100\no1 repeat [2]\nG1 A-1 X2\n\
                   o1 endrepeat\nG90\nM2\n";
    let file = scratch("axes.nc", program);
    let made = |args: &[&str], file: &Path| {
        let mut command = husillo();
        command
            .args(["format", "--to", "grbl"])
            .args(args)
            .arg(file);
        let output = command.output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{errors}");
        String::from_utf8(output.stdout).unwrap()
    };
    let text = made(&[], &file);
    let translated = scratch("axes-grbl.nc", &text);
    let ends = |file: &Path| -> Vec<Value> {
        let mut command = husillo();
        command.args(["commands", "--format", "json", "-m"]);
        let output = command.arg(machine("abc")).arg(file).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let lines = String::from_utf8(output.stdout).unwrap();
        let all = lines
            .lines()
            .map(|line| serde_json::from_str::<Value>(line).unwrap());
        all.filter(|one| one["to_nm"].is_array() || one["to"].is_array())
            .map(|one| match one["to_nm"].is_null() {
                true => one["to"].clone(),
                false => one["to_nm"].clone(),
            })
            .collect()
    };
    let before = ends(&file);
    assert_eq!(before.len(), 4, "{before:?}");
    assert_eq!(before, ends(&translated), "{text}");
    assert!(text.contains("A90") && text.contains("C10"), "{text}");
    // U is an axis of this machine only.
    let sliding = scratch("u.nc", "G21 G90\nG0 X1 U5\nM2\n");
    husillo()
        .args(["format", "--to", "linuxcnc"])
        .arg(&sliding)
        .assert()
        .code(1)
        .stderr(contains("U"));
    let mut command = husillo();
    command.args(["format", "--to", "linuxcnc", "-m"]);
    command.arg(machine("u")).arg(&sliding);
    command.assert().success().stdout(contains("G0 X1 U5"));
}
