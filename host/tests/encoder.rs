//! `husillo run` on machines with encoders, with losses that are simulated.

mod common;

use common::{husillo, written};
use serde_json::Value;

/// Exit status and results of the circles on a micro mill whose X has an encoder with `on_loss` and
/// one loss.
fn run(name: &str, on_loss: Option<&str>) -> (i32, Value) {
    run_losing(name, on_loss, &["x:20000:-8"])
}

/// The same with these losses.
fn run_losing(name: &str, on_loss: Option<&str>, losses: &[&str]) -> (i32, Value) {
    let mill = std::fs::read_to_string("../machines/micromill.toml").unwrap();
    let encoder = on_loss.map(|on_loss| {
        format!(
            "[axis.x.encoder]\ncounts_per_mm = 50000\ntolerance = \"4 steps\"\non_loss \
             = \"{on_loss}\"\n"
        )
    });
    let file = mill + &encoder.unwrap_or_default();
    let path = written(&format!("{name}.toml"), &file);
    let mut command = husillo();
    command.args(["run", "../examples/circles.nc", "--format", "json"]);
    for loss in losses {
        command.args(["--lose", loss]);
    }
    let output = command.arg("-m").arg(&path).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    let results = serde_json::from_slice(&output.stdout);
    (
        output.status.code().unwrap(),
        results.unwrap_or_else(|_| panic!("{errors}")),
    )
}

#[test]
fn lost_steps_are_reported_and_re_emitted() {
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
            .starts_with("X is 8 steps behind, after 20,00"),
        "{report}"
    );
    // Beside the path by what was lost.
    assert_eq!(report["end_nm"], without["end_nm"]);
    let (status, correct) = run("correct", Some("correct"));
    assert_eq!(status, 0);
    let told = correct["encoders"].as_array().unwrap();
    assert_eq!(told.len(), 2, "{correct}");
    assert!(told[1].as_str().unwrap().starts_with("X is corrected"));
    let x = |results: &Value| results["end_nm"][0].as_i64().unwrap();
    // 8 steps of 140 nm.
    assert_eq!(x(&correct) - x(&report), 8 * 140);
    let (status, stop) = run("stop", Some("stop"));
    assert_eq!(status, 1);
    assert!(stop["events"].as_u64().unwrap() < 20_010, "{stop}");
}

/// An axis that loses steps as fast as they are re-emitted cannot be corrected, whatever `on_loss`
/// is.
#[test]
fn what_could_not_be_corrected_is_an_error() {
    let again = (0..40).map(|turn| format!("x:{}:-8", 20_000 + 8 * turn));
    let losses: Vec<String> = again.collect();
    let losses: Vec<&str> = losses.iter().map(String::as_str).collect();
    let (status, stalled) = run_losing("stalled", Some("correct"), &losses);
    let told = stalled["encoders"].as_array().unwrap();
    let last = told.last().unwrap().as_str().unwrap();
    assert!(last.starts_with("X is stalled"), "{stalled}");
    assert_eq!((status, &stalled["errors"]), (1, &1.into()));
}
