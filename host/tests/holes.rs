//! `husillo holes` and `husillo check` on drill files, as a user calls them.

mod common;

use common::{husillo, json, printed, scratch};
use husillo_transports::drill::{Record, Table, records};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

fn list(args: &[&str]) -> Value {
    json(&[&["holes", "--format", "json"], args].concat())
}

fn program(args: &[&str]) -> String {
    printed(&[&["holes"], args].concat())
}

#[test]
fn the_board_of_the_examples() {
    let board = list(&["../examples/board.drl"]);
    let holes = board["holes"].as_array().unwrap();
    assert_eq!(holes.len(), 22);
    assert_eq!(holes[0], json!([10, 10, 0.8]));
    assert_eq!(holes[7], json!([27.78, 10, 0.8]));
    assert_eq!(holes[21], json!([36.5, 26.5, 3.2]));
    assert_eq!(board["slots"], json!([[17, 3, 23, 3, 1.5]]));
    assert_eq!(board["tools"][1]["plated"], true);
    assert_eq!(board["tools"][3]["plated"], false);
    assert_eq!(board["units"], "mm");
    husillo()
        .args(["holes", "../examples/board.drl"])
        .assert()
        .success()
        .stdout(contains("22 holes, 1 slot"))
        .stdout(contains(
            "units    mm                         declared in line 5",
        ))
        .stdout(contains("T2               1  yes           4        0"))
        .stdout(contains("X 3.5 to 36.5 mm, Y 3 to 26.5 mm"));
    husillo()
        .args(["check", "../examples/board.drl", "--deny-warnings"])
        .assert()
        .success()
        .stdout("../examples/board.drl: no errors, no warnings\n");
}

#[test]
fn what_nobody_says_is_found_out_and_said() {
    // PADS: no units, no zeros, no header.
    let bare = list(&["tests/data/drill/bare.drl"]);
    assert_eq!(
        bare["holes"],
        json!([[27.813, 32.258, 0.381], [59.69, 50.8, 0.381]])
    );
    assert_eq!(bare["zeros"], "leading");
    husillo()
        .args(["check", "tests/data/drill/bare.drl", "--deny-warnings"])
        .assert()
        .code(1)
        .stdout(contains("warning[W0928]"))
        .stdout(contains("warning[W0929]"))
        .stdout(contains("--zeros leading or --zeros trailing"));
    let overridden = list(&[
        "tests/data/drill/bare.drl",
        "--units",
        "mm",
        "--zeros",
        "trailing",
        "--format-digits",
        "3.2",
        "--tool",
        "1=0.5",
    ]);
    assert_eq!(
        overridden["holes"],
        json!([[10.95, 1.27, 0.5], [2.35, 0.02, 0.5]])
    );
    assert_eq!(overridden["warnings"], 0);
    husillo()
        .args(["check", "tests/data/drill/long.drl"])
        .assert()
        .success()
        .stdout(contains("warning[W0930]: line 5 of"));
    husillo()
        .args(["check", "-", "--dialect", "excellon"])
        .write_stdin("METRIC\nT1C1\n%\nT1X1.5Y2\n")
        .assert()
        .success()
        .stdout(contains("warning[W0931]"));
    let given = list(&["tests/data/drill/long.drl", "--format-digits", "4:4"]);
    assert_eq!(given["holes"], json!([[1.2345, 1, 0.8]]));
}

#[test]
fn tango_has_its_own_defaults_and_tools_from_the_command_line() {
    let board = list(&[
        "tests/data/drill/tango.drl",
        "--profile",
        "tango",
        "--tool",
        "1=0.8",
        "--tool",
        "T2=0.04in",
    ]);
    assert_eq!(
        board["holes"],
        json!([
            [31.75, 50.8, 0.8],
            [34.29, 50.8, 0.8],
            [34.29, -12.7, 1.016]
        ])
    );
    husillo()
        .args([
            "holes",
            "tests/data/drill/tango.drl",
            "--profile",
            "tango",
            "--format",
            "json",
        ])
        .assert()
        .success()
        .stdout(contains("[31.75,50.8,null]"))
        .stdout(contains("the diameter of tool T1 is unknown"))
        .stdout(contains("--tool 1=0.8"));
}

