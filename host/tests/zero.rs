//! `--zero`: where on the machine a program lies.

mod common;

use common::{husillo, json, written};
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use serde_json::Value;
use std::path::PathBuf;

/// From -20 to 20 mm in X, from -3 to 17 mm in Y, from -1 to 5 mm in Z.
const PART: &str =
    "G21 G90\nG0 Z5\nG0 X-20 Y-3\nG1 Z-1 F100\nG2 X20 Y-3 I20 J0\nG1 X-19\nG1 X-18\nG0 Z5\nM2\n";

fn file(name: &str, text: &str) -> String {
    written(name, text).to_str().unwrap().to_owned()
}

/// The errors of a check.
fn errors(args: &[&str]) -> Vec<Value> {
    let output = husillo()
        .args([&["check", "--format", "json"], args].concat())
        .output()
        .unwrap();
    let mut all = common::findings(&output.stdout);
    all.retain(|found| found["severity"] == "error");
    all
}

#[test]
fn one_error_with_the_move_that_cures_it() {
    let part = file("zero-one.nc", PART);
    let found = errors(&[&part, "-m", "router", "--zero", "X0"]);
    assert_eq!(found.len(), 1, "{found:?}");
    let error = &found[0];
    assert_eq!(
        error["message"],
        "the part reaches X -20 to 20 mm, Y -3 to 17 mm, and router X 0 to 300 mm, Y 0 to 180 mm: \
         move zero by at least X 20, Y 3"
    );
    // Where it leaves the table first.
    assert_eq!([&error["line"], &error["column"]], [3, 4]);
    let help = error["help"].as_str().unwrap();
    let cure = help.split('`').nth(1).unwrap();
    assert_eq!(cure, "--zero X20Y3");
    let zero = cure.split(' ').nth(1).unwrap();
    assert!(errors(&[&part, "-m", "router", "--zero", zero]).is_empty());
    // Not a micrometre less.
    for less in ["X19.99Y3", "X20Y2.99"] {
        assert_eq!(errors(&[&part, "-m", "router", "--zero", less]).len(), 1);
    }
    // From elsewhere the advice is where it comes to, with the axes that may stay.
    let found = errors(&[&part, "-m", "router", "--zero", "X300Y10Z-3"]);
    let help = found[0]["help"].as_str().unwrap();
    assert!(help.contains("`--zero X280Y10Z-3`"), "{help}");
}

#[test]
fn without_a_zero_it_is_placed_where_it_fits() {
    let part = file("zero-placed.nc", PART);
    let placed = "zero-placed.nc: placed in the middle of router, as with --zero X150Y83Z0";
    for command in ["check", "run", "steps"] {
        let written = common::scratch(&format!("zero-placed-{command}"));
        let mut husillo = husillo();
        husillo.args([command, &part, "-m", "router"]);
        if command != "check" {
            husillo.arg("-o").arg(&written);
        }
        husillo.assert().success().stderr(contains(placed));
    }
    // It is the same run as the stated one.
    let run =
        |more: &[&str]| json(&[&["run", &part, "-m", "router", "--format", "json"], more].concat());
    assert_eq!(run(&[]), run(&["--zero", "fit"]));
    assert_eq!(run(&[]), run(&["--zero", "X150Y83Z0"]));
    let inside = file("zero-inside.nc", "G21 G90\nG0 X5 Y5\nG1 Z-1 F100\nM2\n");
    husillo()
        .args(["check", &inside, "-m", "router"])
        .assert()
        .success()
        .stderr("");
    // Machine coordinates are where they are, and a part that is too long stays too long.
    for (text, why) in [
        (
            "G21 G90\nG0 X-5\nG53 G0 Z20\nM2\n",
            "machine coordinates of Z",
        ),
        ("G21 G90\nG0 X-5\nG0 X400\nM2\n", "it does not fit"),
    ] {
        let outside = file("zero-outside.nc", text);
        husillo()
            .args(["check", &outside, "-m", "router"])
            .assert()
            .code(1)
            .stdout(contains(why))
            .stderr(contains("placed").not());
    }
}

/// Programs have their zero in the middle of the stock, or at its corner.
#[test]
fn centre_and_corner_are_those_of_the_table() {
    let part = file("zero-centre.nc", PART);
    for (zero, said) in [
        ("centre", "--zero X150Y90Z0"),
        ("center", "--zero X150Y90Z0"),
        ("corner", "--zero X0Y0Z0"),
    ] {
        let output = husillo()
            .args(["check", &part, "-m", "router", "--zero", zero])
            .output()
            .unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.contains(said), "{zero}: {told}");
        assert_eq!(output.status.success(), zero != "corner");
    }
}

