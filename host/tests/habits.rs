//! Habits of CAM systems and senders that are taken, with or without a warning, and texts that say
//! what a controller does.

mod common;

use common::{husillo, scratch, written};
use predicates::str::contains;
use serde_json::Value;

/// The findings of `check` with these options.
fn check(name: &str, program: &str, options: &[&str]) -> Vec<Value> {
    let file = written(name, program);
    let output = husillo()
        .args(["check", "--format", "json"])
        .args(options)
        .arg(file)
        .output()
        .unwrap();
    common::findings(&output.stdout)
}

/// Code, line and column of each finding.
fn places(findings: &[Value]) -> Vec<(String, u64, u64)> {
    let place = |one: &Value| {
        let code = one["code"].as_str().unwrap().to_owned();
        let number = |key| one[key].as_u64().unwrap_or(0);
        (code, number("line"), number("column"))
    };
    findings.iter().map(place).collect()
}

fn codes(findings: &[Value]) -> Vec<&str> {
    let codes = findings.iter();
    codes.filter_map(|one| one["code"].as_str()).collect()
}

#[test]
fn the_first_motion_may_lack_its_code() {
    let program = "G21 G90\nF300\nX10 Y5\nX12\nG1 Z-1\nM2\n";
    let found = check("first.nc", program, &["-m", "free"]);
    assert_eq!(places(&found), [("W0605".to_owned(), 3, 1)]);
    assert_eq!(found[0]["help"], "write G0 or G1 before the axis words");
    // It runs, and is a rapid.
    let file = written("first.nc", program);
    let file = file.to_str().unwrap();
    let commands = common::printed(&["commands", "-m", "free", file]);
    assert!(commands.contains("rapid X10 Y5"), "{commands}");
    let csv = scratch("first.csv");
    let csv = csv.to_str().unwrap();
    common::printed(&["steps", "-m", "free", file, "-o", csv]);
    // A program with a code, and one for Grbl, have no warning.
    let coded = check("coded.nc", "G0\nX10\nM2\n", &["-m", "free"]);
    assert!(coded.is_empty(), "{coded:?}");
    let grbl = check("first.nc", program, &["-m", "free", "--dialect", "grbl"]);
    assert!(grbl.is_empty(), "{grbl:?}");
    // After G80 there is no motion mode, at the start too.
    let cancelled = check("cancelled.nc", "G80\nX10\nM2\n", &["-m", "free"]);
    assert_eq!(codes(&cancelled), ["E0206"]);
}

/// Nothing claims what a controller answers to its own commands.
#[test]
fn lines_for_the_controller_are_left_out() {
    for program in ["$H\nG0 X1\nM2\n", "$H\n#1=1\n$X\nG0 X#1\nM2\n"] {
        let file = written("dollar.nc", program);
        for dialect in ["rs274", "iso", "lathe"] {
            let options = ["-m", "free", "--dialect", dialect];
            let found = check("dollar.nc", program, &options);
            assert!(
                codes(&found).iter().all(|code| *code == "W0604"),
                "{found:?}"
            );
            assert!(!found.is_empty());
            assert!(
                found
                    .iter()
                    .all(|one| one["notes"] == serde_json::json!([]))
            );
            husillo()
                .args(["run", "-o"])
                .arg(scratch("dollar.html"))
                .args(options)
                .arg(&file)
                .assert()
                .success();
        }
    }
    let jog = check("jog.nc", "G21\n$J=G91 X1 F9\nM2\n", &["-m", "free"]);
    assert_eq!(codes(&jog), ["E0101"]);
    assert_eq!(jog[0]["help"], "write G1, or send it by a Grbl sender");
}

#[test]
fn comments_have_parentheses_inside() {
    let program = "(tool (3.175) flat) G0 X1\n#1=2 (a (b)\n(c ((d) e) f) G0 X#1 (g)\nM2\n";
    let found = check("nested.nc", program, &["-m", "free"]);
    assert!(found.is_empty(), "{found:?}");
    let open = check("open.nc", "G0 X1 (a (b) c\nM2\n", &["-m", "free"]);
    assert_eq!(places(&open), [("E0105".to_owned(), 1, 7)]);
    // Written for Grbl, which ends a comment at the first parenthesis, they are brackets.
    let file = written("nested-plain.nc", "G0 X1 (a (b) c)\nM2\n");
    let args = ["format", "--to", "grbl", file.to_str().unwrap()];
    husillo().args(args).assert().stdout(contains("(a [b] c)"));
}