#[test]
fn all_errors_at_their_columns() {
    husillo()
        .args(["check", "tests/data/drill/faults.drl", "--format", "short"])
        .assert()
        .code(1)
        .stdout(
            "tests/data/drill/faults.drl:5:1: error[E0903]: hole before any tool\n\
             tests/data/drill/faults.drl:7:2: error[E0102]: malformed number\n\
             tests/data/drill/faults.drl:8:1: error[E0202]: `G83` is not supported\n\
             tests/data/drill/faults.drl:10:1: error[E0911]: step and repeat out of order\n\
             tests/data/drill/faults.drl:11:1: warning[W0924]: tool T1 gets another diameter\n\
             tests/data/drill/faults.drl:13:1: warning[W0927]: text after the end of the program, \
             ignored\n",
        );
    husillo()
        .args(["check", "tests/data/drill/gerber.drl"])
        .assert()
        .code(1)
        .stdout(contains("error[E0902]: a Gerber file, not a drill file"))
        .stdout(contains("1 error, no warnings"));
    husillo()
        .args([
            "holes",
            "tests/data/drill/faults.drl",
            "--as",
            "gcode",
            "--depth",
            "1.8",
        ])
        .assert()
        .code(1)
        .stdout("")
        .stderr(contains("nothing written"));
    husillo()
        .args(["run", "../examples/board.drl"])
        .assert()
        .code(2)
        .stderr(contains("husillo holes"));
}

#[test]
fn options_that_make_no_sense_are_refused() {
    for (args, message) in [
        (&["--as", "gcode"][..], "needs --depth"),
        (&["--as", "gcode", "--depth", "-1"], "above zero"),
        (&["--as", "gcode", "--depth", "1", "--safe", "1"], "below"),
        (&["--format-digits", "24"], "as in 2.4"),
        (&["--format-digits", "12.4"], "as in 2.4"),
        (&["--tool", "1"], "as in 1=0.8"),
        (&["--tool", "1=-0.8"], "as in 1=0.8"),
        (
            &["--as", "gcode", "--depth", "1", "--slots", "refuse"],
            "1 slot",
        ),
    ] {
        let mut command = husillo();
        command.args(["holes", "../examples/board.drl"]);
        // A value may begin with a minus only after an equals sign.
        let joined: Vec<String> = args
            .chunks(2)
            .map(|pair| format!("{}={}", pair[0], pair[1]))
            .collect();
        command
            .args(joined)
            .assert()
            .code(2)
            .stderr(contains(message));
    }
    husillo()
        .args(["holes", "tests/data/drill/no-such.drl"])
        .assert()
        .code(2)
        .stderr(contains("no-such.drl"));
}

/// The points of a list of holes, in their order.
fn points(board: &Value) -> Vec<[f64; 3]> {
    let holes = board["holes"].as_array().unwrap();
    holes
        .iter()
        .map(|hole| [0, 1, 2].map(|index: usize| hole[index].as_f64().unwrap()))
        .collect()
}

#[test]
fn the_shortest_order_keeps_every_hole_and_is_shorter() {
    let in_file = points(&list(&["../examples/board.drl"]));
    let short = points(&list(&["../examples/board.drl", "--order", "shortest"]));
    let travel = |points: &[[f64; 3]]| -> f64 {
        let steps = points.windows(2);
        steps
            .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
            .sum()
    };
    assert!(travel(&short) < travel(&in_file));
    let sorted = |mut points: Vec<[f64; 3]>| {
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        points
    };
    // One tool after the other.
    let mut tools: Vec<_> = short.iter().map(|hole| hole[2]).collect();
    tools.dedup();
    assert_eq!(tools, [0.8, 1.0, 3.2]);
    assert_eq!(sorted(short), sorted(in_file));
}

#[test]
fn a_program_of_plain_moves_drills_every_hole() {
    let args = [
        "../examples/board.drl",
        "--as",
        "gcode",
        "--depth",
        "1.8",
        "--cycle",
        "moves",
        "--order",
        "shortest",
    ];
    let text = program(&args);
    let file = scratch("board.nc");
    std::fs::write(&file, &text).unwrap();
    husillo().arg("check").arg(&file).assert().success();
    let output = husillo()
        .arg("commands")
        .arg(&file)
        .args(["--format", "json"])
        .output()
        .unwrap();
    let mut drilled = Vec::new();
    for line in String::from_utf8(output.stdout).unwrap().lines() {
        let command: Value = serde_json::from_str(line).unwrap();
        let at = &command["to_nm"];
        if command["kind"] == "linear" && at[2] == -1_800_000 {
            drilled.push([at[0].as_f64().unwrap() / 1e6, at[1].as_f64().unwrap() / 1e6]);
        }
    }
    let holes = points(&list(&["../examples/board.drl", "--order", "shortest"]));
    let expected: Vec<_> = holes.iter().map(|hole| [hole[0], hole[1]]).collect();
    assert_eq!(drilled[..22], expected);
    // The slot: down at one end, along to the other.
    assert_eq!(drilled[22..], [[17.0, 3.0], [23.0, 3.0]]);
}

