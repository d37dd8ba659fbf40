//! What a machine has besides its axes: probe, curves, cutter compensation, inputs and outputs,
//! constant surface speed, tools. `check` refuses what a machine lacks as `run` does.

mod common;

use common::{husillo, json, number, printed, written};
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use serde_json::Value;

/// Runs a program on a machine with work zero where the program needs it, and returns the results.
fn run(name: &str, program: &str, machine: &str) -> Value {
    let file = written(name, program);
    let file = file.to_str().unwrap();
    let zero = match program == PROBING {
        true => "X20 Y20 Z0",
        false => "X0 Y0 Z0",
    };
    let rest = ["--zero", zero, "--format", "json"];
    json(&[&["run", file, "-m", machine][..], &rest].concat())
}

/// A machine file of the test: that of a built-in machine with more text.
fn machine(name: &str, built_in: &str, more: &str) -> String {
    let text = std::fs::read_to_string(format!("../machines/{built_in}.toml")).unwrap();
    let path = written(name, &format!("{text}\n{more}"));
    path.to_str().unwrap().to_owned()
}

/// A work piece is found from above and from a side, and its corner becomes work zero.
const PROBING: &str = "G21 G90 G54
G0 X25 Y25 Z4
G38.2 Z-10 F200
#1 = #5063
G0 Z4
X-5
Z-5
G38.2 X10 F200
#2 = #5061
G91 G0 X-2
G90 G10 L20 P1 X[#5420 - #2 - 1.0]
G0 Z4
G0 X0 Y25 Z[#1 - 1]
(PRINT)
M2
";

#[test]
fn a_probing_program_runs_end_to_end() {
    let results = run("probing.nc", PROBING, "router");
    let probes = results["probes"].as_array().unwrap();
    assert_eq!(probes.len(), 2);
    // The ball of 1 mm reports 10 um after its contact, to the step of 1.25 um in Z.
    let at = |probe: usize, axis: usize| number(&probes[probe]["position_nm"][axis]) / 1e6;
    assert!((at(0, 2) - 0.99).abs() <= 0.00125, "{probes:?}");
    assert!((at(1, 0) + 0.99).abs() <= 0.0025, "{probes:?}");
    assert!(probes.iter().all(|probe| probe["is_touched"] == true));
    // It ends at the corner in X, and with the ball on the surface in Z.
    let end = |axis: usize| number(&results["end_nm"][axis]) / 1e6;
    assert!(
        end(0).abs() < 0.003 && (end(2) + 0.01).abs() < 0.003,
        "{results}"
    );
}

#[test]
fn the_tip_is_corrected_on_request() {
    let text = std::fs::read_to_string("../machines/router.toml").unwrap();
    let text = text.replace("correct = false", "correct = true");
    let path = written("corrected.toml", &text);
    let results = run("corrected.nc", PROBING, path.to_str().unwrap());
    let probes = &results["probes"];
    let [z, x] = [(0, 2), (1, 0)].map(|(probe, axis): (usize, usize)| {
        number(&probes[probe]["position_nm"][axis]).abs() / 1e6
    });
    assert!(z < 0.003 && x < 0.003, "{probes}");
}

#[test]
fn the_summary_has_the_contacts() {
    let file = written(
        "summary.nc",
        "G0 X25 Y25 Z4\nG38.2 Z-10 F200\nG38.5 Z4 F50\nG38.3 Z3.5\n",
    );
    husillo()
        .args(["run", file.to_str().unwrap(), "-m", "router", "-o"])
        .arg(common::scratch("summary.html"))
        .assert()
        .success()
        .stdout(contains("Probed     X25.000000 Y25.000000 Z0.99").and(contains(": no contact")));
}

#[test]
fn a_contact_that_is_missed_ends_the_program() {
    for (program, reason) in [
        (
            "G0 X100 Y100 Z4\nG38.2 Z-10 F200\nG0 Z4\n",
            "line 2: the contact of the probe did not",
        ),
        (
            "G0 X25 Y25 Z0.5\nG38.2 Z-10 F200\n",
            "line 2: the contact of the probe had changed",
        ),
    ] {
        let file = written("missed.nc", program);
        husillo()
            .args([
                "run",
                file.to_str().unwrap(),
                "-m",
                "router",
                "--format",
                "json",
            ])
            .assert()
            .failure()
            .stderr(contains(reason));
    }
    // G38.3 goes on, and the program sees it.
    let program = "G0 X100 Y100 Z4\nG38.3 Z-10 F200\no1 if [#5070 EQ 0]\nG0 X1\no1 endif\nM2\n";
    let results = run("optional.nc", program, "router");
    assert_eq!(number(&results["end_nm"][0]), 1e6);
    assert_eq!(results["probes"][0]["is_touched"], false);
}

#[test]
fn check_refuses_what_the_machine_lacks_as_run_does() {
    let lacks = [
        ("G38.2 Z-1 F10\n", "a probe"),
        ("G5 X1 Y1 I1 J0 P0 Q-1 F10\n", "splines"),
        ("M64 P0\n", "an input or output of this number"),
        ("M66 P0 L3 Q1\n", "an input or output of this number"),
        ("M68 E0 Q1\n", "an input or output of this number"),
        ("G96 S100 M3\n", "constant surface speed"),
        ("M19 R0\n", "a spindle held at an angle"),
        ("M52 P1\n", "a feed from an input"),
    ];
    for (program, means) in lacks {
        let file = written("lacks.nc", program);
        let file = file.to_str().unwrap();
        for command in ["check", "run", "steps"] {
            let mut call = husillo();
            call.args([command, file, "-m", "micromill", "--dialect", "rs274"]);
            if command == "steps" {
                call.args(["-o", "-"]);
            }
            let message = format!("micromill has no means for {means}");
            let output = call.output().unwrap();
            let printed = [output.stdout, output.stderr].concat();
            let printed = String::from_utf8_lossy(&printed);
            assert!(
                !output.status.success() && printed.contains(&message),
                "{printed}"
            );
        }
    }
    // The same program runs where the machine has them.
    for (program, _) in &lacks[1..7] {
        let file = written("has.nc", program);
        printed(&["check", file.to_str().unwrap(), "-m", "free"]);
        printed(&[
            "run",
            file.to_str().unwrap(),
            "-m",
            "free",
            "--format",
            "json",
        ]);
    }
}

/// The tool keeps its radius from the contour in `check`, `run`, `steps` and `commands`.
#[test]
fn cutter_compensation_runs_as_it_is_checked() {
    let program =
        "G0 X50 Y50 Z1\nT2 M6\nG1 G41.1 D4 X60 Y60 F600\nX100\nY100\nX60\nY60\nG40 X50 Y50\nM2\n";
    let file = written("compensated.nc", program);
    let file = file.to_str().unwrap();
    printed(&["check", file, "-m", "router"]);
    let commands = printed(&["commands", file]);
    let results = run("compensated.nc", program, "router");
    // 2 mm to the left of the contour, which goes counter-clockwise: inside.
    assert!(commands.contains("linear X98 Y62"), "{commands}");
    let high = |axis: usize| number(&results["max_nm"][axis]);
    assert_eq!([high(0), high(1)], [98e6, 98e6]);
    assert!(number(&results["max_deviation_nm"]) < 2500.0, "{results}");
    let steps = printed(&["steps", file, "-m", "router", "-o", "-"]);
    let end = steps.lines().skip(1).fold([0, 0, 0], |mut end, row| {
        let fields: Vec<i64> = row.split(',').map(|field| field.parse().unwrap()).collect();
        for axis in 0..3 {
            end[axis] += fields[2 + axis];
        }
        end
    });
    assert_eq!([end[0], end[1]], [20_000, 20_000]);
    // A program that ends without G40 also makes its last move.
    let open = program.replace("G40 X50 Y50\nM2\n", "");
    let results = run("open.nc", &open, "router");
    assert_eq!(number(&results["end_nm"][0]), 62e6);
}

#[test]
fn curves_are_drawn_and_measured() {
    let program = "G0 X10 Y10 Z1\nG5 X60 Y20 I20 J40 P-20 Q-20 F1200\nG5.1 X80 Y40 I10 J0\nM2\n";
    for name in ["router", "free"] {
        let results = run("curves.nc", program, name);
        let [x, y] = [0, 1].map(|axis: usize| number(&results["end_nm"][axis]));
        assert_eq!([x, y], [80e6, 40e6]);
        let step = if name == "free" { 1000.0 } else { 2500.0 };
        assert!(
            number(&results["max_deviation_nm"]) < 1.46 * step,
            "{results}"
        );
        // Lengths of both curves, by another program.
        let feed = number(&results["feed_nm"]) / 1e6;
        assert!((feed - (63.4 + 29.6)).abs() < 3.0, "{feed}");
    }
    // A NURBS: a quarter of a circle of 30 mm radius.
    let circle = "G0 X40 Y10 Z1\nG5.2 X40 Y40 P0.70710678 L3 F1200\nX10 Y40 P1\nG5.3\nM2\n";
    let results = run("nurbs.nc", circle, "router");
    let [x, y] = [0, 1].map(|axis: usize| number(&results["end_nm"][axis]));
    assert_eq!([x, y], [10e6, 40e6]);
    assert!(number(&results["max_nm"][0]) < 40.003e6, "{results}");
    let arc = std::f64::consts::FRAC_PI_2 * 30e6;
    assert!((number(&results["feed_nm"]) - arc).abs() < 2e3, "{results}");
    let [most, rms] = ["max_deviation_nm", "rms_deviation_nm"].map(|key| number(&results[key]));
    assert!(
        most < 1.46 * 2500.0 && (100.0..2500.0).contains(&rms),
        "{results}"
    );
    // The curve leaves the table between its ends, which are on it.
    let file = written(
        "beyond.nc",
        "G0 X10 Y0 Z1\nG5 X60 Y0 I20 J-40 P-20 Q-40 F1200\nM2\n",
    );
    husillo()
        .args([
            "check",
            file.to_str().unwrap(),
            "-m",
            "router",
            "--zero",
            "X0 Y0 Z0",
        ])
        .assert()
        .failure()
        .stdout(contains("the part reaches Y -29.99"));
}

#[test]
fn tools_of_the_machine_have_length_and_diameter() {
    let tools = "[[tool]]\nnumber = 3\nlength = \"12 mm\"\ndiameter = \"4 mm\"\n\
                 [[tool]]\nnumber = 7\ndiameter = \"6 mm\"\n";
    let path = machine("tools.toml", "free", tools);
    let program = "T3 M6\nG43 H3\nG0 Z1\nG0 X50 Y50\nT7 M6\nG1 G41 X60 Y60 F600\nX100\nM2\n";
    let results = run("tools.nc", program, &path);
    // Z with the length of tool 3; Y with the radius of tool 7.
    let high = |axis: usize| number(&results["max_nm"][axis]);
    assert_eq!([high(1), high(2)], [63e6, 13e6]);
    let bad = machine("bad.toml", "free", "[[tool]]\nlength = \"1 mm\"\n");
    let file = written("any.nc", "G0 X1\n");
    husillo()
        .args(["check", file.to_str().unwrap(), "-m", &bad])
        .assert()
        .failure()
        .stderr(contains("missing key `number`"));
}

#[test]
fn inputs_and_outputs_run_where_they_are() {
    let program = "G1 X1 F600\nM62 P1\nM67 E0 Q2.5\nX2\nM64 P3\nM66 P2 L3 Q5\n\
                   o1 if [#5399 EQ 1]\nX3\no1 endif\nM66 P0 L0\nM2\n";
    let results = run("outputs.nc", program, "router");
    assert_eq!(number(&results["end_nm"][0]), 3e6);
    let file = written("beyond_outputs.nc", "M64 P4\n");
    husillo()
        .args(["check", file.to_str().unwrap(), "-m", "router"])
        .assert()
        .failure()
        .stdout(contains(
            "router has no means for an input or output of this number",
        ));
}

#[test]
fn the_surface_speed_of_a_facing_cut_is_constant() {
    // G95: the feed follows the spindle, whose speed rises toward the axis.
    let program = "G8 G18\nG0 X40 Z1\nG97 S300 M3\nG96 S90 D3000\nG95 F0.1\nG1 X2\nM5\nM2\n";
    let results = run("facing.nc", program, "lathe");
    // The time of 380 turns at 90 m/min on radii from 40 to 2 mm: sum of 2 pi r / v.
    let turns = 2.0 * std::f64::consts::PI * (40.0_f64.powi(2) - 4.8_f64.powi(2)) / 2.0 / 0.1;
    let limited = (4.8 - 2.0) / 0.1 / 3000.0 * 60.0;
    let wanted = turns / 90e3 * 60.0 + limited;
    let seconds = number(&results["duration_s"]);
    assert!(
        (seconds - wanted).abs() < 0.05 * wanted,
        "{seconds} for {wanted}"
    );
}
