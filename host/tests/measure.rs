//! `husillo measure` and `husillo emulate`, as a user calls them.

mod common;
mod emulated;

use common::{husillo, measured, near, number, printed, scratch, written};
use emulated::Emulated;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::net::TcpListener;

#[test]
fn moves_end_within_a_count() {
    let goals = ["1200", "-777", "3", "7999", "-8000", "-7999", "0", "1"];
    let args: Vec<&str> = goals.iter().flat_map(|goal| ["goto", goal]).collect();
    for (row, goal) in measured(&args).iter().zip(goals) {
        near(&row["position"], goal.parse().unwrap(), 1.0);
    }
    // In millimetres, on any axis.
    let rows = measured(&["-m", "cmm3", "--axis", "z", "goto", "1.5", "goto", "-0.1"]);
    near(&rows[0]["position"], 1.5, 0.002);
    near(&rows[1]["position"], -0.1, 0.002);
    assert_eq!(
        (&rows[0]["unit"], &rows[0]["axis"]),
        (&"mm".into(), &"Z".into())
    );
}

#[test]
fn all_axes_go_in_straight_lines() {
    let rows = measured(&[
        "-m", "cmm3", "goto", "X1.5", "y-2", "Z0.25", "goto", "z-1", "X0", "goto", "Y-2", "status",
    ]);
    let at = |row: &Value, wanted: &[f64]| {
        let position = row["position"].as_array().unwrap();
        assert_eq!(position.len(), wanted.len());
        for (value, wanted) in position.iter().zip(wanted) {
            near(value, *wanted, 0.002);
        }
    };
    at(&rows[0], &[1.5, -2.0, 0.25]);
    at(&rows[1], &[0.0, -1.0]);
    near(&rows[2]["position"], -2.0, 0.002);
    assert_eq!([&rows[0]["axis"], &rows[1]["axis"]], ["XYZ", "XZ"]);
    husillo()
        .args(["measure", "-m", "cmm3", "goto", "X1", "Y250"])
        .assert()
        .code(1)
        .stderr(contains(
            "error: Y 250.0000 mm is outside the travel, -200.0000 mm to 200.0000 mm",
        ));
    husillo()
        .args(["measure", "goto", "X1", "Y2"])
        .assert()
        .code(2)
        .stderr(contains("has no axis Y: there is X"));
}

#[test]
fn a_touch_in_any_direction_latches_all_axes() {
    // Faces across X at 2 mm and across Z at -1 mm; the distance to the first is twice that in Y.
    let faces = ["-m", "cmm3", "--contact", "1:1000", "--contact", "3:..-500"];
    let touches = [
        "touch", "1,-0.5,0", "goto", "X0", "Y1", "touch", "-z", "--repeat", "2",
    ];
    let rows = measured(&[&faces[..], &touches[..]].concat());
    let [x, y, z] = [0, 1, 2].map(|axis| &rows[0]["trigger"][axis]);
    near(x, 2.0, 0.002);
    near(y, -1.0, 0.002);
    near(z, 0.0, 0.002);
    assert_eq!(
        (&rows[0]["axis"], &rows[2]["axis"]),
        (&"XYZ".into(), &"Z".into())
    );
    near(&rows[2]["trigger"], -1.0, 0.002);
    husillo()
        .args(["measure", "-m", "cmm3", "touch", "-1,-1,0"])
        .assert()
        .code(1)
        .stderr(contains(
            "no contact from X 0.0000 mm, Y 0.0000 mm, Z 0.0000 mm to X -200.0000 mm, Y -200.0000 \
             mm, Z 0.0000 mm",
        ));
}

/// The session continues, away from the block; only its exit status shows the collision.
#[test]
fn a_goto_that_meets_something_stops_there() {
    let piece = ["--piece", "../examples/piece.toml", "session"];
    let lines = "goto X30 Y0\ngoto Z-25\ngoto Y58\nstatus y\ngoto Y0\nstatus y\nend\n";
    let mut command = husillo();
    command.args(["measure", "-m", "cmm3"]).args(piece);
    let run = command.write_stdin(lines).assert().code(4);
    let run = run.stderr(contains("error: collision").and(contains("help: look at the stylus")));
    let text = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    let at = |line: &&str| line.starts_with("Y status");
    let places: Vec<&str> = text.lines().filter(at).collect();
    assert!(places[0].contains("at 9.0"), "{text}");
    assert!(
        places[1].contains("at 0.00") || places[1].contains("at -0.00"),
        "{text}"
    );
}

/// `goto` is rapid on the command line, unless it is to be guarded.
#[test]
fn a_goto_may_be_guarded() {
    for (words, speeds) in [
        (&["goto", "4000"][..], 1150.0..1250.0),
        (&["goto", "4000", "guarded"][..], 740.0..800.0),
    ] {
        let mut command = husillo();
        command.args(["measure", "-m", "cmm", "home", "x", "--contact", "1:3018"]);
        let run = command.args(words).assert().code(4);
        let told = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        let (_, speed) = told.split_once("moved at about ").expect("a speed");
        let speed: f64 = speed.split(' ').next().unwrap().parse().unwrap();
        assert!(speeds.contains(&speed), "{told}");
    }
}