#[test]
fn drill_cycles_and_slots() {
    let text = program(&["../examples/board.drl", "--as=gcode", "--depth=1.8"]);
    assert!(text.contains("T1 M6\n"), "{text}");
    assert!(text.contains("G99 G81 X10 Y10 Z-1.8 R2 F60\nX12.54 Y10\n"));
    assert!(text.contains("G0 X17 Y3\nG0 Z2\nG1 Z-1.8 F60\nG1 X23 Y3 F60\nG0 Z2\n"));
    assert!(text.ends_with("G0 Z10\nM5\nM30\n"));
    let pecked = program(&[
        "../examples/board.drl",
        "--as=gcode",
        "--depth=0.07in",
        "--cycle=g83",
        "--slots=drill",
        "--speed=9000",
    ]);
    assert!(pecked.contains("M3 S9000\n"), "{pecked}");
    assert!(pecked.contains("G99 G83 Q0.5 X10 Y10 Z-1.778 R2 F60\n"));
    // 6 mm by holes of 1.5 mm, at most 1.05 mm apart: ends first, then five between.
    assert!(
        pecked.contains(
            "X17 Y3 Z-1.778 R2 F60\nX23 Y3\nX18 Y3\nX19 Y3\nX20 Y3\nX21 Y3\nX22 Y3\nG80\n"
        )
    );
}

#[test]
fn routs_are_slots_and_never_holes() {
    let board = list(&["tests/data/drill/rout.drl"]);
    assert_eq!(board["holes"], json!([[5, 5, 2.4]]));
    assert_eq!(
        board["slots"],
        json!([
            [0, 0, 10, 0, 1],
            {"from": [10, 0], "to": [10, 10], "diameter": 1, "direction": "ccw", "centre": [10, 5]},
            [10, 10, 0, 10, 1]
        ])
    );
    let file = "tests/data/drill/rout.drl";
    let text = program(&[file, "--as=gcode", "--depth=1", "--cycle=moves"]);
    // The tool stays down along the whole rout.
    assert!(
        text.contains("G1 Z-1 F60\nG1 X10 Y0 F60\nG3 X10 Y10 I0 J5 F60\nG1 X0 Y10 F60\nG0 Z2\n"),
        "{text}"
    );
    husillo()
        .args(["holes", file, "--as=gcode", "--depth=1", "--slots=drill"])
        .assert()
        .code(2)
        .stderr(contains("a curved slot cannot be drilled"));
}

#[test]
fn standard_input_and_output_to_a_file() {
    let file = scratch("from-stdin.json");
    let _ = std::fs::remove_file(&file);
    husillo()
        .args(["holes", "-", "--format", "json", "-o"])
        .arg(&file)
        .write_stdin("METRIC\nT1C1\n%\nT1X1.5Y2.\n")
        .assert()
        .success()
        .stdout(predicate::str::is_empty());
    let board: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    assert_eq!(board["holes"], json!([[1.5, 2, 1]]));
    husillo()
        .args(["check", "-", "--dialect", "excellon"])
        .write_stdin("")
        .assert()
        .success()
        .stdout(contains("no hole in <input>"));
}