#[test]
fn fit_puts_it_into_the_middle() {
    let part = file("zero-fit.nc", PART);
    husillo()
        .args(["commands", &part, "-m", "router", "--zero", "fit"])
        .assert()
        .success()
        .stderr(contains("--zero X150Y83Z0"));
    assert!(errors(&[&part, "-m", "router", "--zero", "fit"]).is_empty());
    // The highest Z comes to the upper end of Z, 5 mm.
    let high = file("zero-high.nc", &PART.replace("Z5", "Z12.5"));
    husillo()
        .args(["check", &high, "-m", "router", "--zero", "fit"])
        .assert()
        .success()
        .stderr(contains("--zero X150Y83Z-7.5"));
    // A part as large as the table fits exactly, one that is larger does not.
    let whole = file("zero-whole.nc", "G0 X-1.2345 Y2\nX298.7655\nM2\n");
    assert!(errors(&[&whole, "-m", "router", "--zero", "fit"]).is_empty());
    let large = file("zero-large.nc", "G0 X-1 Y2\nX-2\nX300\nX301\nM2\n");
    for zero in ["fit", "X1"] {
        let found = errors(&[&large, "-m", "router", "--zero", zero]);
        assert_eq!(found.len(), 1, "{found:?}");
        let message = found[0]["message"].as_str().unwrap();
        assert_eq!(
            message,
            "the part is 303 mm long in X, and router has 300 mm: it does not fit"
        );
    }
}

/// A program has the same steps at every position, and its results count from work zero.
#[test]
fn the_same_steps_wherever_it_lies() {
    let part = PART
        .replace("X-20 Y-3", "X5 Y5")
        .replace("X20 Y-3", "X45 Y5");
    let part = file("zero-steps.nc", &part.replace("X-1", "X1"));
    let steps = |zero: &[&str]| {
        let args = [&["steps", &part, "-m", "router", "-o", "-"], zero].concat();
        common::printed(&args)
    };
    let results = |zero: &[&str]| {
        let args = [&["run", &part, "-m", "router", "--format", "json"], zero].concat();
        json(&args)
    };
    let (there, run) = (steps(&[]), results(&[]));
    assert!(there.lines().count() > 1000);
    for zero in ["X0", "X20Y30Z-3", "X12.5Y0.0025", "fit"] {
        assert!(steps(&["--zero", zero]) == there, "{zero}");
        assert_eq!(results(&["--zero", zero]), run, "{zero}");
    }
}

/// With backlash, coils and a map by position, too: the simulated position is the reported one.
#[test]
fn the_simulated_machine_is_there() {
    let part = file("zero-mill.nc", "G21 G90 F1\nG1 X0.2 Y0.1\nX0.1\nX0.2\nM2\n");
    let run = |zero: &[&str]| json(&[&["run", &part, "--format", "json"], zero].concat());
    let (here, there) = (run(&[]), run(&["--zero", "X4.2Y2.1Z1.4"]));
    assert_eq!(here, there);
    // The play that is simulated by place is that of the place.
    let worn = ["X0", "X4.2Y2.1"].map(|zero| run(&["--worn", "--zero", zero]));
    assert_ne!(worn[0]["max_deviation_nm"], worn[1]["max_deviation_nm"]);
}

#[test]
fn machine_coordinates_are_not_shifted() {
    let text = PART.replace(
        "G0 Z5\nM2",
        "G53 G0 Z4\nG28 X0\nG10 L2 P2 X50 Y50\nG55 G0 X1 Y1\nM2",
    );
    let part = file("zero-machine.nc", &text);
    let output = husillo()
        .args([
            "commands", &part, "-m", "router", "--zero", "X100Y90", "--format", "json",
        ])
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<Value> = text
        .lines()
        .map(|row| serde_json::from_str(row).unwrap())
        .collect();
    let moves: Vec<&Value> = rows
        .iter()
        .filter(|row| row.get("to_nm").is_some())
        .collect();
    assert_eq!(
        moves[1]["to_nm"],
        serde_json::json!([80_000_000, 87_000_000, 5_000_000])
    );
    let last = moves.last().unwrap();
    assert_eq!(
        last["to_nm"],
        serde_json::json!([51_000_000, 51_000_000, 4_000_000])
    );
    assert!(errors(&[&part, "-m", "router", "--zero", "X100Y90"]).is_empty());
    // What is beyond in the machine's own coordinates is an error of its own, and no zero cures it.
    let beyond = file(
        "zero-beyond.nc",
        &PART.replace("G0 Z5\nM2", "G53 G0 X301\nG53 X302\nM2"),
    );
    husillo()
        .args(["check", &beyond, "-m", "router", "--zero", "fit"])
        .assert()
        .code(1)
        .stdout(contains("machine coordinates of X reach 301 to 302 mm"))
        .stdout(contains("--zero does not move it").and(contains("1 error, ")));
    assert_eq!(errors(&[&beyond, "-m", "router"]).len(), 2);
}

