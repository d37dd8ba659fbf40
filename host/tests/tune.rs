//! `husillo tune`, as a user calls it.

mod common;
mod emulated;

use common::{husillo, json, number, scratch, written};
use emulated::Emulated;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use std::path::PathBuf;

/// What an experiment that goes well found.
fn tuned(args: &[&str]) -> Value {
    json(&[&["tune", "--format", "json"], args].concat())
}

/// A machine file with other gains.
fn with_gains(name: &str, gains: &str) -> PathBuf {
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let is_gains = |line: &str| line.starts_with("gains = ");
    let lines = text
        .lines()
        .map(|line| if is_gains(line) { gains } else { line });
    written(name, &lines.collect::<Vec<_>>().join("\n"))
}

#[test]
fn a_step_response() {
    let found = tuned(&["--method", "step"]);
    let step = &found["step"];
    assert_eq!((&step["from"], &step["goal"]), (&0.into(), &100.into()));
    assert!((45.0..60.0).contains(&number(&step["rise_ms"])), "{step}");
    assert!((5.0..20.0).contains(&number(&step["overshoot_percent"])));
    assert!(number(&step["peak_current"]) > 60.0);
    assert!(found["check"].is_null());
    // The same through a line, with fewer readings.
    let slow = tuned(&["--method", "step", "--port", "line"]);
    assert!((number(&slow["step"]["rise_ms"]) / number(&step["rise_ms"]) - 1.0).abs() < 0.1);
    assert!(number(&slow["sample_ms"]) > 2.0 && number(&found["sample_ms"]) < 0.6);
}

#[test]
fn the_original_gains_need_the_dead_band() {
    let original = ["--method", "step", "--p", "100", "--i", "0", "--d", "10000"];
    let moves = ["--moves", "18"];
    husillo()
        .arg("tune")
        .args(original)
        .args(moves)
        .assert()
        .code(1)
        .stdout(contains("of 18 within 1 count"))
        .stderr(contains("of 18 moves ended within 1 count, the farthest "));
    let found = tuned(&[&original[..], &moves[..], &["--dead-band", "14"]].concat());
    assert_eq!(found["check"]["within_1_count"], 18);
}

#[test]
fn every_method_ends_with_gains_that_place_every_move() {
    // At 19200 baud the line delays a relay so much that its gains let the axis swing.
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let fast = written(
        "fast-line.toml",
        &text.replacen("baud = 19200", "baud = 115200", 1),
    );
    for (method, port) in [
        ("ultimate", "sim"),
        ("ultimate", "line"),
        ("relay", "sim"),
        ("relay", "line"),
        ("stepwise", "sim"),
        ("stepwise", "line"),
    ] {
        let machine = ["-m", fast.to_str().unwrap()];
        let found = tuned(
            &[
                &["--method", method, "--port", port, "--moves", "45"],
                &machine[..],
            ]
            .concat(),
        );
        assert_eq!(found["check"]["within_1_count"], 45, "{method} {port}");
        // The line is one for a machine file.
        let gains = found["toml"].as_str().unwrap();
        let file = with_gains(&format!("tuned-{method}-{port}.toml"), gains);
        let again = tuned(&[
            "--method",
            "step",
            "--moves",
            "9",
            "-m",
            file.to_str().unwrap(),
        ]);
        assert_eq!(again["check"]["within_1_count"], 9, "{gains}");
        let is_one_experiment = method == "relay";
        assert_eq!(found["trials"].is_null(), is_one_experiment);
    }
}

#[test]
fn the_line_costs_the_relay_its_gain() {
    let gain = |port: &[&str]| {
        let found = tuned(&[&["--method", "relay", "--moves", "0"], port].concat());
        let late = number(&found["relay"]["late_ms"]);
        let has_note = found["notes"].to_string().contains("the host is the relay");
        assert_eq!(late > 0.0, has_note);
        (number(&found["ultimate"]["gain"]), late)
    };
    let (own, _) = gain(&[]);
    let (fast, fast_late) = gain(&["-m", "cmm3", "--port", "line"]);
    let (slow, slow_late) = gain(&["--port", "line"]);
    assert!(own > 1.5 * fast && fast > 1.5 * slow, "{own} {fast} {slow}");
    assert!(slow_late > 2.0 * fast_late);
}

#[test]
fn stepwise_prints_every_trial() {
    husillo()
        .args(["tune", "--method", "stepwise"])
        .assert()
        .success()
        .stdout(contains("    derivative   p 100   i 0     d 1000 "))
        .stdout(contains("    proportional p 200 ").and(contains("    integral     p ")))
        .stdout(contains(" limit 16000 "))
        .stdout(contains("moves                  20 of 20 within 1 count"))
        .stdout(contains("no derivative gain up to 16320 oscillates"))
        .stdout(contains("no proportional gain up to 8160 oscillates"))
        .stdout(contains("\ngains = { p = 4080, "));
}