#[test]
fn zero_moves_what_is_counted_and_not_the_travel() {
    let rows = measured(&["goto", "1000", "zero", "status", "goto", "-1000"]);
    near(&rows[1]["position"], 0.0, 1.0);
    near(&rows[3]["position"], -1000.0, 1.0);
    assert!(rows[2]["bits"].to_string().contains("power on"));
    husillo()
        .args(["measure", "goto", "1000", "zero", "goto", "7100"])
        .assert()
        .code(1)
        .stderr(contains("error: X 7100 counts is outside the travel, -9"));
}

/// The axis is to stand at 1200 and stands a count beside: 0 is where it stands.
#[test]
fn zero_is_where_the_axis_stands() {
    let places = [1200, 300, -777, 2500];
    let mut beside = 0;
    for place in places {
        let goal = place.to_string();
        let rows = measured(&["goto", &goal, "zero", "status"]);
        near(&rows[1]["position"], 0.0, 0.0);
        near(&rows[2]["position"], 0.0, 0.0);
        let [stood, held] = [&rows[0]["position"], &rows[2]["held"]].map(number);
        assert_eq!(held, f64::from(place) - stood);
        beside += i32::from(held != 0.0);
    }
    assert!(
        beside > 0,
        "no axis stands beside its goal: nothing was tried"
    );
}

