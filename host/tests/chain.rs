//! A whole session with an emulated chain behind a pseudo-terminal: addresses, gains, home on the index, trapezoids, a jog, touches
//! both ways, a routine in three axes.

mod emulated;

use assert_cmd::Command;
use emulated::Emulated;
use serde_json::Value;

/// The rows that `husillo measure -m cmm3` prints; it must end well.
fn measured(args: &[&str]) -> Vec<Value> {
    let mut command = Command::cargo_bin("husillo").unwrap();
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command
        .args(["measure", "-m", "cmm3", "--format", "json"])
        .args(args)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{args:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    match serde_json::from_slice(&output.stdout).unwrap() {
        Value::Array(rows) => rows,
        one => vec![one],
    }
}

/// The top, the bore and the width of the block of `examples/piece.toml`; the web is touched both ways.
const ROUTINE: &str = "safe z -10
clearance 3
search 4
plane top towards -z at x14 y14 z-20 at x46 y14 z-20 at x46 y34 z-20
clearance 2
search 1
bore B at x 30 +-0.02 y 30 +-0.02 z -24 diameter 16 +-0.02 points 4
web sides at x 30 y 20 z -25 along x width 40 +-0.02
";

#[test]
fn a_session_from_the_addresses_to_a_routine() {
    let piece = [
        "--modules",
        "servo:4,servo:4,servo:4",
        "--piece",
        "../examples/piece.toml",
        "--speed",
        "20",
    ];
    let Some(chain) = Emulated::new("cmm3", "whole-chain", &piece) else {
        return;
    };
    let on_chain = |args: &[&str]| measured(&[&["--port", chain.port()], args].concat());
    // From power-up on: where the probe is, the drawing of the piece begins.
    let file = std::env::temp_dir().join(format!("husillo-whole-{}.routine", std::process::id()));
    std::fs::write(&file, ROUTINE).unwrap();
    let pre_travel = ["--ball", "1", "--pretravel", "8 um", "run"];
    let found = on_chain(&[&pre_travel[..], &[file.to_str().unwrap()]].concat());
    std::fs::remove_file(file).unwrap();
    // It ended well, so all of it is within tolerance.
    assert_eq!(found[0]["features"].as_array().unwrap().len(), 3);
    // Now from where the routine left it: up, and about.
    let rows = on_chain(&[
        "goto", "Z3", "home", "x", "goto", "X1", "Y-2", "jog", "+y", "1s", "slow",
    ]);
    let actions: Vec<_> = rows
        .iter()
        .map(|row| row["action"].as_str().unwrap())
        .collect();
    assert_eq!(actions, ["goto", "home", "goto", "jog"]);
    let at = |row: &Value, axis: usize| row["position"][axis].as_f64().unwrap();
    assert!((at(&rows[2], 0) - 1.0).abs() <= 0.0021, "{rows:#?}");
    assert!((at(&rows[2], 1) + 2.0).abs() <= 0.0021, "{rows:#?}");
    assert!(rows[3]["position"].as_f64().unwrap() > -1.9, "{rows:#?}");
}
