//! A whole session with an emulated network behind a pseudo-terminal: addresses, gains, home on the
//! index, trapezoids, a jog, touches in both directions, a routine in three axes.

mod common;
mod emulated;

use common::{measured, near, number, signal, written};
use emulated::Emulated;
use serde_json::Value;
use std::io::{BufRead, BufReader};

/// Ctrl-C, a request to end and a closed terminal stop an axis that runs: the modules get the stop,
/// and the exit status shows it.
#[test]
fn an_interruption_stops_the_axes() {
    let Some(network) = Emulated::new(
        "cmm3",
        "interrupted",
        &["--modules", "servo:4,servo:4,servo:4"],
    ) else {
        return;
    };
    for name in ["INT", "TERM", "HUP"] {
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .env("XDG_STATE_HOME", common::state())
            .args(["measure", "-m", "cmm3", "--raw", "--port", network.port()])
            .args(["jog", "+x", "60s", "slow"])
            .stderr(std::process::Stdio::piped())
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap())
            .lines()
            .map(Result::unwrap);
        // The jog has begun: a trajectory that starts at once.
        assert!(lines.any(|line| line.starts_with("> aa 01 d4 97 ")));
        signal(&child, name);
        let told: Vec<String> = lines.collect();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{told:?}");
        assert!(
            told.iter()
                .any(|line| line.contains("interrupted: all axes have been commanded to stop"))
        );
        // STOP_MOTOR, smoothly and with the amplifier on, to each of them.
        for module in 1..=3 {
            let stop = format!("> aa {module:02x} 17 09 ");
            assert!(told.iter().any(|line| line.starts_with(&stop)), "{told:?}");
        }
    }
}

/// The top, the bore and the width of the block of `examples/piece.toml`; the web is touched on
/// both sides.
const ROUTINE: &str = "safe z -10
clearance 3
search 4
plane top towards -z at x14 y14 z-20 at x46 y14 z-20 at x46 y34 z-20
clearance 2
search 1
bore B at x 30 +-0.02 y 30 +-0.02 z -24 diameter 16 +-0.02 points 4
web sides at x 30 y 20 z -25 along x width 40 +-0.02
";

/// The corner of the block as a plane, a line and a point, then bore and width from there.
const ALIGNED: &str = "safe z -10
clearance 3
search 4
plane top towards -z at x14 y14 z-20 at x46 y14 z-20 at x46 y34 z-20
line front towards +y at x15 y10 z-25 at x45 y10 z-25
point left towards +x at x10 y30 z-25
frame plane top line front point left
clearance 2
search 1
bore B at x 20 +-0.02 y 20 +-0.02 z -4 diameter 16 +-0.02 points 4
web sides at x 20 +-0.02 y 10 z -5 along x width 40 +-0.02
";

const PIECE: &str = "../examples/piece.toml";

/// `husillo emulate cmm3` with this piece, 20 times as fast as it would be.
fn network(name: &str, piece: &str) -> Option<Emulated> {
    let modules = ["--modules", "servo:4,servo:4,servo:4", "--speed", "20"];
    Emulated::new("cmm3", name, &[&modules[..], &["--piece", piece]].concat())
}

fn on(port: &[&str], args: &[&str]) -> Vec<Value> {
    measured(&[&["-m", "cmm3"], port, args].concat())
}

/// What a routine found; it ended well, so all of it is within tolerance.
fn run(port: &[&str], name: &str, routine: &str) -> Vec<Value> {
    let file = written(name, routine);
    let probe = ["--ball", "1", "--pretravel", "8 um", "run"];
    // The index of each axis is where it stands at first.
    let home = ["home", "x", "home", "y", "home", "z"];
    let args = [&home[..], &probe, &[file.to_str().unwrap()]].concat();
    let found = on(port, &args);
    found[0]["features"].as_array().unwrap().clone()
}

#[test]
fn a_session_from_the_addresses_to_a_routine() {
    let Some(network) = network("whole-network", PIECE) else {
        return;
    };
    let port = ["--port", network.port()];
    // From power-up on: where the probe is, the drawing of the piece begins.
    assert_eq!(run(&port, "whole.routine", ROUTINE).len(), 3);
    // Now from where the routine left it: up, and about.
    let about = [
        "goto", "Z3", "home", "x", "goto", "X1", "Y-2", "jog", "+y", "1s", "slow",
    ];
    let rows = on(&port, &about);
    let actions: Vec<_> = rows
        .iter()
        .map(|row| row["action"].as_str().unwrap())
        .collect();
    assert_eq!(actions, ["goto", "home", "goto", "jog"]);
    near(&rows[2]["position"][0], 1.0, 0.0021);
    near(&rows[2]["position"][1], -2.0, 0.0021);
    assert!(number(&rows[3]["position"]) > -1.9, "{rows:#?}");
}

#[test]
fn a_turned_part_measures_like_the_first() {
    let drawn = run(&["--piece", PIECE], "drawn.routine", ALIGNED);
    let place = "[place]\nat = [\"1.5 mm\", \"-1 mm\", \"-0.5 mm\"]\nturn = \"3 deg\"\ntilt \
         = \"0.5 deg\"\n";
    let text = std::fs::read_to_string(PIECE).unwrap();
    let turned = written("turned-part.toml", &format!("{text}\n{place}"));
    let Some(network) = network("turned-network", turned.to_str().unwrap()) else {
        return;
    };
    let turned = run(&["--port", network.port()], "turned.routine", ALIGNED);
    for (drawn, turned) in drawn[3..].iter().zip(&turned[3..]) {
        let dimensions = drawn["dimensions"].as_array().unwrap();
        for (index, dimension) in dimensions.iter().enumerate() {
            if dimension["in_tolerance"] == true {
                // Three counts of 2 um, as of the example (`tests/routine.rs`).
                let actual = number(&dimension["actual"]);
                near(&turned["dimensions"][index]["actual"], actual, 0.006);
            }
        }
    }
}