#[test]
fn several_axes_are_called_0_and_asked() {
    let rows = measured(&[
        "-m", "cmm3", "goto", "X3", "Y2", "Z-1", "zero", "x", "Z", "status",
    ]);
    let axes: Vec<_> = rows.iter().map(|row| row["axis"].as_str()).collect();
    assert_eq!(
        axes,
        ["XYZ", "XZ", "X", "Y", "Z"].map(Some),
        "all axes, one after another"
    );
    for (row, wanted) in rows[2..].iter().zip([0.0, 2.0, 0.0]) {
        near(&row["position"], wanted, 0.002);
        let (held, error) = (number(&row["held"]), number(&row["position_error"]));
        near(&row["position"], held - error, 1e-9);
        assert!(row["current"].is_u64() && row["version"] == 4, "{row}");
        assert_eq!(row["bits"], serde_json::json!(["move done", "power on"]));
        let auxiliary = row["auxiliary"].to_string();
        assert!(auxiliary.contains("servo on"), "{auxiliary}");
    }
    let text = common::printed(&["measure", "-m", "cmm3", "status", "y"]);
    for line in [
        "Y status: at ",
        "    held at    0.0000 mm, position error ",
        "    current    0 % of full scale",
        "    status     move done, power on",
        "servo on",
        "    version    4",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert!(!text.contains("X status"), "{text}");
}

#[test]
fn a_session_goes_on_after_a_line_that_fails() {
    let typed = "goto X5\nzero x\ngoto X900\nspin\n\ngoto X1\nstatus x\nend\ngoto X7\n";
    let run = husillo()
        .args(["measure", "-m", "cmm3", "goto", "Y1", "session"])
        .write_stdin(typed)
        .assert()
        .code(3)
        .stderr(contains(
            "error: X 900.0000 mm is outside the travel, -205.0",
        ))
        .stderr(contains("error: unknown action `spin`"));
    let text = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    let heads: Vec<_> = text.lines().filter(|line| !line.starts_with(' ')).collect();
    assert_eq!(heads.len(), 5, "{text}");
    assert!(heads[0].starts_with("Y goto: at 1.00"), "{text}");
    assert!(heads[2].starts_with("X zero: at "), "{text}");
    assert!(
        heads[4].starts_with("X status: at 1.00") || heads[4].starts_with("X status: at 0.99"),
        "{text}"
    );
    husillo()
        .args(["measure", "session", "goto", "5"])
        .assert()
        .code(2)
        .stderr(contains("`session` is the last action"));
}

/// A machine file with more lines.
fn cmm3_with(name: &str, lines: &str) -> String {
    let machines = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines");
    let text = std::fs::read_to_string(machines.join("cmm3.toml")).unwrap();
    let path = written(name, &format!("{text}\n{lines}"));
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_table_of_errors_needs_a_home() {
    let machine = cmm3_with(
        "table.toml",
        "[axis.x.calibration]\nscale = \"50 um/m\"\ntable = [[\"-200 mm\", \"0 um\", \"0 um\"], \
         [\"0 mm\", \"100 um\", \"100 um\"], [\"200 mm\", \"0 um\", \"0 um\"]]\n",
    );
    let on = |args: &[&str]| {
        let mut command = husillo();
        command.args(["measure", "-m", &machine]).args(args);
        command.assert()
    };
    let not_homed =
        "error: X is not homed: its table of errors counts from the index\n  help: `home` it first";
    for args in [
        &["goto", "Y1"][..],
        &["touch", "+x"],
        &["home", "y", "goto", "X1"],
        &["calibrate", "sphere", "X0", "Y0", "Z-20", "R10"],
    ] {
        on(args).code(1).stderr(contains(not_homed));
    }
    // What needs no place is done.
    on(&["jog", "+x", "200ms", "status", "zero", "x"]).success();
    let routine = written(
        "homed.routine",
        "goto x 3 y 1\npoint P at x 5.1 y 1 z 0 towards +x\n",
    );
    let run = [
        "run",
        routine.to_str().unwrap(),
        "--contact",
        "1:2500",
        "--ball",
        "0",
    ];
    on(&run).code(3).stderr(contains("X is not homed"));
    // The index of the simulated encoder is at its start: at 0 the table has 100 um, at 5 mm 97.5.
    let rows = measured(&["-m", &machine, "home", "x", "goto", "X5"]);
    near(&rows[1]["position"], 5.0, 0.002);
    let before = on(&[&["home", "x", "goto", "X1"], &run[..]].concat()).success();
    let told = String::from_utf8_lossy(&before.get_output().stdout).into_owned();
    assert!(
        told.contains("X home: at ") && told.contains("point P"),
        "{told}"
    );
}

/// Scales that read 2 mm/m short: errors are reported in positions, as results are.
#[test]
fn troubles_name_true_positions() {
    let machine = cmm3_with(
        "short-scales.toml",
        "[axis.x.calibration]\nscale = \"2000 um/m\"\n",
    );
    for (args, told) in [
        (
            &["goto", "X250"][..],
            "error: X 250.0000 mm is outside the travel, -200.4000 mm to 200.4000 mm",
        ),
        (
            &["goto", "X10", "zero", "goto", "X250"],
            "error: X 250.0000 mm is outside the travel, -210.4",
        ),
        (
            &["touch", "+x"],
            "to X 200.4000 mm, Y 0.0000 mm, Z 0.0000 mm",
        ),
    ] {
        husillo()
            .args(["measure", "-m", &machine])
            .args(args)
            .assert()
            .code(1)
            .stderr(contains(told));
    }
}

#[test]
fn touches_find_the_work_piece_from_both_sides() {
    // The stylus bends by 18 counts: faces at 500 and -300.
    let rows = measured(&[
        "touch",
        "+",
        "touch",
        "-",
        "--pretravel",
        "18",
        "--repeat",
        "3",
        "--contact",
        "1:518",
        "--contact",
        "1:..-318",
    ]);
    near(&rows[0]["corrected"], 500.0, 1.0);
    near(&rows[0]["trigger"], 518.0, 1.0);
    near(&rows[1]["corrected"], -300.0, 1.0);
    assert_eq!(rows[0]["touches"], 3);
    near(&rows[0]["spread"], 0.0, 1.0);
    // In millimetres, on the second of three modules.
    let rows = measured(&[
        "-m",
        "cmm3",
        "--axis",
        "y",
        "touch",
        "+",
        "--pretravel",
        "0.018",
        "--contact",
        "2:509",
    ]);
    // The ball has a radius of 1 mm.
    near(&rows[0]["corrected"], 2.0, 0.002);
}

#[test]
fn a_simulated_piece_is_touched_by_a_ball_on_a_stylus_that_bends() {
    let piece = ["-m", "cmm3", "--piece", "../examples/piece.toml"];
    // The top of the block, then the wall of its bore from within.
    let down = [
        "goto", "X20", "Y20", "Z-15", "touch", "-z", "goto", "Z-15", "goto", "X30", "Y30",
    ];
    let across = [
        "goto", "Z-25", "touch", "+x", "touch", "-x", "goto", "X30", "touch", "0,1,0", "touch",
        "1,-1,0",
    ];
    let rows = measured(&[&piece[..], &down[..], &across[..]].concat());
    // The ball has 1 mm, the stylus bends 1 um along Z, 10 and 6 um along X; one count is 2 um,
    // noise is 0.5 um.
    near(&rows[1]["trigger"], -20.0 + 1.0 - 0.001, 0.004);
    near(&rows[5]["trigger"], 38.0 - 1.0 + 0.010, 0.004);
    near(&rows[6]["trigger"], 22.0 + 1.0 - 0.006, 0.004);
    near(&rows[8]["trigger"], 38.0 - 1.0 + 0.008, 0.004);
    let [x, y] = [0, 1].map(|axis| rows[9]["trigger"][axis].as_f64().unwrap() - 30.0);
    assert!((x.hypot(y) - 7.008).abs() < 0.006, "{x} {y}");
    let fails = |args: &[&str], message: &str| {
        let assert = husillo().arg("measure").args(args).assert();
        assert.code(2).stderr(contains(message));
    };
    fails(
        &["--piece", "../examples/piece.toml", "touch", "+"],
        "--piece is in mm, and Measuring machine, one axis, 400 counts a turn has no `count`",
    );
    fails(
        &["-m", "cmm3", "--piece", "no.toml", "touch", "+"],
        "no.toml",
    );
}

#[test]
fn home_is_where_the_index_is_met_from_below() {
    // The index is at every 400 counts, and at 0 when it is switched on.
    let rows = measured(&[
        "home", "x", "goto", "-50", "goto", "130", "home", "goto", "-400",
    ]);
    for (row, wanted) in rows.iter().zip([0.0, -50.0, 130.0, 0.0, -400.0]) {
        near(&row["position"], wanted, 1.0);
    }
    // The second one is the next: 400 farther, so 400 less are left of the travel of 8000.
    let far = ["goto", "7590", "home", "goto", "0"];
    let rows = measured(&far);
    near(&rows[1]["position"], 0.0, 1.0);
    let rows = measured(&["-m", "cmm3", "--axis", "y", "goto", "0.1", "home", "status"]);
    near(&rows[1]["position"], 0.0, 0.002);
    // None between 50 and 300.
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let short = written(
        "short.toml",
        &text.replace("\"8000 counts\"]", "\"300 counts\"]"),
    );
    husillo()
        .args([
            "measure",
            "-m",
            short.to_str().unwrap(),
            "goto",
            "50",
            "home",
        ])
        .assert()
        .code(1)
        .stderr(contains("error: no index of X up to the end of the travel"));
}

#[test]
fn an_axis_is_jogged_at_two_speeds_and_within_its_travel() {
    let jogs = [
        "home", "jog", "+x", "2s", "jog", "-", "500ms", "slow", "goto", "0",
    ];
    let rows = &measured(&jogs)[1..];
    let at = |row: &Value| row["position"].as_f64().unwrap();
    // 1200 counts/s for 2 s, with ramps of 0.2 s; 200 counts/s for half a second.
    assert!((2250.0..2450.0).contains(&at(&rows[0])), "{rows:?}");
    assert!(
        (75.0..125.0).contains(&(at(&rows[0]) - at(&rows[1]))),
        "{rows:?}"
    );
    near(&rows[2]["position"], 0.0, 1.0);
    // Before homing the speed is that of a search in both cases.
    let rows = measured(&["jog", "+x", "2s", "jog", "-x", "60s"]);
    assert!((375.0..425.0).contains(&at(&rows[0])), "{rows:?}");
    let rows = measured(&["jog", "-x", "60s"]);
    assert!((-8000.0..-7500.0).contains(&at(&rows[0])), "{rows:?}");
}

#[test]
fn a_ring_calibrates_the_probe_and_what_it_prints_is_read() {
    // The bore of the piece as a ring of 8 mm.
    let ring = [
        "goto",
        "X30",
        "Y30",
        "calibrate",
        "ring",
        "X30.2",
        "Y29.9",
        "Z-25",
        "R8",
    ];
    let piece = ["-m", "cmm3", "--piece", "../examples/piece.toml"];
    let rows = measured(&[&piece[..], &ring[..]].concat());
    let found = &rows[1]["calibration"];
    near(&found["centre"][0], 30.0, 0.003);
    near(&found["centre"][1], 30.0, 0.003);
    // The stylus bends 8 um on average, 10 um along +X and 6 um along -X.
    near(&found["effective_radius"], 1.0 - 0.008, 0.001);
    let table = found["table"].as_array().unwrap();
    let length = |index: usize| table[index]["length"].as_f64().unwrap();
    assert_eq!(table.len(), 12);
    assert!(length(0) - length(6) > 0.001, "{table:?}");
    let output = husillo()
        .arg("measure")
        .args(piece)
        .args(ring)
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let (_, printed) = text.split_once("machine file:\n").unwrap();
    let file = std::fs::read_to_string("../machines/cmm3.toml").unwrap();
    let (before, after) = file.split_once("pre_travel = {").unwrap();
    let before = before.replace("ball_radius", "# ball_radius");
    let (_, after) = after.split_once('\n').unwrap();
    let after = after.replacen("ball_radius", "# ball_radius", 1);
    let (printed, _) = printed.split_once("]\nX").unwrap_or((printed, ""));
    let calibrated = written("calibrated.toml", &format!("{before}{printed}\n{after}"));
    let across = [
        "goto", "X30", "Y30", "goto", "Z-25", "touch", "+x", "goto", "X30", "touch", "-x",
    ];
    let machine = ["-m", calibrated.to_str().unwrap()];
    let rows = measured(&[&machine[..], &piece[2..], &across[..]].concat());
    let [right, left] = [2, 4].map(|row: usize| rows[row]["corrected"].as_f64().unwrap());
    assert!((right - left - 16.0).abs() < 0.004, "{left} {right}");
}

/// The top of the block is at -20 mm. A sphere gives its position along Z only together with the
/// bending of the stylus along Z.
#[test]
fn a_face_tells_what_a_sphere_cannot() {
    let piece = ["-m", "cmm3", "--piece", "../examples/piece.toml"];
    let sphere = ["calibrate", "sphere", "X-25", "Y25", "Z-20", "R10"];
    let above = ["goto", "Z5", "goto", "X20", "Y20", "goto", "Z-15"];
    let face = ["touch", "-z", "calibrate", "-z", "--reference", "-20"];
    let again = ["goto", "X15", "touch", "-z"];
    let rows = measured(&[&piece[..], &["goto", "Z-8"], &sphere, &above, &face, &again].concat());
    let [sphere, before, face, after] = [1, 5, 6, 8].map(|row: usize| &rows[row]);
    let off = number(&before["corrected"]) + 20.0;
    assert!(off.abs() > 0.0035, "{before}");
    assert_eq!(face["table"].as_array().unwrap().len(), 49);
    near(&after["corrected"], -20.0, 0.0025);
    // Along the equator the table is what it was.
    let table = |row: &Value| row["table"].as_array().unwrap()[48]["length"].clone();
    near(&table(face), number(&table(&sphere["calibration"])), 0.0);
}

#[test]
fn a_calibration_finds_the_pre_travel_and_is_used_from_then_on() {
    let rows = measured(&[
        "calibrate",
        "+",
        "touch",
        "+",
        "--reference",
        "500",
        "--contact",
        "1:518",
    ]);
    near(&rows[0]["pre_travel"], 18.0, 1.0);
    near(&rows[0]["corrected"], 500.0, 0.0);
    near(&rows[1]["corrected"], 500.0, 1.0);
    husillo()
        .args(["measure", "calibrate", "+"])
        .assert()
        .code(2)
        .stderr(contains("`calibrate` needs --reference"));
    husillo()
        .args(["measure", "calibrate", "sphere", "X0", "Y0", "R10"])
        .assert()
        .code(2)
        .stderr(contains("`calibrate sphere` needs a centre and a radius"));
}

#[test]
fn failures_are_named() {
    let fails = |args: &[&str], message: &str| {
        let assert = husillo().arg("measure").args(args).assert();
        assert
            .code(1)
            .stderr(contains(message).and(contains("help: ")));
    };
    fails(
        &["touch", "-"],
        "error: no contact from 0 counts to -8000 counts",
    );
    fails(
        &["touch", "+", "--contact", "1:-5"],
        "error: contact at start",
    );
    // A servo too weak to follow.
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let weak = written(
        "weak.toml",
        &text.replace("p = 2000, i = 50", "p = 1, i = 0"),
    );
    fails(
        &["-m", weak.to_str().unwrap(), "goto", "5000"],
        "error: position error at ",
    );
    // It is left without drive: the last stop is motor off, amplifier off.
    let output = husillo()
        .args([
            "measure",
            "-m",
            weak.to_str().unwrap(),
            "goto",
            "5000",
            "--raw",
        ])
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let last = told.lines().rfind(|line| line.starts_with("> aa 01 17"));
    assert_eq!(last, Some("> aa 01 17 02 1a"), "{told}");
    husillo()
        .args(["measure", "-m", "cmm", "goto", "1 mm"])
        .assert()
        .code(2)
        .stderr(contains("a position of this machine is in counts"));
    husillo()
        .args(["measure", "jump"])
        .assert()
        .code(2)
        .stderr(contains("unknown action `jump`"));
    husillo()
        .args(["run", "-m", "cmm", "../examples/circles.nc"])
        .assert()
        .code(2)
        .stderr(contains("see `husillo measure`"));
}

/// A contact that closes as the axes come to rest was not latched by the modules: their latch is of
/// the touch before.
#[test]
fn a_contact_at_the_end_of_a_search_is_latched_or_refused() {
    let path = scratch("late.routine");
    let text = "goto x 0 y 0 z 0\ntouch a +x within 10\ngoto x 0\ngoto x 0 y 20 z -5\ntouch b +x \
         within 5\n";
    std::fs::write(&path, text).unwrap();
    // b ends at 2500 counts.
    let mut latched = 0;
    for face in ["2498", "2499", "2500", "2501", "2502"] {
        let contact = format!("1:{face}");
        let output = husillo()
            .args([
                "measure",
                "-m",
                "cmm3",
                "--contact",
                &contact,
                "--format",
                "json",
            ])
            .args(["--ball", "0", "run", path.to_str().unwrap()])
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        if output.status.success() {
            // The face to the count, and Y and Z where they were held: nothing of touch a.
            let found: Value = serde_json::from_slice(&output.stdout).unwrap();
            let b = &found["features"][1];
            assert_eq!((&b["feature"], &b["touches"]), (&"b".into(), &1.into()));
            let at = &b["points"][0];
            near(&at["x"], face.parse::<f64>().unwrap() * 0.002, 1e-9);
            near(&at["y"], 20.0, 0.002);
            near(&at["z"], -5.0, 0.002);
            let dimensions = b["dimensions"].as_array().unwrap();
            assert_eq!(dimensions.len(), 3, "{b}");
            for (dimension, axis) in dimensions.iter().zip(["x", "y", "z"]) {
                assert_eq!(dimension["figure"], axis);
                assert_eq!(dimension["actual"], at[axis]);
            }
            latched += 1;
        } else {
            assert!(
                told.contains("contact, not latched") || told.contains("no contact"),
                "{face}: {told}"
            );
        }
    }
    assert!(latched > 0, "none was latched");
}

#[test]
fn a_touch_after_another_one_latches_its_own_contact() {
    for far in ["7998", "7999", "8000", "8001"] {
        let contact = format!("1:{far}");
        let output = husillo()
            .args([
                "measure",
                "-m",
                "cmm",
                "--format",
                "json",
                "--contact",
                &contact,
            ])
            .args([
                "--contact",
                "1:..-500",
                "touch",
                "-",
                "goto",
                "7000",
                "touch",
                "+",
            ])
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        let rows: Value = serde_json::from_slice(&output.stdout).unwrap();
        let rows = &rows["results"];
        match rows[2]["trigger"].as_f64() {
            Some(trigger) => assert_eq!(trigger, far.parse::<f64>().unwrap()),
            None => assert!(
                told.contains("contact, not latched") || told.contains("no contact"),
                "{far}: {told}"
            ),
        }
    }
}

/// Neither the back-off nor the slow touch leaves the travel.
#[test]
fn a_touch_stays_within_the_travel() {
    let raw = |machine: &str, args: &[&str]| {
        let output = husillo()
            .args(["measure", "-m", machine, "--raw"])
            .args(args)
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        // LOAD_TRAJECTORY with a position: the goals that the module was given.
        let loads = stderr.lines().filter_map(|line| {
            let bytes: Vec<u8> = line
                .strip_prefix("> ")?
                .split(' ')
                .map(|byte| u8::from_str_radix(byte, 16).unwrap())
                .collect();
            match bytes.as_slice() {
                [0xaa, 1, command, control, a, b, c, d, ..]
                    if command & 0x0f == 4 && control & 1 != 0 =>
                {
                    Some(i32::from_le_bytes([*a, *b, *c, *d]))
                }
                _ => None,
            }
        });
        (output.status.success(), loads.collect::<Vec<_>>(), stderr)
    };
    // Of one machine the travel begins just before the face: no room to back off.
    let machine = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let narrow = written(
        "narrow.toml",
        &machine.replace("-8000 counts", "-10 counts"),
    );
    let narrow = narrow.to_str().unwrap();
    for (machine, least, args) in [
        (narrow, -10, &["--contact", "1:5", "touch", "+"][..]),
        (
            "cmm",
            -8000,
            &["--contact", "1:7980", "goto", "7900", "touch", "+"],
        ),
    ] {
        let (is_done, loads, stderr) = raw(machine, args);
        assert!(is_done, "{stderr}");
        assert!(loads.len() >= 3, "{loads:?}");
        assert!(
            loads.iter().all(|goal| (least..=8000).contains(goal)),
            "{loads:?}"
        );
    }
}

#[test]
fn an_axis_that_brakes_for_long_is_waited_for() {
    // 1200 counts/s and 300 counts/s^2: 4 s to brake.
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let slow = scratch("slow.toml");
    let text = text.replace("6000 counts/s^2", "300 counts/s^2");
    std::fs::write(&slow, text).unwrap();
    let slow = slow.to_str().unwrap();
    let rows = &measured(&["-m", slow, "home", "jog", "+", "5s", "goto", "0"])[1..];
    // 2400 counts to 1200 counts/s in 4 s, 1200 in one more, 2400 to brake.
    let at = rows[0]["position"].as_f64().unwrap();
    assert!((5900.0..6200.0).contains(&at), "{rows:?}");
    near(&rows[1]["position"], 0.0, 1.0);
}

#[test]
fn a_pre_travel_that_no_probe_has_is_refused() {
    for (reference, found) in [("600", "-82 counts"), ("400", "118 counts")] {
        husillo()
            .args([
                "measure",
                "calibrate",
                "+",
                "--contact",
                "1:518",
                "--reference",
            ])
            .arg(reference)
            .assert()
            .code(1)
            .stderr(contains(format!(
                "a pre-travel of {found}, but only 0 to 100 counts"
            )));
    }
}

#[test]
fn results_as_text_and_table_and_the_bytes_beside_them() {
    let path = scratch("touches.csv");
    husillo()
        .args(["measure", "touch", "+", "--contact", "1:200", "--raw", "-o"])
        .arg(&path)
        .assert()
        .success()
        .stdout(contains("X touch +\n    trigger    "))
        .stderr(contains("> aa 00 21 01 ff 21\n< 19 19\n"))
        .stderr(contains("> aa 01 13 20 34\n< 19 00 04 1d\n"));
    let table = std::fs::read_to_string(path).unwrap();
    assert!(table.starts_with("action,axis,unit,position,direction,trigger,"));
    assert!(table.contains("\ntouch,X,counts,"), "{table}");
}

#[test]
fn a_dead_port_is_reported() {
    husillo()
        .args(["measure", "--port", "/dev/no-such-port", "status"])
        .assert()
        .code(2)
        .stderr(contains("/dev/no-such-port: "));
    // A port that takes everything and never answers.
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    husillo()
        .args(["measure", "--port", &port, "status"])
        .assert()
        .code(1)
        .stderr(contains("error: no answer: no module on the line"))
        .stderr(contains("help: is it the right port"));
}

#[test]
fn the_same_through_a_pseudo_terminal() {
    let args = ["--contact", "1:318", "--contact", "1:..-118"];
    let modules = ["--modules", "servo:4,servo:4", "--speed", "10"];
    let Some(chain) = Emulated::new("cmm", "measure-chain", &[&args[..], &modules[..]].concat())
    else {
        return;
    };
    let actions = ["touch", "+", "goto", "0", "touch", "-", "--pretravel", "18"];
    let simulated = measured(&[&actions[..], &args[..]].concat());
    let port = ["--port", chain.port()];
    let real = measured(&[&actions[..], &port[..]].concat());
    assert_eq!(real.len(), 3);
    for row in [&simulated, &real] {
        near(&row[0]["corrected"], 300.0, 1.0);
        near(&row[1]["position"], 0.0, 1.0);
        near(&row[2]["corrected"], -100.0, 1.0);
    }
}

#[test]
fn an_emulation_ends_and_takes_its_link_away() {
    let link = scratch("short-chain");
    let output = husillo()
        .args(["emulate", "cmm", "--for", "0.2", "--link"])
        .arg(&link)
        .output()
        .unwrap();
    if !output.status.success() {
        eprintln!("skipped: {}", String::from_utf8_lossy(&output.stderr));
        return;
    }
    assert!(
        String::from_utf8_lossy(&output.stdout).contains("Connect: husillo measure -m cmm --port ")
    );
    assert!(std::fs::symlink_metadata(&link).is_err());
    husillo()
        .args(["emulate", "cmm", "--modules", "stepper", "--link", "x"])
        .assert()
        .code(2)
        .stderr(contains("expected servo:4"));
}

#[test]
fn a_reader_that_is_gone_is_no_error() {
    let status = ["measure", "-m", "cmm", "status"];
    let step = ["tune", "-m", "cmm", "--method", "step"];
    for args in [&status[..], &step[..]] {
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .args(args)
            .stdin(std::process::Stdio::null())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{args:?}");
        assert_eq!(output.status.code(), Some(0), "{args:?}");
    }
}

/// Zero and home hold from one command to the next, also after an interruption and a stop. They
/// end with a reset of the modules.
#[cfg(unix)]
#[test]
fn the_next_command_goes_on_where_the_last_one_ended() {
    let Some(mut chain) = Emulated::new("cmm", "memory", &["--speed", "20"]) else {
        return;
    };
    let port = chain.port().to_owned();
    // A file of the name of the machine is not the machine.
    let folder = scratch("memory-folder");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("cmm"), "").unwrap();
    let folders = std::cell::Cell::new(0);
    let run = |actions: &[&str]| {
        let mut command = husillo();
        command.args(["measure", "--port", &port, "--format", "json"]);
        folders.set(folders.get() + 1);
        if folders.get() % 2 == 0 {
            command.current_dir(&folder);
        }
        let output = command.args(actions).output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{actions:?}: {errors}");
        let mut rows: Value = serde_json::from_slice(&output.stdout).unwrap();
        (rows["results"].take(), errors)
    };
    let (_, told) = run(&["goto", "30", "home", "x", "goto", "120", "zero"]);
    assert!(
        told.contains("note: the servos stay on and hold; zero and home are kept\n"),
        "{told}"
    );
    let (rows, told) = run(&["goto", "100"]);
    near(&rows[0]["position"], 100.0, 1.0);
    assert!(!told.contains("lost"), "{told}");
    // The index was met at 400 counts, so the module counts 400 + 120 + 100.
    let (rows, _) = run(&["home", "x"]);
    near(&rows[0]["position"], 0.0, 1.0);

    // A killed program leaves a jog that runs on. The next command stops it and keeps what is
    // known, and so does a stop.
    run(&["goto", "50", "zero"]);
    let killed = |actions: &[&str]| {
        let mut jog = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .env("XDG_STATE_HOME", common::state())
            .args(["measure", "--raw", "--port", &port])
            .args(actions)
            .stderr(std::process::Stdio::piped())
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        let lines = BufReader::new(jog.stderr.take().unwrap()).lines();
        // A trajectory, and some readings after it.
        let lines = lines
            .map_while(Result::ok)
            .skip_while(|line| !line.starts_with("> aa 01 d4 "));
        assert_eq!(lines.take(40).count(), 40);
        jog.kill().unwrap();
        jog.wait().unwrap();
    };
    let origins = || {
        let (rows, told) = run(&["where"]);
        assert!(!told.contains("killed") && !told.contains("lost"), "{told}");
        let of = |name: &str| number(&rows[0][name]);
        // Of the module at home, and from home to the zero.
        [of("steps") - of("machine"), of("machine") - of("work")]
    };
    let before = origins();
    killed(&["jog", "+x", "60s"]);
    let (rows, told) = run(&["status"]);
    assert!(
        told.starts_with("note: the program before was killed."),
        "{told}"
    );
    assert!(number(&rows[0]["position"]) > 5.0, "{rows}");
    assert_eq!(origins(), before);
    // Homing that was not completed changes nothing: the earlier home holds.
    run(&["goto", "300"]);
    killed(&["home", "x"]);
    let (_, told) = run(&["status"]);
    assert!(
        told.starts_with("note: the program before was killed."),
        "{told}"
    );
    assert_eq!(origins(), before);
    run(&["goto", "0"]);
    killed(&["jog", "+x", "60s"]);
    let stopped = printed(&["stop", "-m", "cmm", "--port", &port]);
    let at = stopped
        .split_whitespace()
        .nth(3)
        .unwrap()
        .parse::<f64>()
        .unwrap();
    let (rows, told) = run(&["status"]);
    assert!(!told.contains("lost"), "{told}");
    assert!(number(&rows[0]["position"]) > 5.0, "{rows}");
    let zero = at - number(&rows[0]["position"]);
    let (rows, _) = run(&["--reset", "status"]);
    near(&rows[0]["position"], 0.0, 1.0);
    assert!(zero > 400.0, "{zero}");

    // A pulled cable loses nothing, also if a command has failed meanwhile.
    let fails = || {
        let mut command = husillo();
        let output = command.args(["measure", "--port", &port, "where"]).output();
        let errors = String::from_utf8(output.unwrap().stderr).unwrap();
        assert!(errors.contains("no module on the line"), "{errors}");
        assert!(!errors.contains("lost"), "{errors}");
    };
    run(&["home", "x", "goto", "50", "zero"]);
    let before = origins();
    chain.type_line("unplug", "unplugged");
    fails();
    chain.type_line("plug", "plugged in");
    assert_eq!(origins(), before);

    chain.type_line("power off", "power is off");
    fails();
    chain.type_line("power on", "power is on");
    let (rows, told) = run(&["status"]);
    let lost = "note: the modules were reset or moved, so zero and home are lost\n";
    assert!(told.starts_with(lost), "{told}");
    near(&rows[0]["position"], 0.0, 1.0);
}

/// What is not known is said to be unknown.
#[test]
fn where_tells_all_coordinates() {
    let actions = "-m cmm3 goto X0.2 home x goto X5 Z1 zero x z goto X2.62 Z3 where";
    let args: Vec<&str> = ["measure"].into_iter().chain(actions.split(' ')).collect();
    let text = printed(&args);
    // The second index of X is 0.8 mm from where it stood.
    for wanted in [
        "X where: work 2.62",
        "    machine    7.62",
        " mm from home\n    steps      42",
        "Y where: work 0.0000 mm\n    machine    unknown, as Y is not homed\n    steps      0 ",
        "Z where: work 3.00",
    ] {
        assert!(text.contains(wanted), "{wanted} in {text}");
    }
    let rows = measured(&[&args[1..], &["x", "--inch"]].concat());
    let row = rows.last().unwrap();
    near(&row["machine"], 0.3, 0.000_1);
    near(&row["work"], 2.62 / 25.4, 0.000_1);
    assert_eq!((&row["unit"], &row["homed"]), (&"in".into(), &true.into()));
    let text = printed(&["measure", "goto", "30", "where"]);
    assert!(text.contains("X where: work 30 counts\n    machine    unknown, as X is not homed\n"));
    assert!(text.contains("    length     unknown, as the machine file has no `count`\n"));
}

/// An axis that is not homed moves slowly. A note says so once.
#[test]
fn an_axis_that_is_not_homed_is_announced_once() {
    let note = "note: X is not homed: it moves at 200 counts/s, and its travel counts from where \
                it stood\n";
    let told = |actions: &[&str]| {
        let output = husillo().arg("measure").args(actions).output().unwrap();
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(told(&["goto", "300", "jog", "+x", "1s", "goto", "0"]), note);
    assert_eq!(told(&["home", "x", "goto", "300"]), "");
    // From home at the second index on, 400 counts from where the axis stood.
    let beyond = told(&["goto", "30", "home", "goto", "8001"]);
    assert!(beyond.contains("error: X 8001 counts is outside the travel, -8000 counts to 8000"));
    let rows = measured(&["goto", "30", "home", "goto", "8000", "where"]);
    near(&rows[3]["steps"], 8400.0, 1.0);
}

/// A machine of one axis with a low end switch at limit 2.
fn with_end_switch(name: &str) -> String {
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let text = text.replace("in_position", "limit_2 = \"end-low\"\nin_position");
    written(name, &text).to_str().unwrap().to_owned()
}

#[test]
fn an_end_switch_is_a_fault_with_an_exit_status_of_its_own() {
    let machine = with_end_switch("end-switch.toml");
    let on = ["measure", "-m", &machine, "--end", "1:..-500"];
    let met = [&on[..], &["goto", "-900", "goto", "0"]].concat();
    husillo().args(met).assert().code(5).stderr(
        contains("error: the low end switch of X has closed at X -500 counts, at about ")
            .and(contains(" counts/s; all axes have been stopped"))
            .and(contains("  help: go back the other way")),
    );
    // A session goes on, away from the switch.
    let session = husillo()
        .args([&on[..], &["session", "--format", "csv"]].concat())
        .write_stdin("goto -900\ngoto -950\ngoto 0\ngoto 10\nend\n")
        .assert()
        .code(5)
        .stderr(contains(" has closed at ").and(contains(
            "error: the low end switch of X is closed at X -50",
        )));
    let text = String::from_utf8(session.get_output().stdout.clone()).unwrap();
    assert_eq!(text.matches("goto,X,counts,").count(), 2, "{text}");
    // Home is the same index next to the switch, wherever the axis stood.
    for away in ["-300", "100", "700"] {
        let on = ["-m", &machine, "--end", "1:..-650"];
        let rows = measured(&[&on[..], &["goto", away, "home", "where"]].concat());
        near(&rows[2]["steps"], -400.0, 1.0);
        near(&rows[2]["machine"], 0.0, 1.0);
    }
    husillo()
        .args(["measure", "-m", &machine, "--end", "1:500", "status"])
        .assert()
        .code(2)
        .stderr(contains(
            "no axis of the machine has a high end switch there",
        ));
}
