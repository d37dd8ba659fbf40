//! `husillo measure`: touches and the calibration of the probe, as a user calls them.

mod common;

use common::{husillo, measured, near, number, scratch, written};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;

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
    // One touch shows no spread.
    assert_eq!(rows[0]["touches"], 1);
    assert_eq!(rows[0].get("spread"), None);
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