/// The files that independent readers agree on, where they are at hand: see
/// `excellon/tests/corpus.rs`.
#[test]
fn every_hole_of_real_files_within_four_micrometres() {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/excellon");
    let folder = std::env::var_os("HUSILLO_EXCELLON").map_or(beside, PathBuf::from);
    let Ok(expected) = std::fs::read_dir(folder.join("expected")) else {
        println!("no drill files in {}: skipped", folder.display());
        return;
    };
    for entry in expected {
        let path = entry.unwrap().path();
        let file = folder.join(path.file_stem().unwrap());
        let wanted: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let board = list(&[file.to_str().unwrap()]);
        let (found, wanted_holes) = (points(&board), points(&wanted));
        assert_eq!(found.len(), wanted_holes.len(), "{}", file.display());
        for (hole, wanted) in found.iter().zip(&wanted_holes) {
            for index in 0..3 {
                assert!(
                    (hole[index] - wanted[index]).abs() <= 0.004,
                    "{}",
                    file.display()
                );
            }
        }
        let slots = board["slots"].as_array().unwrap().len() as u64;
        assert_eq!(Some(slots), wanted["slots"].as_u64(), "{}", file.display());
        check_says_whether_it_fits(file.to_str().unwrap(), &wanted_holes, slots > 0);
        if slots == 0 && !found.is_empty() {
            records_are_within_half_a_step(file.to_str().unwrap());
        }
        // The board of a layout program that does not sort its holes.
        if file.ends_with("gerbonara__tests__resources__kicad-older__chibi_2024.drl") {
            a_short_order_saves_a_quarter(file.to_str().unwrap());
        }
    }
}

/// The travel of the drill, as `compile` prints it.
fn a_short_order_saves_a_quarter(file: &str) {
    let order = ["--unbounded", "--shift", "corner", "--order", "shortest"];
    let said = printed(&[&["compile", file, "-m", "drill"], &order[..]].concat());
    let (_, saved) = said.split_once(" mm: ").unwrap();
    let (saved, _) = saved.split_once(" % less").unwrap();
    assert!(saved.parse::<u32>().unwrap() >= 25, "{said}");
}

/// `check -m drill` counts the holes that are off the table like the other readers, and reports
/// whether a shift of the board would help.
fn check_says_whether_it_fits(file: &str, holes: &[[f64; 3]], has_slots: bool) {
    let args = ["check", file, "--dialect", "excellon", "-m", "drill"];
    let output = husillo().args(args).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    let mut fits = true;
    for (axis, name, travel) in [(0, "X", 220.0), (1, "Y", 45.0)] {
        let places = || holes.iter().map(|hole| hole[axis]);
        // The readers agree to 4 um: holes that close to the edge would be on either side.
        assert!(
            places().all(|at| at.abs() > 0.004 || at == 0.0),
            "{file}: at the edge"
        );
        let off = places()
            .filter(|at| !(-1e-6..=travel + 1e-6).contains(at))
            .count();
        let beyond = format!("beyond the travel of {name}");
        let counted = match off {
            1 => "1 hole ".to_owned(),
            0..1000 => format!("{off} holes "),
            _ => format!("{},{:03} holes ", off / 1000, off % 1000),
        };
        if off > 0 {
            fits = false;
            assert!(
                said.contains(&counted) && said.contains(&beyond),
                "{file}: {said}"
            );
        } else if !has_slots {
            assert!(!said.contains(&beyond), "{file}: {said}");
        }
        if !has_slots && off > 0 {
            let width = places().fold(f64::MIN, f64::max) - places().fold(f64::MAX, f64::min);
            let moving_helps = said
                .split(&beyond)
                .nth(1)
                .and_then(|rest| rest.split("= help: ").nth(1))
                .is_some_and(|help| help.starts_with("it fits after a shift"));
            assert_eq!(moving_helps, width <= travel, "{file}, {name}: {said}");
        }
    }
    if !has_slots {
        assert_eq!(output.status.code(), Some(i32::from(!fits)), "{file}");
    }
}

fn bytes(args: &[&str]) -> Vec<u8> {
    let output = husillo().arg("holes").args(args).output().unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    output.stdout
}

/// The places of the records of a program, in steps.
fn drilled(program: &[u8]) -> Vec<[u16; 2]> {
    let (mut at, mut places) = ([0; 2], Vec::new());
    for record in records(program) {
        match record.unwrap() {
            Record::X(steps) => at[0] = steps,
            Record::Y(steps) => at[1] = steps,
            Record::Drill(_) => places.push(at),
        }
    }
    places
}

