//! `husillo compare` as a user runs it.

use assert_cmd::Command;
use predicates::str::contains;
use serde_json::Value;

fn husillo() -> Command {
    Command::cargo_bin("husillo").expect("the program is built")
}

fn compare(arguments: &[&str]) -> Vec<Value> {
    let output = husillo()
        .arg("compare")
        .args(arguments)
        .args(["--format", "json"])
        .output()
        .expect("it runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let compared: Value = serde_json::from_slice(&output.stdout).expect("an object");
    compared["methods"]
        .as_array()
        .expect("a list of objects")
        .clone()
}

fn row<'a>(rows: &'a [Value], method: &str) -> &'a Value {
    rows.iter()
        .find(|row| row["method"] == method)
        .unwrap_or_else(|| panic!("no {method}"))
}

fn number(row: &Value, key: &str) -> f64 {
    row[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key} of {row}"))
}

/// The circle every description of these methods begins with, with its true errors.
#[test]
fn a_circle_of_thirty_steps() {
    let rows = compare(&["circle", "--radius", "30"]);
    assert_eq!(rows.len(), 6);
    for (method, iterations, moving, largest) in [
        ("staircase-printed", 240, 240, 0.983),
        ("dda-printed", 188, 180, 0.887),
        ("direct-search-printed", 168, 168, 0.453),
        ("direct-search", 168, 168, 0.453),
    ] {
        let row = row(&rows, method);
        assert_eq!(row["iterations"], iterations, "{method}");
        assert_eq!(row["moving"], moving, "{method}");
        assert!(
            (number(row, "max_error_blu") - largest).abs() < 5e-4,
            "{method}"
        );
    }
    let error = |method| number(row(&rows, method), "max_error_blu");
    assert!(error("staircase") < 0.7072 && error("staircase") < error("staircase-printed"));
    assert!(error("dda") < error("dda-printed"));
}

#[test]
fn every_object_has_its_fields() {
    for row in compare(&["circle", "--radius", "1000"]) {
        for key in [
            "max_error_blu",
            "rms_error_blu",
            "mean_speed",
            "ripple_percent",
        ] {
            assert!(number(&row, key) > 0.0, "{key} of {row}");
        }
        assert!(row["iterations"].as_u64() >= row["moving"].as_u64());
        let windows = row["ripple_percent_windows"].as_array().expect("a list");
        let events: Vec<_> = windows
            .iter()
            .map(|window| window["events"].as_u64())
            .collect();
        assert_eq!(events, [1, 8, 32, 128].map(Some));
        let total = row["points"]["total"].as_f64().expect("a number");
        assert!((0.0..=100.0).contains(&total));
    }
}

#[test]
fn vector_feed_keeps_the_speed() {
    let rows = compare(&["circle", "--radius", "1000", "--only", "direct-search,dda"]);
    assert_eq!(rows.len(), 2);
    let search = row(&rows, "direct-search");
    assert!((number(search, "mean_speed") - 1.111).abs() < 1e-3);
    assert!(number(search, "ripple_percent") > 27.0);
    assert!((number(&search["vector_feed"], "mean_speed") - 1.0).abs() < 1e-3);
    assert!(number(&search["vector_feed"], "ripple_percent") < 0.1);
    assert!(row(&rows, "dda")["vector_feed"].is_null());
}

#[test]
fn lines() {
    let rows = compare(&["line", "--to", "1000,500"]);
    let methods: Vec<_> = rows.iter().map(|row| row["method"].as_str()).collect();
    assert_eq!(methods, ["dda-printed", "dda", "bresenham"].map(Some));
    assert_eq!(row(&rows, "bresenham")["iterations"], 1000);
    assert_eq!(row(&rows, "dda-printed")["iterations"], 1119);
    assert!(number(row(&rows, "bresenham"), "max_error_blu") <= 0.5);
    assert!(number(row(&rows, "dda"), "max_error_blu") < 0.7072);
    assert_eq!(compare(&["line", "--to", "5,-4,3,2,1,0"]).len(), 3);
}

#[test]
fn partial_arcs_both_ways() {
    let arc = ["arc", "--from", "50,0", "--to", "0,50", "--centre", "0,0"];
    let quarter = compare(&arc);
    assert_eq!(quarter.len(), 6);
    let back = compare(&[&arc[..], &["--direction", "cw"]].concat());
    for (quarter, back) in quarter.iter().zip(&back) {
        assert!(number(back, "iterations") > 2.5 * number(quarter, "iterations"));
    }
}

/// Methods with whole-step centres report it, and the general one continues.
#[test]
fn a_centre_between_the_steps() {
    let arc = [
        "arc", "--from", "10,0", "--to", "0,10", "--centre", "0.5,0.5",
    ];
    assert_eq!(compare(&arc).len(), 1);
    husillo()
        .arg("compare")
        .args(arc)
        .assert()
        .success()
        .stdout(contains("staircase: its centre must be a whole step"));
    husillo()
        .arg("compare")
        .args(arc)
        .args(["--only", "dda"])
        .assert()
        .code(2);
}

#[test]
fn a_program() {
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/circles.nc");
    let rows = compare(&[example, "-m", "micromill"]);
    assert_eq!(rows.len(), 9);
    let search = rows
        .iter()
        .find(|row| row["method"] == "direct-search")
        .expect("it is there");
    assert_eq!(
        (&search["shape"], &search["moves"]),
        (&"arc".into(), &3.into())
    );
    // Circles of 3, 2 and 1 mm in steps of 140 nm: 4 sqrt(2) events a step of radius.
    assert!((number(search, "iterations") - 242_436.0).abs() < 12.0);
    assert!(number(search, "max_error_blu") < 0.501);
}

