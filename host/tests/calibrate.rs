//! `husillo calibrate`, as a user calls it, and `husillo measure` with what it prints.

mod common;

use common::{husillo, printed, written};
use predicates::str::contains;
use serde_json::Value;
use std::fmt::Write;

/// From readings to a machine file to a machine that goes to true positions.
#[test]
fn readings_make_a_machine_file() {
    // Readings 100 um/m short; Y leans to X by 200 um/m: over 100 mm of diagonal, 20 mm of bar.
    let mut readings = "nominal,reading\n".to_owned();
    for step in -10..=10 {
        let nominal = f64::from(step) * 15.0;
        writeln!(readings, "{nominal},{:.6}", nominal / 1.0001).unwrap();
    }
    let readings = written("x.csv", &readings);
    let lines = printed(&["calibrate", "axis", readings.to_str().unwrap()]);
    assert!(
        lines.contains("[axis.x.calibration]\nscale = \"100."),
        "{lines}"
    );
    assert!(!lines.contains("table ="), "{lines}");
    let cmm3 = std::fs::read_to_string("../machines/cmm3.toml").unwrap();
    let scaled = written("scaled.toml", &(cmm3.clone() + &lines));
    let (a, lean) = (70.0, 2e-4);
    let bar = format!(
        "x1;y1;z1;x2;y2;z2\n0;0;0;{:.6};{a};0\n0;{a};0;{:.6};0;0\n",
        a - lean * a,
        a + lean * a
    );
    // Readings of the axes: a distance along Y also moves X.
    let bar = written("bar.csv", &bar);
    let args = [
        "calibrate",
        "squareness",
        "-m",
        scaled.to_str().unwrap(),
        bar.to_str().unwrap(),
    ];
    let angles = printed(&args);
    assert!(angles.contains("xy = \"200"), "{angles}");
    assert!(angles.contains("# yz is not known"), "{angles}");
    let mine = written("mine.toml", &(cmm3 + &lines + &angles));
    // 20 mm along both: a count is 2 um.
    let args = [
        "measure",
        "-m",
        mine.to_str().unwrap(),
        "--format",
        "json",
        "goto",
        "X20",
        "Y20",
    ];
    let rows: Value = serde_json::from_str(&printed(&args)).unwrap();
    let rows = rows["results"].as_array().unwrap();
    let last = &rows.last().unwrap()["position"];
    let near = |value: &Value, wanted: f64| (value.as_f64().unwrap() - wanted).abs() < 0.0045;
    assert!(near(&last[0], 20.0) && near(&last[1], 20.0), "{last}");
    // The calibration taken off again gives the same lines.
    let again: String = (-10..=10)
        .map(|step| format!("{},{}\n", f64::from(step) * 15.0, f64::from(step) * 15.0))
        .collect();
    let again = written("again.csv", &format!("nominal,reading\n{again}"));
    let lines = printed(&[
        "calibrate",
        "axis",
        "-m",
        mine.to_str().unwrap(),
        again.to_str().unwrap(),
    ]);
    assert!(lines.contains("scale = \"100."), "{lines}");
}

/// Bad input is reported in a sentence with its position.
#[test]
fn what_is_wrong_is_said() {
    let calibrate = |what: &str, text: &str, more: &[&str]| {
        let file = written(&format!("wrong{}.csv", text.len()), text);
        let mut command = husillo();
        command
            .args(["calibrate", what, file.to_str().unwrap()])
            .args(more);
        command.assert().code(2)
    };
    calibrate("axis", "nominal,reading\n0,0\n", &[]).stderr(contains("two different lengths"));
    calibrate("axis", "nominal,reading\n0,zero\n1,1\n", &[]).stderr(contains("line 2: reading"));
    calibrate("axis", "nominal,reading\n0,0\n1,1\n2,2.1\n", &["-m", "cmm"])
        .stderr(contains("has no `count`"));
    calibrate("squareness", "x1,y1,x2,y2\n0,0,100,100\n", &[]).stderr(contains("both diagonals"));
    let cmm3 = std::fs::read_to_string("../machines/cmm3.toml").unwrap();
    let steep = "[axis.x.calibration]\ntable = [[\"0 mm\", \"0 um\", \"0 um\"], [\"1 um\", \"1 \
         um\", \"0 um\"]]\n";
    let steep = written("steep.toml", &(cmm3 + steep));
    let args = ["measure", "-m", steep.to_str().unwrap(), "status"];
    husillo()
        .args(args)
        .assert()
        .code(2)
        .stderr(contains("too steep at entry 1"));
}