#[test]
fn records_of_one_tool() {
    let board = "../examples/board.drl";
    let program = bytes(&[board, "--as", "drill", "--only", "2"]);
    // 5 mm are 535 steps; 12.54 mm are 1341.78, 15.08 mm 1613.56, 34.5 mm 3691.5, rounded away from
    // zero.
    assert_eq!(
        drilled(&program),
        [[535, 1342], [535, 1614], [3692, 1614], [3692, 1342]]
    );
    assert_eq!(program.len(), 4 * 9 + 1);
    assert_eq!(program[..9], *b"X\x17\x02Y\x3e\x05Z\0\0");
    // Slots become holes, tools stay in their order, the order of holes is free.
    let args = [
        board,
        "--as=drill",
        "--only=4",
        "--only=1",
        "--order=shortest",
    ];
    let both = drilled(&bytes(&args));
    assert_eq!(both.len(), 16 + 7);
    assert_eq!(both[16..18], [[1819, 321], [2461, 321]]);
    // The same by tool, for programs.
    let listed: Value =
        serde_json::from_slice(&bytes(&[board, "--as=drill", "--format=json"])).unwrap();
    let tools = listed["tools"].as_array().unwrap();
    assert_eq!(tools.len(), 4);
    assert_eq!(tools[1]["holes"], 4);
    assert_eq!(tools[1]["records"][0], json!(["X", 535]));
    assert_eq!(tools[1]["records"][2], json!(["Z", 0]));
    assert_eq!(tools[3]["holes"], 7);
}

#[test]
fn records_that_cannot_be_are_refused_and_nothing_is_written() {
    let file = scratch("refused.cod");
    let _ = std::fs::remove_file(&file);
    for (args, code, message) in [
        (&["--as=drill"][..], 2, "T3 (3.2 mm, 2 holes)"),
        (&["--as=drill", "--only=7"], 2, "--only 7"),
        (
            &["--as=drill", "--only=4", "--slots=rout"],
            2,
            "cannot rout",
        ),
        (&["--as=drill", "--only=4", "--slots=refuse"], 2, "1 slot"),
        (
            &["--as=drill", "--only=3", "--shift=0,20"],
            1,
            "2 holes of ../examples/board.drl off the table",
        ),
        (
            &["--as=drill", "--only=3", "--shift=0,600", "--unbounded"],
            1,
            "Y626.5 is off the table, 0 to 612.476 mm",
        ),
        (&["--shift=1"], 2, "as in 5,-2.5"),
        (&["--shift=1e,2"], 2, "as in 5,-2.5"),
    ] {
        husillo()
            .args(["holes", "../examples/board.drl"])
            .args(args)
            .arg("-o")
            .arg(&file)
            .assert()
            .code(code)
            .stderr(contains(message));
        assert!(!file.exists(), "{args:?}");
    }
    husillo()
        .args(["holes", "tests/data/drill/faults.drl", "--as=drill", "-o"])
        .arg(&file)
        .assert()
        .code(1)
        .stderr(contains("nothing written"));
    husillo()
        .args(["holes", "-", "--as=drill", "-o"])
        .arg(&file)
        .write_stdin("METRIC\n%\nM30\n")
        .assert()
        .code(2)
        .stderr(contains("no hole"));
    assert!(!file.exists());
    let far = bytes(&[
        "../examples/board.drl",
        "--as=drill",
        "--only=3",
        "--shift=0,20",
        "--unbounded",
    ]);
    assert_eq!(drilled(&far), [[375, 4976], [3906, 4976]]);
}

#[test]
fn a_board_is_moved_and_checked_against_a_machine() {
    let board = list(&["../examples/board.drl", "--shift", "corner"]);
    assert_eq!(board["holes"][0], json!([6.5, 7, 0.8]));
    assert_eq!(board["slots"], json!([[13.5, 0, 19.5, 0, 1.5]]));
    let board = list(&[
        "../examples/board.drl",
        "--only",
        "3",
        "--shift",
        "-3.5mm,0.1in",
    ]);
    assert_eq!(board["holes"], json!([[0, 29.04, 3.2], [33, 29.04, 3.2]]));
    assert_eq!(board["tools"].as_array().unwrap().len(), 1);
    husillo()
        .args([
            "check",
            "../examples/board.drl",
            "-m",
            "drill",
            "--deny-warnings",
        ])
        .assert()
        .success();
    husillo()
        .args(["check", "-", "--dialect", "excellon", "-m", "drill"])
        .write_stdin("METRIC\nT1C1\n%\nT1\nX1.Y-2.\nX230.Y40.\nX231.Y50.\nM30\n")
        .assert()
        .code(1)
        .stdout(contains("2 holes of <input> beyond the travel of X"))
        .stdout(contains("X 1 to 231 mm; drill goes from 0 to 220 mm"))
        .stdout(contains("it is too large for a shift to help"))
        .stdout(contains("2 holes of <input> beyond the travel of Y"))
        .stdout(contains("2 errors"));
}