/// A move of four axes takes an event for each step of the axis with the most: 90 degrees of A in
/// steps of 0.0125 degrees. The other axes stay within a step of the line.
#[test]
fn a_program_of_four_axes() {
    let program = concat!(env!("CARGO_TARGET_TMPDIR"), "/four-axes.nc");
    std::fs::write(
        program,
        "G21 G90 G94\nG1 X10 Y3 Z-2 A90 F100\nX0 Y0 Z0 A0\nM2\n",
    )
    .unwrap();
    let rows = compare(&[program, "-m", "router4"]);
    let bresenham = row(&rows, "bresenham");
    assert_eq!(bresenham["iterations"], 2 * 7200);
    // Half a step in each of the three shorter axes.
    assert!(number(bresenham, "max_error_blu") < 0.75_f64.sqrt() + 0.01);
    for row in &rows {
        assert_eq!(row["moves"], 2, "{row}");
        assert!(number(row, "iterations") >= 14_400.0, "{row}");
    }
}

#[test]
fn weights_decide() {
    let total = |weights: &str, method: &str| {
        let rows = compare(&["circle", "--weights", weights]);
        row(&rows, method)["points"]["total"]
            .as_f64()
            .expect("a number")
    };
    assert_eq!(total("0,1,0,0", "direct-search"), 100.0);
    assert_eq!(total("0,1,0,0", "staircase"), 70.0);
    assert!(total("3,3,3,1", "direct-search") > total("3,3,3,1", "dda"));
    for weights in ["1,2,3", "0,0,0,0", "a,b,c,d", "-1,1,1,1"] {
        husillo()
            .args(["compare", "circle", "--weights", weights])
            .assert()
            .code(2)
            .stderr(contains("--weights"));
    }
}

#[test]
fn what_is_refused() {
    for (arguments, message) in [
        (&["circle", "--radius", "0"][..], "--radius"),
        (&["circle", "--only", "ratio"], "unknown method `ratio`"),
        (&["circle", "--to", "1,2"], "takes no"),
        (&["line"], "needs --to"),
        (&["line", "--to", "0,0"], "--to"),
        (&["arc", "--from", "1,2"], "needs --to"),
        (&["no-such-file.nc"], "no-such-file.nc"),
    ] {
        husillo()
            .arg("compare")
            .args(arguments)
            .assert()
            .code(2)
            .stderr(contains(message));
    }
}

#[test]
fn a_program_with_errors() {
    husillo()
        .args(["compare", "-"])
        .write_stdin("G1 X1\nG99\n")
        .assert()
        .code(1);
}

/// The page stands alone: a picture, the matrix, no network.
#[test]
fn a_page() {
    let folder = std::env::temp_dir().join(format!("husillo-compare-{}", std::process::id()));
    let page = folder.join("circle.html");
    husillo()
        .args(["compare", "circle", "-o"])
        .arg(&page)
        .assert()
        .success();
    let text = std::fs::read_to_string(&page).expect("it was written");
    std::fs::remove_dir_all(&folder).expect("it is ours");
    assert!(text.contains("<svg") && text.contains("type=\"number\"") && !text.contains("http"));
    assert!(text.contains("at a quadrant border") && text.contains("class=\"m-direct-search\""));
    assert!(!text.contains("NaN"));
}

/// `interpolate` walks them all.
#[test]
fn methods_by_name() {
    for (method, iterations) in [
        ("staircase", 240),
        ("staircase-printed", 240),
        ("dda-printed", 188),
    ] {
        let output = husillo()
            .args([
                "interpolate",
                "arc",
                "--from",
                "0,30",
                "--to",
                "0,30",
                "--centre",
                "0,0",
            ])
            .args(["--direction", "cw", "--method", method, "--format", "json"])
            .output()
            .expect("it runs");
        let walk: Value = serde_json::from_slice(&output.stdout).expect("an object");
        assert_eq!(walk["iterations"], iterations, "{method}");
    }
    husillo()
        .args(["interpolate", "line", "--to", "5,2", "--method", "dda"])
        .assert()
        .success();
}

/// The rules of motion on a program of chords: limited jerk takes little more time, and only its
/// acceleration does not jump.
#[test]
fn rules_of_motion() {
    let output = husillo()
        .args(["compare", "motion", "../examples/spirograph.nc"])
        .args(["-m", "router", "--window", "10", "--format", "json"])
        .output()
        .expect("it runs");
    let compared: Value = serde_json::from_slice(&output.stdout).expect("an object");
    let rules = compared["rules"].as_array().expect("a list of objects");
    let names: Vec<_> = rules.iter().map(|rule| rule["rule"].as_str()).collect();
    let names: Vec<_> = names.into_iter().flatten().collect();
    assert_eq!(names, ["trapezoid", "jerk", "grbl", "klipper"]);
    let [trapezoid, jerk] = [&rules[0], &rules[1]];
    assert!(trapezoid["jerk"].is_null() && number(trapezoid, "acceleration_jump") > 0.0);
    let limit = number(jerk, "acceleration") / 0.01;
    assert!(number(jerk, "jerk") <= limit * 1.000_001, "{jerk}");
    let ratio = number(jerk, "seconds") / number(trapezoid, "seconds");
    assert!((0.999..1.04).contains(&ratio), "{ratio}");
}

#[test]
fn motion_needs_a_program_and_ramps() {
    for (arguments, why) in [
        (&["motion"][..], "which program"),
        (&["motion", "../examples/gear.nc", "-m", "free"], "no ramps"),
        (
            &[
                "motion",
                "../examples/gear.nc",
                "-m",
                "router",
                "--window",
                "0",
            ],
            "not above 0",
        ),
        (&["circle", "../examples/gear.nc"], "only motion takes"),
    ] {
        let run = husillo().arg("compare").args(arguments).assert();
        run.code(2).stderr(contains(why));
    }
}