/// The part is placed, so that its position is no error beside the others. One that fits nowhere
/// still is.
#[test]
fn other_errors_stay() {
    let text = PART.replace("G1 X-19", "G1 X-19 U2\nG1 X1.2.3");
    let part = file("zero-others.nc", &text);
    let codes = |part: &str, zero: &[&str]| {
        let found = errors(&[&[part, "-m", "router"], zero].concat());
        let codes = found.iter().map(|error| error["code"].to_string());
        codes.collect::<Vec<_>>().join(" ")
    };
    assert_eq!(codes(&part, &[]), r#""E0201" "E0102""#);
    assert_eq!(
        codes(&part, &["--zero", "X0"]),
        r#""E0201" "E0102" "E0401""#
    );
    let long = file(
        "zero-long.nc",
        &text.replace("G0 Z5\nM2", "G0 Z5\nG0 X600\nM2"),
    );
    // Too long in X, and beyond in Y at machine zero.
    assert_eq!(codes(&long, &[]), r#""E0201" "E0102" "E0401" "E0401""#);
}

#[test]
fn zeros_that_are_none() {
    let part = file("zero-none.nc", PART);
    for zero in ["20", "X", "A1", "X1X2", "middle"] {
        husillo()
            .args(["check", &part, "--zero", zero])
            .assert()
            .code(2)
            .stderr(contains("--zero"));
    }
}

/// A program from a pipe is read more than once, too.
#[test]
fn from_standard_input() {
    husillo()
        .args(["check", "-", "-m", "router", "--zero", "fit"])
        .write_stdin(PART)
        .assert()
        .success();
    husillo()
        .args(["check", "-", "-m", "router", "--zero", "Z0"])
        .write_stdin(PART)
        .assert()
        .code(1)
        .stdout(contains("move zero by at least X 20, Y 3"));
}

/// Of the real programs that a machine without limits takes, those that are small enough fit the
/// router.
#[test]
fn real_programs_fit_by_their_size() {
    let beside = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/gcode"));
    let folder = std::env::var_os("HUSILLO_CORPUS").map_or(beside, PathBuf::from);
    let mut folders = vec![folder.join("programs")];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else {
            return eprintln!("no corpus in {}: skipped", folder.display());
        };
        for path in entries.map(|entry| entry.unwrap().path()) {
            match path.metadata().unwrap() {
                entry if entry.is_dir() => folders.push(path),
                entry if entry.len() < 20_000 => files.push(path),
                _ => {}
            }
        }
    }
    files.sort();
    let (mut fitting, mut taken) = (0, 0);
    for path in files.iter().step_by(4) {
        let path = path.to_str().unwrap();
        if !errors(&[path, "-m", "free"]).is_empty() {
            continue;
        }
        taken += usize::from(errors(&[path, "-m", "router", "--zero", "X0"]).is_empty());
        let unsaid = errors(&[path, "-m", "router"]);
        let found = errors(&[path, "-m", "router", "--zero", "fit"]);
        fitting += usize::from(found.is_empty());
        // Without a zero it lies at machine zero or as with `fit`.
        assert!(found.is_empty() <= unsaid.is_empty(), "{path}: {unsaid:?}");
        for error in &found {
            let message = error["message"].as_str().unwrap();
            let is_told = ["does not fit", "machine coordinates"]
                .iter()
                .any(|why| message.contains(why));
            assert!(is_told || error["code"] != "E0401", "{path}: {message}");
        }
    }
    assert!(
        fitting > taken,
        "{fitting} with --zero fit, {taken} without"
    );
}

/// The position of a program with errors is not known: `fit` does not report it, the error is
/// reported.
#[test]
fn a_wrong_program_is_not_placed() {
    let wrong = file("zero-wrong.nc", "G21 G90\nO1001 jump\nG0 X-5\nM2\n");
    husillo()
        .args(["check", &wrong, "-m", "router", "--zero", "fit"])
        .assert()
        .code(1)
        .stderr(contains("--zero").not());
}