/// The program of the drill's own language means the same places as the records.
#[test]
fn the_drill_reads_the_places_of_a_board() {
    let holes = points(&list(&["../examples/board.drl", "--only", "1"]));
    let mut text = "%\nG21 G90 ; a board\n".to_owned();
    for [x, y, _] in &holes {
        text.push_str(&format!("X{x} Y{y}\n"));
    }
    let file = scratch("board.pcb");
    std::fs::write(&file, text + "G28 X0 Y0\n%\n").unwrap();
    for command in ["check", "run"] {
        husillo()
            .arg(command)
            .arg(&file)
            .args(["--dialect", "drill", "-m", "drill"])
            .args(if command == "run" {
                &["--format", "json"][..]
            } else {
                &[]
            })
            .assert()
            .success();
    }
    let output = husillo()
        .arg("commands")
        .arg(&file)
        .args(["-m", "drill", "--format", "json"]) // which names its dialect
        .output()
        .unwrap();
    let (mut at, mut found) = ([0; 2], Vec::new());
    for command in common::objects(&output.stdout) {
        match command["kind"].as_str().unwrap() {
            "rapid" => at = [0, 1].map(|axis: usize| command["to_nm"][axis].as_i64().unwrap()),
            "drill" => {
                let [x, y, _] = Table::DRILL.hole(at).unwrap();
                let (Record::X(x), Record::Y(y)) = (x, y) else {
                    panic!("{x} {y}")
                };
                found.push([x, y]);
            }
            other => panic!("{other}"),
        }
    }
    let args = ["../examples/board.drl", "--as=drill", "--only=1"];
    assert_eq!(found, drilled(&bytes(&args)));
    husillo()
        .arg("check")
        .arg("-")
        .args(["--dialect", "drill"])
        .write_stdin("G1 X1 F100\nX1 M3\nZ1\n")
        .assert()
        .code(1)
        .stdout(contains(
            "error[E0212]: known code `G1`, not of this dialect",
        ))
        .stdout(contains(
            "error[E0212]: known code `M3`, not of this dialect",
        ))
        .stdout(contains("error[E0201]: unknown word `Z`"));
}

#[test]
fn panels_are_copied() {
    let board = list(&["tests/data/drill/panel.drl"]);
    let holes = points(&board);
    // Two boards beside each other, and both once more above, turned over.
    let board_holes = [[1.0, 1.0, 0.8], [3.0, 1.0, 0.8], [2.0, 2.0, 1.2]];
    let by = |x: f64, y: f64, sign: f64| board_holes.map(|[at, y0, d]| [x + sign * at, y + y0, d]);
    let mut expected = by(0.0, 0.0, 1.0).to_vec();
    expected.extend(by(10.0, 0.0, 1.0));
    expected.extend(by(20.0, 5.0, -1.0));
    expected.extend(by(10.0, 5.0, -1.0));
    assert_eq!(holes, expected);
    assert_eq!(board["slots"].as_array().unwrap().len(), 4);
    assert_eq!(board["slots"][2], json!([18, 8, 17, 8, 1.2]));
    husillo()
        .args(["check", "-", "--dialect", "excellon"])
        .write_stdin("METRIC\nT1C1\n%\nT1\nM25\nX1.\nR9999X0.001\nM01\nR9999M02X1.\nM08\nM01\n")
        .assert()
        .code(1)
        .stdout(contains("error[E0910]: more than 2000000 holes"));
    husillo()
        .args(["check", "-", "--dialect", "excellon"])
        .write_stdin("METRIC\nT1C1\n%\nT1\nX1.\nM02X1.\n")
        .assert()
        .code(1)
        .stdout(contains("error[E0911]: step and repeat out of order"))
        .stdout(contains("M25, the pattern, M01"));
}