#[test]
fn an_experiment_beyond_a_limit_is_aborted() {
    let aborted = |args: &[&str], what: &[&str]| {
        let mut assert = husillo().arg("tune").args(args).assert().code(1);
        for text in what {
            assert = assert.stderr(contains(*text));
        }
    };
    for port in ["sim", "line"] {
        let at = |args: &[&'static str]| [args, &["--port", port][..]].concat();
        aborted(
            &at(&["--method", "stepwise", "--current", "101"]),
            &[
                "error: current beyond its limit at ",
                " with p = ",
                ": aborted",
                "help: the motor is off",
            ],
        );
        aborted(
            &at(&["--method", "relay", "--current", "31"]),
            &["error: current beyond its limit"],
        );
        // Too weak to follow a move.
        aborted(
            &at(&[
                "--method",
                "step",
                "--p",
                "20",
                "--i",
                "0",
                "--size",
                "20",
                "--error-limit",
                "25",
                "--moves",
                "9",
            ]),
            &[
                "error: position error at ",
                ": aborted",
                "help: the servo is off",
            ],
        );
    }
    // Without the servo the host looks after the position.
    aborted(
        &[
            "--method",
            "relay",
            "--port",
            "line",
            "--error-limit",
            "15",
            "--size",
            "10",
        ],
        &["error: position error at "],
    );
}

#[test]
fn json_of_an_aborted_experiment_has_the_reason_and_the_trials() {
    let output = husillo()
        .args([
            "tune",
            "--method",
            "stepwise",
            "--current",
            "101",
            "--format",
            "json",
        ])
        .output()
        .unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(
        found["aborted"]
            .as_str()
            .unwrap()
            .starts_with("current beyond")
    );
    let trials = found["trials"].as_array().unwrap();
    assert_eq!(trials.last().unwrap()["result"], "aborted");
}

#[test]
fn mistakes_are_reported() {
    for (args, message) in [
        (
            &["--method", "step", "--size", "400"][..],
            "--size 400: a step is a position error at once",
        ),
        (
            &[
                "--method",
                "step",
                "--size",
                "5000",
                "--error-limit",
                "16000",
            ],
            "too large for the travel",
        ),
        (
            &["--method", "relay", "--p", "100"],
            "are for --method step: the other methods find them",
        ),
        (
            &["--method", "step", "--axis", "y"],
            "has no axis Y: there is X",
        ),
        (&["--method", "step", "--current", "40"], "use an odd limit"),
        (
            &["--method", "step", "--port", "/dev/no-such-port"],
            "/dev/no-such-port: ",
        ),
        (
            &["--method", "guess"],
            "possible values: step, ultimate, relay, stepwise",
        ),
    ] {
        husillo()
            .arg("tune")
            .args(args)
            .assert()
            .code(2)
            .stderr(contains(message));
    }
    // Less than friction takes.
    husillo()
        .args(["tune", "--method", "relay", "--amplitude", "10"])
        .assert()
        .code(1)
        .stderr(contains(
            "raise --amplitude above the PWM that overcomes friction",
        ));
}

#[test]
fn a_page_stands_alone() {
    let path = scratch("tune.html");
    husillo()
        .args(["tune", "--method", "ultimate", "-o"])
        .arg(&path)
        .assert()
        .success();
    let page = std::fs::read_to_string(path).unwrap();
    assert!(!page.contains("<script") && !page.contains("http"));
    assert_eq!(page.matches("<svg").count(), 2);
    assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
    for text in [
        "the axis oscillates",
        "Ziegler-Nichols",
        "position, counts",
        "gains = { p = ",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert!(!page.contains("NaN") && !page.contains("inf"));
}

#[test]
fn the_same_through_a_pseudo_terminal() {
    let Some(network) = Emulated::new("cmm", "tune-network", &["--speed", "4"]) else {
        return;
    };
    let port = ["--port", network.port()];
    let step = ["--method", "step", "--moves", "4"];
    let found = tuned(&[&step[..], &port[..]].concat());
    assert_eq!(found["check"]["within_1_count"], 4);
    assert!(
        number(&found["step"]["overshoot_percent"]) < 25.0,
        "{found}"
    );
    // Until the first trial that takes more current than this.
    husillo()
        .args(["tune", "--method", "stepwise", "--current", "51"])
        .args(port)
        .assert()
        .code(1)
        .stderr(contains("error: current beyond its limit at "));
}
