//! `husillo jog` and `husillo emulate microfactory`, as a user calls them.

mod common;
mod emulated;

use common::husillo;
use emulated::Emulated;
use predicates::prelude::*;
use predicates::str::contains;

/// A device 50 times as fast as a real one; `None` where there are no pseudo-terminals.
fn device(name: &str, args: &[&str]) -> Option<Emulated> {
    Emulated::new("microfactory", name, &[&["--speed", "50"], args].concat())
}

fn jog(device: &Emulated, actions: &[&str]) -> assert_cmd::assert::Assert {
    let port = ["jog", "--port", device.port()];
    husillo().args(port).args(actions).assert()
}

#[test]
fn a_session_in_simulated_time() {
    husillo()
        .args(["jog", "home", "x", "400", "z", "-5", "y+", "1s", "figure"])
        .args(["--figure", "../examples/microfactory/triangle.nc"])
        .assert()
        .success()
        .stdout(contains("homed").and(contains("the tool touches: the figure begins")))
        // 400 steps at 100 a second; 5 of them, with 200 to take up before.
        .stdout(contains("x +400: 4.").and(contains("z -5: 2.")));
}

#[test]
fn the_same_over_a_pseudo_terminal() {
    let Some(mut device) = device("cell", &[]) else {
        return;
    };
    jog(&device, &["home", "x", "300", "c", "64", "y+", "0.1s"]).success();
    let place = device.type_line("where", "lost");
    assert!(
        place.contains("x 300 ") && place.contains("spindle 64 "),
        "{place}"
    );
    assert!(place.contains("from home; 0 lost"), "{place}");
}

fn jog_both(first: &Emulated, second: &Emulated, actions: &[&str]) -> assert_cmd::assert::Assert {
    let second = ["--port", second.port()];
    jog(first, &[&second, actions].concat())
}

#[test]
fn two_machines_at_once() {
    let (Some(mut first), Some(mut second)) = (device("one", &[]), device("two", &[])) else {
        return;
    };
    jog_both(
        &first,
        &second,
        &["home", "1:", "x", "40", "2:", "x", "-7", "all:", "c", "3"],
    )
    .success()
    .stdout(contains("1: x +40: ").and(contains("2: x -7: ")))
    .stdout(contains(": 3 of 3 actions").count(2));
    first.type_line("unplug", "unplugged");
    jog_both(&first, &second, &["c", "9"])
        .code(1)
        .stdout(contains("0 of 1 actions, then no answer").and(contains("1 of 1 actions")));
    let place = second.type_line("where", "lost");
    assert!(
        place.contains("x -7 ") && place.contains("spindle 12 "),
        "{place}"
    );
}

#[test]
fn a_switch_and_an_emergency_at_the_panel() {
    let Some(mut device) = device("panel", &[]) else {
        return;
    };
    jog(&device, &["home"]).success();
    device.type_line("close y", "y is closed");
    jog(&device, &["y", "-10"]).success();
    device.read_until("home switch y closed");
    device.read_until("closed still");
    device.type_line("open y", "let go");
    jog(&device, &["emergency"]).success();
    device.read_until("until a reset nothing moves");
    jog(&device, &["x", "10"])
        .code(1)
        .stderr(contains("emergency stop (then reset it)"));
    device.type_line("reset", "reset");
    jog(&device, &["x", "10"]).success();
    device.type_line("unplug", "unplugged");
    jog(&device, &["x", "10"])
        .code(1)
        .stderr(contains("no answer"));
}

#[test]
fn the_original_does_not_answer() {
    let Some(mut device) = device("faithful", &["--faithful"]) else {
        return;
    };
    jog(&device, &["home"])
        .code(1)
        .stderr(contains("--without-answers"));
    // The byte has been taken all the same.
    device.read_until("homed");
    jog(&device, &["--without-answers", "z", "7"]).success();
    let place = device.type_line("where", "lost");
    assert!(place.contains(" z 7 "), "{place}");
}

#[test]
fn wrong_actions_move_nothing() {
    for (actions, reason) in [
        (&["fly"][..], "unknown action `fly`"),
        (&["home", "x"], "by how many steps"),
        (&["y+", "5"], "how long"),
    ] {
        husillo()
            .arg("jog")
            .args(actions)
            .assert()
            .code(2)
            .stdout("")
            .stderr(contains(reason));
    }
}