/// The records of a board of any size, moved to the corner, against its holes moved there.
fn records_are_within_half_a_step(file: &str) {
    let corner = [file, "--shift", "corner"];
    let mut wanted = points(&list(&corner));
    let args = [
        &corner[..],
        &["--as", "drill", "--unbounded", "--format", "json"],
    ]
    .concat();
    let listed: Value = serde_json::from_slice(&bytes(&args)).unwrap();
    let mut found = Vec::new();
    for tool in listed["tools"].as_array().unwrap() {
        let diameter = tool["diameter"].as_f64().unwrap();
        for hole in tool["records"].as_array().unwrap().chunks(3) {
            assert_eq!(hole[2], json!(["Z", 0]));
            let [x, y] = [0, 1].map(|axis: usize| hole[axis][1].as_f64().unwrap() / 107.0);
            found.push([x, y, diameter]);
        }
    }
    assert_eq!(found.len(), wanted.len(), "{file}");
    // By tool, then in the order of the file: the sort is stable.
    let by_diameter = |a: &[f64; 3], b: &[f64; 3]| a[2].total_cmp(&b[2]);
    found.sort_by(by_diameter);
    wanted.sort_by(by_diameter);
    for (found, wanted) in found.iter().zip(&wanted) {
        for axis in 0..2 {
            let off_by = (found[axis] - wanted[axis]).abs();
            assert!(off_by <= 0.004_673, "{file}: {found:?} {wanted:?}");
        }
    }
}

/// A board drilled from behind, 90 degrees turned, laid on two measured holes.
#[test]
fn a_board_is_mirrored_turned_and_laid_on_measured_holes() {
    let file = scratch("placed.drl");
    std::fs::write(
        &file,
        "M48\nMETRIC,TZ\nT1C0.8\n%\nT1\nX10.0Y5.0\nX60.0Y5.0\nX60.0Y25.0\nM30\n",
    )
    .unwrap();
    let path = file.to_str().unwrap();
    let holes = |args: &[&str]| -> Vec<[f64; 2]> {
        let holes = points(&list(&[&[path], args].concat()));
        holes.into_iter().map(|[x, y, _]| [x, y]).collect()
    };
    assert_eq!(holes(&["--mirror", "x"])[1], [-60.0, 5.0]);
    assert_eq!(holes(&["--turn", "90"])[2], [-25.0, 60.0]);
    assert_eq!(
        holes(&["--mirror", "x", "--turn", "-90", "--shift", "corner"]),
        [[0.0, 0.0], [0.0, 50.0], [20.0, 50.0]]
    );
    // Measured 0.1 mm higher at 50 mm, and 0.05 mm too long: the board turns about the middle of
    // the two and is not stretched.
    let measured = ["--reference", "10,5=12,5", "--reference", "60,5=62.05,5.1"];
    let placed = holes(&measured);
    assert!((placed[0][0] - 12.025).abs() < 1e-4 && (placed[1][1] - 5.1).abs() < 1e-3);
    husillo()
        .arg("holes")
        .arg(&file)
        .args(measured)
        .assert()
        .success()
        .stderr(contains(
            "turned by 0.1145 degrees; longer than the file by 1002 um/m",
        ))
        .stderr(contains("the worst reference is 25.0 um off"));
    let stretched = holes(&[&measured[..], &["--stretch"]].concat());
    assert!((stretched[0][0] - 12.0).abs() < 1e-6 && (stretched[1][0] - 62.05).abs() < 1e-6);
    for (args, reason) in [
        (&["--reference", "1,1=2,2"][..], "give two, or use --shift"),
        (&["--reference", "1,1"], "as in 5,5=5.02,4.97"),
        (&["--stretch"], "needs --reference"),
        (&["--turn", "nan"], "expected degrees"),
        (&["--turn", "1e300"], "expected degrees"),
        (
            &[
                "--reference",
                "10,5=12,5",
                "--reference",
                "60,5=12,55",
                "--reference",
                "60,25=32,55",
            ],
            "see --mirror",
        ),
        (
            &["--reference", "10,5=12,5", "--reference", "60,5=12,5"],
            "0.0 % as long as the file",
        ),
        (
            &["--reference", "10,5=12,5", "--reference", "60,5=60,5"],
            "96.0 % as long as the file",
        ),
        (
            &["--reference", "1,1=2,2", "--reference", "1,1=2,2"],
            "less than a millimetre apart",
        ),
    ] {
        husillo()
            .arg("holes")
            .arg(&file)
            .args(args)
            .assert()
            .code(2)
            .stderr(contains(reason));
    }
}
