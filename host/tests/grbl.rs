//! `send`, `jog` and `stop` for a Grbl controller, as a user calls them.

mod common;
mod emulated;

use common::{husillo, scratch, signal};
use emulated::Emulated;
use predicates::prelude::*;
use predicates::str::contains;
use std::io::Write;
use std::process::{Command, Stdio};

/// 200 moves of 0.1 mm, and back.
fn program() -> String {
    let there = (1..=200).map(|number| format!("G1 X{:.1}\n", f64::from(number) / 10.0));
    let body: String = there.collect();
    format!("%\n(a line of short moves)\nG21 G90 G94\n\nG1 F300 ; slow\n{body}G0 X0\nM2\n%\n")
}

fn saved(name: &str, text: &str) -> String {
    let file = scratch(name);
    std::fs::write(&file, text).unwrap();
    file.to_str().unwrap().to_owned()
}

#[test]
fn a_program_in_simulated_time() {
    let file = saved("grbl-send.nc", &program());
    husillo()
        .args(["send", &file, "-m", "grbl"])
        .assert()
        .success()
        .stdout(contains("204 lines made; "))
        .stdout(contains("machine X 0.000 Y 0.000 Z 0.000 mm"));
}

/// Its buffer is longer than Grbl's, and its reports have other fields.
#[test]
fn a_program_and_a_move_by_hand_with_the_protocol_of_grblhal() {
    let device = Emulated::listening("grblhal", &["--speed", "20"]);
    let file = saved("grblhal-send.nc", &program());
    husillo()
        .args(["send", &file, "-m", "grbl", "-y", "--port", device.port()])
        .assert()
        .success()
        .stdout(contains("204 lines made; "));
    husillo()
        .args([
            "jog",
            "-m",
            "grbl",
            "--port",
            device.port(),
            "by",
            "X2.5",
            "where",
        ])
        .assert()
        .success()
        .stdout(contains("machine X 2.500 Y 0.000 Z 0.000 mm"));
}

#[test]
fn what_grbl_refuses_is_not_sent() {
    for (name, text, part) in [
        ("grbl-wrong.nc", "G1 X1 F100 Q\n", "error"),
        (
            "grbl-long.nc",
            &format!("G1 F100 X1{}\n", "0".repeat(90)),
            "",
        ),
    ] {
        let file = saved(name, text);
        husillo()
            .args(["send", &file, "-m", "grbl"])
            .assert()
            .code(1)
            .stderr(contains(part));
    }
}

#[test]
fn by_hand_in_simulated_time() {
    husillo()
        .args([
            "jog", "-m", "grbl", "feed", "500", "by", "X2.5", "zero", "X",
        ])
        .args(["by", "X-1", "where", "settings"])
        .assert()
        .success()
        .stdout(contains("by X2.5: "))
        .stdout(contains(
            "Idle; work X -1.000 Y 0.000 Z 0.000 mm; machine X 1.500",
        ))
        .stdout(contains("$110=500.000 (X"));
    husillo()
        .args(["jog", "-m", "grbl", "home"])
        .assert()
        .code(1)
        .stderr(contains("homing is not enabled"));
}

/// From a line on: above the path first, then to the start of the line, the spindle, and down.
#[test]
fn a_program_from_a_line_on() {
    let text = "G21 G90\nG0 Z5\nM3 S800\nG0 X2 Y1\nG1 Z-1 F200\nG91\nX3\nY4\nG90\nG0 Z5\nM5\n";
    let file = saved("grbl-from.nc", text);
    let husillo = |more: &[&str]| {
        let mut husillo = husillo();
        husillo.args(["send", &file, "-m", "grbl"]).args(more);
        husillo
    };
    husillo(&["--from", "8", "-y"])
        .assert()
        .success()
        .stdout(contains("machine X 5.000 Y 5.000 Z 5.000 mm"));
    husillo(&["--from", "8"])
        .write_stdin("q\n")
        .assert()
        .code(1)
        .stderr(contains(
            "  G21 G90 G94 G17 G54\n  G0 Z5\n  G0 X5 Y1\n  M3 S800\n  G1 Z-1 F200\n  \
             G17 G21 G91 G94 G1\n  Y4\n",
        ));
    husillo(&["--from", "40", "-y"])
        .assert()
        .code(1)
        .stderr(contains("the program has no command there"));
}

