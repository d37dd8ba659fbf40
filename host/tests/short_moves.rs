//! Moves shorter than a step lose no step, and a run that loses some does not end well.

mod common;

use common::{husillo, json, scratch};
use predicates::str::contains;
use std::fmt::Write;

/// A polyline along a slope, in moves of so many nanometres.
fn polyline(feed: &str, moves_nm: &[u32]) -> String {
    let mut text = format!("G21 G90 G94\nG1 F{feed}\n");
    let mut at_nm = 0;
    for move_nm in moves_nm.iter().cycle().take(400) {
        at_nm += move_nm;
        let mm = f64::from(at_nm) / 1e6;
        writeln!(text, "X{mm:.6} Y{:.6}", mm * 0.7).unwrap();
    }
    text + "M2\n"
}

#[test]
fn moves_shorter_than_a_step_lose_none() {
    let programs = [
        "G21 G90\nG1 X0.010149 F1.4\nX0.010151\nX0.020\nM2\n".to_owned(),
        polyline("1.4", &[5, 17, 60, 3]),
        polyline("1.42", &[200, 5, 990]),
        polyline("1.428", &[70, 71, 140]),
    ];
    for (number, program) in programs.iter().enumerate() {
        let file = scratch(&format!("short-moves-{number}.nc"));
        std::fs::write(&file, program).unwrap();
        let found = json(&["run", file.to_str().unwrap(), "--format", "json"]);
        assert_eq!(found["lost_steps"], 0, "program {number}");
        assert_eq!(found["errors"], 0, "program {number}");
    }
}

#[test]
fn a_run_that_loses_steps_says_which_and_ends_with_1() {
    let file = scratch("loses.nc");
    std::fs::write(&file, "G21 G90\nG1 X0.05 F1\nM2\n").unwrap();
    let file = file.to_str().unwrap();
    husillo()
        .args(["run", file, "--lose", "x:100:4", "-o"])
        .arg(scratch("loses.html"))
        .assert()
        .code(1)
        .stderr(contains("axis X lost 4 steps; the first at step event 100"));
}