#[test]
fn checksums_are_checked_in_every_dialect() {
    let sum = |text: &str| {
        let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("{text}*{sum}\n")
    };
    let lines = [sum("N1 G0 X1"), sum("N7 G0 X2"), sum("n8 G1 Y1 F9")].concat();
    for program in [
        lines.clone() + "M2\n",
        format!("#1=[2*3]\n{lines}G0 X#1\nM2\n"),
    ] {
        let found = check("sums.nc", &program, &["-m", "free"]);
        assert!(found.is_empty(), "{program}: {found:?}");
        let wrong = program.replacen("X2*", "X3*", 1);
        let found = check("sums.nc", &wrong, &["-m", "free"]);
        assert_eq!(codes(&found), ["E0110"], "{wrong}");
        assert!(found[0]["help"].is_string());
    }
    // A star without a number is no checksum.
    let found = check("star.nc", "N1 G0 X1*\nM2\n", &["-m", "free"]);
    assert_eq!(codes(&found), ["E0101"]);
}

/// The tolerance of arcs is that of the program's dialect, or that of the machine file.
#[test]
fn the_machine_file_widens_and_narrows_the_tolerance_of_arcs() {
    // The radii are 10 mm and 10.1 mm.
    let wide = "G21 G90 G0 X10.0000 Y0.0000\nG3 X0.0000 Y10.1000 I-10.0000 J0.0000 F300\nM2\n";
    // 10 mm and 10.02 mm.
    let narrow = wide.replace("10.1000", "10.0200");
    let router = include_str!("../../machines/router.toml");
    let with = |tolerance: &str| {
        let line = format!("[motion]\narc_tolerance = \"{tolerance}\"\n");
        let text = router.replacen("[motion]\n", &line, 1);
        let name = format!("arcs-{}.toml", tolerance.replace(' ', ""));
        written(&name, &text).to_str().unwrap().to_owned()
    };
    let errors = |program: &str, machine: &str| {
        let mut found = check("arcs.nc", program, &["-m", machine]);
        found.retain(|one| one["severity"] == "error");
        found
    };
    let by_rule = errors(wide, "router");
    assert_eq!(codes(&by_rule), ["E0302"]);
    let note = |found: &[Value]| found[0]["notes"][0].as_str().unwrap().to_owned();
    assert!(
        note(&by_rule).starts_with("LinuxCNC's rule:"),
        "{by_rule:?}"
    );
    assert!(errors(wide, &with("0.15 mm")).is_empty());
    let by_machine = errors(wide, &with("0.05 mm"));
    assert_eq!(codes(&by_machine), ["E0302"]);
    assert!(
        note(&by_machine).contains("motion.arc_tolerance"),
        "{by_machine:?}"
    );
    assert!(errors(&narrow, "router").is_empty());
    let narrowed = errors(&narrow, &with("0.01 mm"));
    assert_eq!(codes(&narrowed), ["E0302"]);
    assert!(
        note(&narrowed).starts_with("the rule of router"),
        "{narrowed:?}"
    );
    // What is taken is made.
    let file = written("arcs.nc", wide);
    let run = ["run", file.to_str().unwrap(), "-m", &with("0.15 mm"), "-o"];
    husillo()
        .args(run)
        .arg(scratch("arcs.html"))
        .assert()
        .success();
}

/// Every error has one sentence that says what to do.
#[test]
fn every_error_has_help() {
    let program = "?1\nG1 X1.2.3\nG0 X12345678901234.\nG55.7\nG0 B1\nG0 X1 X2\nG92\nG0 X1 H1\n\
        G2 X3 Y1 R1 I1 F1\nG2 X3 Y0 R1 F1\nG2 Z1 R1 F1\nG1 F-1 X1\nF0 G1 X1\nM19 R360\nG41 D7\n\
        G33 Z-1 K1\nG93 F1 G81 Z-1 R0\nG94 F1 G81 Z-1 R-2\n#1=[1/0]\n#1=SINE[1]\nG0 X#<nothing>\n\
        G5.3\nG38.2 X0\nM98 P77\nM2\n";
    let found = check("help.nc", program, &["-m", "free", "--limit", "99"]);
    assert!(found.len() > 20, "{found:?}");
    for one in &found {
        assert!(
            one["help"].as_str().is_some_and(|help| help.len() > 4),
            "{one}"
        );
    }
}
