//! Every command on small programs, as a user calls it.

mod common;

use common::{husillo, json, scratch};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;

fn json_lines(args: &[&str]) -> Vec<Value> {
    common::objects(&husillo().args(args).output().unwrap().stdout)
}

#[test]
fn the_circles_of_the_micro_mill() {
    let circles = json(&["run", "../examples/circles.nc", "--format", "json"]);
    assert_eq!(circles["errors"], 0);
    assert_eq!(circles["lost_steps"], 0);
    // Half a step, and the rounded start and end points.
    assert!(
        circles["max_deviation_nm"].as_f64().unwrap() <= 0.7072 * 140.0,
        "{circles}"
    );
    assert!(circles["rms_deviation_nm"].as_f64().unwrap() < 50.0);
    let uncompensated = json(&[
        "run",
        "../examples/circles.nc",
        "--format",
        "json",
        "--no-compensation",
    ]);
    // The flats the machine really made: about the backlash of X and Y together.
    assert!(uncompensated["max_deviation_nm"].as_f64().unwrap() > 100_000.0);
}

#[test]
fn every_example_runs_with_a_report_that_stands_alone() {
    for (name, reversals) in [
        ("circles", 14),
        ("gear", 50),
        ("star", 22),
        ("ornament", 45),
    ] {
        let report = scratch(&format!("{name}.html"));
        let program = format!("../examples/{name}.nc");
        husillo()
            .args(["run", &program, "-o"])
            .arg(&report)
            .assert()
            .success()
            .stdout(contains("step events"));
        let page = std::fs::read_to_string(&report).unwrap();
        assert!(
            page.contains("<title>")
                && page.contains("prefers-color-scheme")
                && page.contains("class=\"take-up\"")
        );
        // Speed over time, with a bar under the axis for every take-up.
        assert!(page.contains("path speed, mm/min") && page.contains("class=\"stop take-up\""));
        assert!(!page.contains("http:") && !page.contains("https:"));
        assert!(!page.contains(" src=") && page.contains("id=\"scene\">"));
        let results = json(&["run", &program, "--format", "json"]);
        let count: u64 = results["reversals"]
            .as_array()
            .unwrap()
            .iter()
            .map(|n| n.as_u64().unwrap())
            .sum();
        assert_eq!(count, reversals, "{name}");
    }
}

#[test]
fn errors_stop_a_run_before_anything_moves() {
    let report = scratch("never.html");
    let _ = std::fs::remove_file(&report);
    husillo()
        .args([
            "run",
            "-m",
            "micromill",
            "tests/data/outside.nc",
            "--zero",
            "X0",
            "-o",
        ])
        .arg(&report)
        .assert()
        .code(1)
        .stderr(contains(
            "error[E0401]: the part reaches X 5 to 10.25 mm, and micromill X 0 to 10 mm: move zero \
             by at least X -0.25",
        ))
        .stderr(contains("limit set here"))
        .stderr(contains("nothing moves"));
    assert!(!report.exists());
}

#[test]
fn findings_and_codes_are_explained() {
    husillo()
        .args(["explain", "e302", "G083"])
        .assert()
        .success()
        .stdout(
            contains("E0302: the end of an arc is not on it\n")
                .and(contains(
                    "  remedy: check I, J, K; absolute centres need G90.1\n",
                ))
                .and(contains(
                    "G83: drill with full retractions\n  words: X Y Z R Q\n",
                )),
        );
    husillo()
        .args(["explain", "G83", "part.nc"])
        .assert()
        .code(2)
        .stdout("")
        .stderr(contains("error: `part.nc` is not known"));
}

#[test]
fn shells_and_manuals_are_served() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        husillo()
            .args(["completions", shell])
            .assert()
            .success()
            .stdout(contains("calibrate").and(contains("zero")));
    }
    let folder = scratch("manuals");
    husillo().arg("man").arg(&folder).assert().success();
    let page = std::fs::read_to_string(folder.join("husillo-run.1")).unwrap();
    assert!(page.contains("Simulate a program") && page.contains("zero"));
    assert!(folder.join("husillo.1").exists());
}