/// Another terminal stops a program: the axes brake, and the position stays valid.
#[test]
fn another_terminal_stops_a_program() {
    let Some(mut device) = Emulated::new("grbl", "grbl-stop", &[]) else {
        return;
    };
    let file = saved("grbl-stopped.nc", &program());
    let sender = Command::new(env!("CARGO_BIN_EXE_husillo"))
        .args(["send", &file, "-m", "grbl", "--port", device.port()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Until the program moves the axes.
    while device.type_line("where", "lost").starts_with("x 0 ") {}
    husillo()
        .args(["stop", "-m", "grbl", "--port", device.port()])
        .assert()
        .success();
    let ended = sender.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(130));
    let told = String::from_utf8(ended.stderr).unwrap();
    assert!(
        told.contains("interrupted: the controller has stopped; "),
        "{told}"
    );
    assert!(told.contains("are made"), "{told}");
    // No alarm, so a jog is possible.
    husillo()
        .args([
            "jog",
            "-m",
            "grbl",
            "--port",
            device.port(),
            "by",
            "Y1",
            "where",
        ])
        .assert()
        .success()
        .stdout(contains("Idle; "));
    let place = device.type_line("where", "lost");
    assert!(place.contains(" 0 steps lost"), "{place}");
}

/// A killed program leaves a controller that makes the rest of its queue. Nothing begins on top of
/// it, and `stop` ends it.
#[test]
fn a_killed_sender_is_told_of() {
    let Some(mut device) = Emulated::new("grbl", "grbl-kill", &[]) else {
        return;
    };
    let file = saved("grbl-killed.nc", "G21 G91 G1 F60\nX5\nX5\nX5\n");
    let mut sender = Command::new(env!("CARGO_BIN_EXE_husillo"))
        .args(["send", &file, "-m", "grbl", "--port", device.port()])
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    while device.type_line("where", "lost").starts_with("x 0 ") {}
    signal(&sender, "KILL");
    sender.wait().unwrap();
    husillo()
        .args(["send", &file, "-m", "grbl", "--port", device.port()])
        .assert()
        .code(1)
        .stderr(contains("moves for another program").and(contains("husillo stop -m grbl")));
    husillo()
        .args(["stop", "-m", "grbl", "--port", device.port()])
        .assert()
        .success();
    husillo()
        .args(["jog", "-m", "grbl", "--port", device.port(), "where"])
        .assert()
        .success()
        .stdout(contains("where: ").and(contains("Idle; ")));
}

/// The operator may think as long as he likes, and hears what happens meanwhile.
#[test]
fn line_by_line_without_haste() {
    let Some(mut device) = Emulated::new("grbl", "grbl-single", &["--speed", "20"]) else {
        return;
    };
    let file = saved("grbl-single.nc", "G21 G91 G1 F600\nX5\nX7\n");
    let port = device.port().to_owned();
    let send = || {
        Command::new(env!("CARGO_BIN_EXE_husillo"))
            .args([
                "send",
                &file,
                "-m",
                "grbl",
                "--single-block",
                "--port",
                &port,
            ])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    };
    let mut sender = send();
    // A controller that is silent for 3 s counts as lost. This one is not.
    std::thread::sleep(std::time::Duration::from_secs(4));
    sender.stdin.take().unwrap().write_all(b"\n\n\n").unwrap();
    let ended = sender.wait_with_output().unwrap();
    let told = String::from_utf8(ended.stdout).unwrap() + &String::from_utf8_lossy(&ended.stderr);
    assert!(told.contains("3 lines made; "), "{told}");
    assert!(told.contains("machine X 12.000"), "{told}");

    let mut sender = send();
    let mut typed = sender.stdin.take().unwrap();
    typed.write_all(b"\n\n").unwrap();
    while device.type_line("where", "lost").starts_with("x 3000 ") {}
    device.type_bytes(b"reset\n");
    let ended = sender.wait_with_output().unwrap();
    drop(typed);
    let told = String::from_utf8(ended.stderr).unwrap();
    assert!(told.contains("the controller was reset"), "{told}");
}
