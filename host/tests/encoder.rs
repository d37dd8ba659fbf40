//! `husillo run` on machines with encoders, with losses that are simulated.

mod common;

use common::{husillo, written};
use serde_json::Value;

/// Exit status and results of the circles on a micro mill whose X has an encoder that does `on_loss`, with one loss.
fn run(name: &str, on_loss: Option<&str>) -> (i32, Value) {
    let mill = std::fs::read_to_string("../machines/micromill.toml").unwrap();
    let encoder = on_loss.map(|on_loss| {
        format!("[axis.x.encoder]\ncounts_per_mm = 50000\ntolerance = \"4 steps\"\non_loss = \"{on_loss}\"\n")
    });
    let file = mill + &encoder.unwrap_or_default();
    let path = written(&format!("{name}.toml"), &file);
    let mut command = husillo();
    command.args([
        "run",
        "../examples/circles.nc",
        "--format",
        "json",
        "--lose",
        "x:20000:-8",
        "-m",
    ]);
    let output = command.arg(&path).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    let results = serde_json::from_slice(&output.stdout);
    (
        output.status.code().unwrap(),
        results.unwrap_or_else(|_| panic!("{errors}")),
    )
}

#[test]
fn what_is_lost_is_told_and_given_again() {
    let (status, without) = run("none", None);
    assert_eq!((status, &without["encoders"]), (1, &Value::Null));
    assert_eq!(without["lost_steps"], 8);
    assert_eq!(without["errors"], 1);
    let (status, report) = run("report", Some("report"));
    assert_eq!(status, 1);
    assert_eq!(report["encoders"].as_array().unwrap().len(), 1);
    assert!(
        report["encoders"][0]
            .as_str()
            .unwrap()
            .starts_with("X is 8 steps behind, after 2000"),
        "{report}"
    );
    // Beside the path by what was lost.
    assert_eq!(report["end_nm"], without["end_nm"]);
    let (status, correct) = run("correct", Some("correct"));
    assert_eq!(status, 0);
    let told = correct["encoders"].as_array().unwrap();
    assert_eq!(told.len(), 2, "{correct}");
    assert!(told[1].as_str().unwrap().starts_with("X is right again"));
    let x = |results: &Value| results["end_nm"][0].as_i64().unwrap();
    // 8 steps of 140 nm.
    assert_eq!(x(&correct) - x(&report), 8 * 140);
    let (status, stop) = run("stop", Some("stop"));
    assert_eq!(status, 1);
    assert!(stop["events"].as_u64().unwrap() < 20_010, "{stop}");
}
