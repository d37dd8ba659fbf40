//! `husillo jog` and `husillo emulate microfactory`, as a user calls them.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

fn husillo() -> Command {
    let mut command = Command::cargo_bin("husillo").unwrap();
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// A device behind a pseudo-terminal, 50 times as fast as a real one.
struct Device {
    process: Child,
    panel: ChildStdin,
    output: BufReader<ChildStdout>,
    link: PathBuf,
}

impl Device {
    /// `None` where there are no pseudo-terminals.
    fn new(name: &str, args: &[&str]) -> Option<Device> {
        let link = std::env::temp_dir().join(format!("husillo-{name}-{}", std::process::id()));
        let mut process = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .args([
                "emulate",
                "microfactory",
                "--speed",
                "50",
                "--for",
                "120",
                "--link",
            ])
            .arg(&link)
            .args(args)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut output = BufReader::new(process.stdout.take().unwrap());
        let mut told = String::new();
        for _ in 0..3 {
            output.read_line(&mut told).unwrap();
        }
        let device = Device {
            panel: process.stdin.take().unwrap(),
            process,
            output,
            link,
        };
        if told.is_empty() {
            eprintln!("skipped: no pseudo-terminal here");
            return None;
        }
        Some(device)
    }

    /// Types a line at the panel and reads until the answer to it.
    fn type_line(&mut self, line: &str, answer: &str) -> String {
        writeln!(self.panel, "{line}").unwrap();
        self.read_until(answer)
    }

    fn read_until(&mut self, wanted: &str) -> String {
        let mut line = String::new();
        while !line.contains(wanted) {
            line.clear();
            assert_ne!(self.output.read_line(&mut line).unwrap(), 0, "no {wanted}");
        }
        line
    }

    fn jog(&self, actions: &[&str]) -> assert_cmd::assert::Assert {
        husillo()
            .arg("jog")
            .arg("--port")
            .arg(&self.link)
            .args(actions)
            .assert()
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
        let _ = std::fs::remove_file(&self.link);
    }
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
    let Some(mut device) = Device::new("cell", &[]) else {
        return;
    };
    device
        .jog(&["home", "x", "300", "c", "64", "y+", "0.1s"])
        .success();
    let place = device.type_line("where", "lost");
    assert!(
        place.contains("x 300 ") && place.contains("spindle 64 "),
        "{place}"
    );
    assert!(place.contains("from home; 0 lost"), "{place}");
}

fn jog_both(first: &Device, second: &Device, actions: &[&str]) -> assert_cmd::assert::Assert {
    husillo()
        .arg("jog")
        .arg("--port")
        .arg(&first.link)
        .arg("--port")
        .arg(&second.link)
        .args(actions)
        .assert()
}

#[test]
fn two_machines_at_once() {
    let (Some(mut first), Some(mut second)) = (Device::new("one", &[]), Device::new("two", &[]))
    else {
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
    let Some(mut device) = Device::new("panel", &[]) else {
        return;
    };
    device.jog(&["home"]).success();
    device.type_line("close y", "y is closed");
    device.jog(&["y", "-10"]).success();
    device.read_until("home switch y closed");
    device.read_until("closed still");
    device.type_line("open y", "let go");
    device.jog(&["emergency"]).success();
    device.read_until("until a reset nothing moves");
    device
        .jog(&["x", "10"])
        .code(1)
        .stderr(contains("emergency stop (then reset it)"));
    device.type_line("reset", "reset");
    device.jog(&["x", "10"]).success();
    device.type_line("unplug", "unplugged");
    device
        .jog(&["x", "10"])
        .code(1)
        .stderr(contains("no answer"));
}

#[test]
fn the_original_does_not_answer() {
    let Some(mut device) = Device::new("faithful", &["--faithful"]) else {
        return;
    };
    device
        .jog(&["home"])
        .code(1)
        .stderr(contains("--without-answers"));
    // The byte has been taken all the same.
    device.read_until("homed");
    device.jog(&["--without-answers", "z", "7"]).success();
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