/// Every built-in machine is listed and shown, and its file can be written, changed and used.
#[test]
fn machines_are_listed_shown_and_written() {
    let text = |args: &[&str]| {
        let output = husillo().args(args).output().unwrap();
        assert!(output.status.success(), "{args:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let listed = text(&["machines"]);
    let names: Vec<&str> = listed
        .lines()
        .map(|line| line.split(' ').next().unwrap())
        .collect();
    assert_eq!(names.len(), 11, "{listed}");
    for name in names {
        assert!(
            listed
                .lines()
                .any(|line| line.starts_with(name) && line.len() > 20)
        );
        assert!(!text(&["machines", "show", name]).is_empty());
        let json = text(&["machines", "show", name, "--format", "json"]);
        let shown: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(shown["name"], name);
        let file = scratch(&format!("written-{name}.toml"));
        let _ = std::fs::remove_file(&file);
        let path = file.to_str().unwrap();
        assert!(text(&["machines", "write", name, path]).contains("use it with -m"));
        assert_eq!(
            std::fs::read_to_string(&file).unwrap(),
            text(&["machines", "write", name, "-"])
        );
        // A second time it stays as it is.
        husillo()
            .args(["machines", "write", name, path])
            .assert()
            .code(2);
        if !name.starts_with("cmm") {
            text(&["machines", "show", path]);
        }
    }
    husillo()
        .args(["machines", "write", "nosuch"])
        .assert()
        .code(2)
        .stderr(contains("error: no machine `nosuch`: micromill, free,"));
    husillo()
        .args(["check", "tests/data/kinds.nc", "-m", "nosuch"])
        .assert()
        .code(2)
        .stderr(contains("are built in, and there is no such file"));
}

/// Without -m a comment names the machine, or the first machine that takes the program makes it.
#[test]
fn the_machine_is_found() {
    let page = scratch("found.html");
    let found = |name: &str, text: &str, code: i32| {
        let program = common::written(name, text);
        let output = husillo()
            .arg("run")
            .arg(&program)
            .arg("-o")
            .arg(&page)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(code), "{name}");
        let told = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        told.concat()
    };
    let told = found("found-small.nc", "G21 G90\nG1 X4 Y3 F1\nM2\n", 0);
    assert!(told.contains("micromill is the first machine of"), "{told}");
    let told = found(
        "found-large.nc",
        "G21 G90\nG0 X1\nG1 X90 Y-30 F600\nM2\n",
        0,
    );
    assert!(told.contains("router is the first machine of"), "{told}");
    assert!(told.contains("placed in the middle of router"), "{told}");
    let told = found("found-huge.nc", "G21 G90\nG0 X1\nG1 X900 F600\nM2\n", 0);
    assert!(
        told.contains("no machine of micromill, router, lathe")
            && told.contains("it is checked for free"),
        "{told}"
    );
    let told = found(
        "found-named.nc",
        "(4 mm; for -m free)\nG21 G90\nG1 X4 F1\nM2\n",
        0,
    );
    assert!(
        told.contains("for free: no errors") && !told.contains("first"),
        "{told}"
    );
    let told = found("found-wrong.nc", "G21 G90\nG1 X1.2.3 F1\n", 1);
    assert!(
        told.contains("error[E0102]") && told.contains("nothing moves"),
        "{told}"
    );
}

#[test]
fn all_errors_at_their_columns() {
    husillo()
        .args(["check", "tests/data/errors.nc", "--format", "short"])
        .assert()
        .code(1)
        .stdout(
            "tests/data/errors.nc:2:8: error[E0102]: malformed number `1.2.3`\n\
         tests/data/errors.nc:3:5: error[E0103]: number too large\n\
         tests/data/errors.nc:4:4: error[E0201]: unknown word `U`\n\
         tests/data/errors.nc:5:1: error[E0301]: arc without a centre or a radius\n\
         tests/data/errors.nc:6:7: error[E0203]: word `X` repeated\n\
         tests/data/errors.nc:7:1: error[E0212]: known code `G77`, not of this dialect\n",
        );
}

/// What `check` prints about a program, one line for each finding.
fn short_findings(name: &str, program: &str) -> String {
    let mut check = husillo();
    check.args(["check", "--format", "short"]);
    let output = check.arg(common::written(name, program)).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

/// After a refused move the program is checked as if the move had been made: one error is one
/// finding, and none is invented or hidden.
#[test]
fn the_line_after_an_error_begins_at_its_end() {
    let program = "G21 G90 F100\nG2 X10 Y0 I1 J0\nG2 X20 Y0 I5 J0\nG2 X30 I5\nG91 G3 X2 Y9 I1\n\
                   G90 G2 X34 Y9 I1 J0\nG2 X40 Y0 I1 J0\nM2\n";
    let told = short_findings("after-error.nc", program);
    let lines: Vec<_> = told
        .lines()
        .map(|line| line.split(':').nth(1).unwrap())
        .collect();
    assert_eq!(lines, ["2", "5", "7"], "{told}");
    assert!(
        told.lines().all(|line| line.contains("error[E0302]")),
        "{told}"
    );
}

/// The axis words of G10, G92 and their like are no end of a move.
#[test]
fn after_a_refused_offset_the_position_is_the_same() {
    for refused in ["G92 X100 K1", "G10 L2 P77 X100", "G28.1 X100 K1"] {
        let program = format!("G21 G90 F100\n{refused}\nG2 X2 I1 J0\nM2\n");
        let told = short_findings("after-offset.nc", &program);
        assert_eq!(told.lines().count(), 1, "{refused}: {told}");
        assert!(told.contains(":2:"), "{refused}: {told}");
    }
}

/// A file for Grbl may set the controller up. Such lines are left out, with a warning. `format`
/// copies them, and a `%` after M30.
#[test]
fn what_controllers_leave_out_is_left_out() {
    let program = "$H\n $32=1\n$N0=G21\n$#\nG21 G90 G1 X1 F100\n$J=G91 X10 F100\n";
    let file = common::written("dollars.nc", program);
    let grbl = ["--dialect", "grbl", "--format", "short"];
    let output = husillo().arg("check").args(grbl).arg(&file).output();
    let told = String::from_utf8(output.unwrap().stdout).unwrap();
    let codes: Vec<_> = told
        .lines()
        .map(|line| &line[line.find('[').unwrap() + 1..][..5])
        .collect();
    assert_eq!(
        codes,
        ["W0604", "W0604", "W0604", "W0604", "E0101"],
        "{told}"
    );
    let output = husillo()
        .args(["format", "--dialect", "grbl", "-"])
        .write_stdin("$32=1\ng1 x1\n")
        .output();
    assert_eq!(output.unwrap().stdout, b"$32=1\nG1 X1\n");
    let mut format = husillo();
    format.args(["format", "-"]).write_stdin("%\ng1x1\nm30%\n");
    assert_eq!(format.output().unwrap().stdout, b"%\nG1 X1\nM30%\n");
}

#[test]
fn findings_as_text_and_json() {
    husillo()
        .args(["check", "tests/data/errors.nc", "--limit", "1"])
        .assert()
        .code(1)
        .stdout(
            contains("2 | G1 X1.2.3")
                .and(contains("^^"))
                .and(contains("5 findings not printed")),
        );
    let check = ["check", "tests/data/errors.nc", "--format", "json"];
    let findings = common::findings(&husillo().args(check).output().unwrap().stdout);
    assert_eq!(findings.len(), 6);
    assert_eq!(findings[2]["code"], "E0201");
    assert_eq!(
        (findings[2]["line"].as_u64(), findings[2]["column"].as_u64()),
        (Some(4), Some(4))
    );
}

#[test]
fn a_finding_in_full() {
    let program = scratch("full.nc");
    std::fs::write(&program, "G21 G90\nG1 X1 Y1\n").unwrap();
    husillo()
        .arg("check")
        .arg("-")
        .pipe_stdin(&program)
        .unwrap()
        .assert()
        .code(1)
        .stdout(
            "error[E0501]: feed move before any feed rate\n \
         --> <input>:2:1\n  \
         |\n\
         2 | G1 X1 Y1\n  \
         | ^^ no `F` on this line or before it\n  \
         |\n  \
         = note: grbl: `error:22`; LinuxCNC: \"Cannot do g1 with zero feed rate\"\n  \
         = help: add a feed rate, as in `F100`\n\
         \n\
         <input>: 1 error, no warnings\n",
        );
}

#[test]
fn nasty_inputs_are_survived() {
    let long = [
        b"G1 X1 F100 (".to_vec(),
        vec![b'x'; 10 << 20],
        b")\nG1 X2\n".to_vec(),
    ]
    .concat();
    let cases: [(&[u8], i32); 9] = [
        (b"", 0),
        (b"%", 0),
        (b"%\r\nG21\r\nG0 X1\r\n%\r\n", 0),
        (b"G0 X1", 0),
        (b"\x00\x01\xff\xfe\x80", 1),
        (b"G0 X1\x00\n", 1),
        (&long, 1),
        (b"G2 X1 Y1 I5 J5 F100", 1),
        (b"\xef\xbb\xbfG0 X1\n", 0),
    ];
    for (index, (bytes, code)) in cases.into_iter().enumerate() {
        let program = scratch(&format!("nasty{index}.nc"));
        std::fs::write(&program, bytes).unwrap();
        husillo().arg("check").arg(&program).assert().code(code);
        husillo()
            .args(["run", "-m", "free", "--format", "json"])
            .arg(&program)
            .assert()
            .code(code);
    }
}

#[test]
fn commands_as_json() {
    let commands = json_lines(&["commands", "tests/data/kinds.nc", "--format", "json"]);
    let kinds: Vec<_> = commands
        .iter()
        .map(|command| command["kind"].as_str().unwrap())
        .collect();
    assert_eq!(
        kinds,
        [
            "tool", "spindle", "coolant", "rapid", "linear", "arc", "dwell", "linear", "spindle",
            "coolant", "stop", "end"
        ]
    );
    let arc = &commands[5];
    assert_eq!(arc["to_nm"], serde_json::json!([0, 3_000_000, 0]));
    assert_eq!(arc["centre_nm"], serde_json::json!([0, 2_000_000, 0]));
    assert_eq!(
        (&arc["plane"], &arc["direction"], &arc["turns"]),
        (&"xy".into(), &"ccw".into(), &1.into())
    );
    assert_eq!(arc["feed_nm_per_min"], 600_000_000);
    // Ten millimetres twice a minute.
    assert_eq!(commands[7]["feed_nm_per_min"], 20_000_000);
}

#[test]
fn commands_as_text() {
    husillo()
        .args(["commands", "tests/data/percent.nc"])
        .assert()
        .success()
        .stdout("     3  linear X1 Y0 Z0 F100\n");
}

#[test]
fn the_micromill_dialect_by_the_name_of_the_file() {
    let commands = json_lines(&["commands", "tests/data/example.mm", "--format", "json"]);
    assert_eq!(
        commands[1]["centre_nm"],
        serde_json::json!([3_012_000, 3_040_000, 0])
    );
    assert_eq!(commands[1]["feed_nm_per_min"], 800_000);
    husillo()
        .args(["check", "-m", "micromill", "tests/data/example.mm"])
        .assert()
        .success()
        .stdout(contains("W0302"));
}

#[test]
fn steps_as_csv() {
    let program = scratch("steps.nc");
    std::fs::write(&program, "G1 X0.00028 F1.2\nG4 P1\nG1 X0.00014\n").unwrap();
    let output = husillo()
        .arg("steps")
        .arg(&program)
        .args(["-o", "-"])
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<_> = text.lines().collect();
    assert_eq!(
        rows[..4],
        [
            "event,wait_ticks,dx,dy,dz",
            "1,7000,1,0,0",
            "2,7000,1,0,0",
            "2,1000000,0,0,0"
        ]
    );
    // The backlash of X is taken up, then one step is made.
    assert_eq!(rows.len(), 4 + 1457 + 1);
    // With the inputs of the drivers, PH of phase A in bit 0, of B in bit 3: X advances by a
    // quarter of its cycle per step.
    let output = husillo()
        .arg("steps")
        .arg(&program)
        .args(["--levels", "-o", "-"])
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<_> = text.lines().take(4).collect();
    assert_eq!(
        rows,
        [
            "event,wait_ticks,dx,dy,dz,lx,ly,lz",
            "1,7000,1,0,0,9,1,1",
            "2,7000,1,0,0,8,1,1",
            "2,1000000,0,0,0,8,1,1"
        ]
    );
}

#[test]
fn the_trace_of_a_run() {
    let trace = scratch("trace.csv");
    let program = scratch("trace.nc");
    std::fs::write(&program, "G1 X0.00042 F1.2\n").unwrap();
    husillo()
        .arg("run")
        .arg(&program)
        .args(["--format", "json", "--trace"])
        .arg(&trace)
        .assert()
        .success();
    let text = std::fs::read_to_string(&trace).unwrap();
    assert_eq!(text.lines().nth(3), Some("3,21000,420,0,0,feed"));
}

#[test]
fn arcs_are_those_of_the_oracle() {
    let text = std::fs::read_to_string("tests/data/arcs_general.json").unwrap();
    let oracle: Value = serde_json::from_str(&text).unwrap();
    for arc in oracle["arcs"].as_array().unwrap().iter().step_by(4) {
        let bits = arc["f"].as_u64().unwrap();
        let pair = |key: &str| [0, 1].map(|axis| arc[key][axis].as_i64().unwrap());
        let ints = |key: &str| pair(key).map(|n| n.to_string()).join(",");
        // A multiple of 2^-16 has at most 16 decimals.
        let centre = pair("C").map(|c| {
            let magnitude = (u128::from(c.unsigned_abs()) * 10_u128.pow(16)) >> bits;
            format!(
                "{}{}.{:016}",
                if c < 0 { "-" } else { "" },
                magnitude / 10_u128.pow(16),
                magnitude % 10_u128.pow(16)
            )
        });
        let mut args = vec![
            "interpolate".to_owned(),
            "arc".to_owned(),
            "--format=json".to_owned(),
        ];
        args.push(format!("--from={}", ints("S")));
        args.push(format!("--to={}", ints("E")));
        args.push(format!("--centre={}", centre.join(",")));
        args.push(format!("--centre-bits={bits}"));
        args.push(format!("--direction={}", arc["dir"].as_str().unwrap()));
        args.push(format!("--turns={}", arc["turns"]));
        if !arc["R2"].is_null() {
            args.push(format!("--radius-squared={}", arc["R2"]));
        }
        let walk = json(&args.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(walk["steps"], arc["steps"], "{args:?}");
        assert_eq!(walk["iterations"], arc["iters"]);
        let error = walk["max_error_blu"].as_f64().unwrap() - arc["max_dev"].as_f64().unwrap();
        assert!(error.abs() < 1e-5, "{args:?}: {error}");
    }
}

#[test]
fn lines_of_more_axes_are_those_of_the_oracle() {
    let text = std::fs::read_to_string("tests/data/lines_nd.json").unwrap();
    let oracle: Value = serde_json::from_str(&text).unwrap();
    for line in oracle["nd"].as_array().unwrap().iter().step_by(3) {
        let to: Vec<_> = line["d"]
            .as_array()
            .unwrap()
            .iter()
            .map(Value::to_string)
            .collect();
        let walk = json(&[
            "interpolate",
            "line",
            "--format=json",
            &format!("--to={}", to.join(",")),
        ]);
        assert_eq!(walk["steps"], line["steps"], "{to:?}");
    }
}

#[test]
fn wrong_usage_ends_with_two() {
    for args in [
        &["run", "no-such-file.nc"][..],
        &["check", "."],
        &["check", "-m", "nowhere", "tests/data/percent.nc"],
        &["check", "--dialect", "latin", "tests/data/percent.nc"],
        &["interpolate", "line", "--to", "5"],
        &["interpolate", "line", "--to", "5,2", "--method", "ratio"],
        &[
            "interpolate",
            "arc",
            "--from=1,0",
            "--to=1,0",
            "--centre=0.1,0",
            "--direction=cw",
        ],
        &["frobnicate"],
    ] {
        husillo()
            .args(args)
            .assert()
            .code(2)
            .stderr(predicate::str::is_empty().not());
    }
}

#[test]
fn a_misspelt_key_of_a_machine_file() {
    let machine = scratch("mine.toml");
    let text = std::fs::read_to_string("../machines/micromill.toml").unwrap();
    std::fs::write(&machine, text.replacen("backlash", "baklash", 1)).unwrap();
    husillo()
        .args(["check", "tests/data/percent.nc", "-m"])
        .arg(&machine)
        .assert()
        .code(2)
        .stderr(
            contains("error[E0801]: unknown key `baklash` in [axis.x]")
                .and(contains("did you mean `backlash`?")),
        );
}

/// A line as a sender for 3D printers writes it: with the exclusive or of its bytes.
fn summed(line: &str) -> String {
    let sum = line.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("{line}*{sum}\n")
}

#[test]
fn lines_with_checksums_are_checked() {
    let good = summed("N0 M110 N0") + &summed("N1 G21") + &summed("N2 G1 X10.5 F1200") + ";end\n";
    let path = scratch("printer.gcode");
    let name = path.to_str().unwrap();
    // A byte order mark is no part of a program.
    std::fs::write(&path, format!("\u{feff}{good}")).unwrap();
    let commands = husillo()
        .args(["commands", name, "--dialect", "printer"])
        .output()
        .unwrap();
    let printed = String::from_utf8(commands.stdout).unwrap();
    assert!(printed.contains("linear X10.5 Y0 Z0 F1200"), "{printed}");
    std::fs::write(&path, good.replace("10.5", "10.6") + &summed("N7 G0 X1")).unwrap();
    husillo()
        .args(["check", name, "--dialect", "printer"])
        .assert()
        .code(1)
        .stdout(contains("E0110").and(contains("line number 7 is not the next one")));
}
