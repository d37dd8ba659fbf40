//! `husillo send -` on a micro mill: each line of a pipe or a terminal is made when it arrives.

#![cfg(unix)]

mod common;
mod emulated;

use common::husillo;
use emulated::Emulated;
use predicates::prelude::*;
use predicates::str::contains;
use serialport::{SerialPort, TTYPort};
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// A homed mill 40 times as fast as a real one, without a lease.
fn mill() -> Emulated {
    let device = Emulated::listening("micromill", &["--speed", "40"]);
    let jog = ["jog", "-m", "micromill", "--lease", "0", "--port"];
    let homed = husillo().args(jog).args([device.port(), "home"]).assert();
    homed.success();
    device
}

fn send(device: &Emulated, lines: &'static str) -> assert_cmd::assert::Assert {
    let send = ["send", "-", "-m", "micromill", "--lease", "0", "--no-home"];
    let port = ["--port", device.port()];
    let mut command = husillo();
    command.args(send).args(port).write_stdin(lines).assert()
}

/// The program with this standard input, and its output as it comes.
fn begin(device: &Emulated, options: &[&str], input: Stdio) -> Child {
    Command::new(env!("CARGO_BIN_EXE_husillo"))
        .args(["send", "-", "-m", "micromill", "--lease", "0", "--no-home"])
        .args(options)
        .args(["--port", device.port()])
        .stdin(input)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn next_line(output: &mut impl BufRead) -> String {
    let mut line = String::new();
    output.read_line(&mut line).unwrap();
    line
}

/// Every call is a session of its own: it begins where the last one ended.
#[test]
fn one_line_a_call() {
    let device = mill();
    let is_same = |position| contains("each as in the simulator").and(contains(position));
    for (line, position) in [
        ("G1 X0.05 F1\n", "x 357 y 0 z 0 steps"),
        ("G91 G0 X0.05", "x 714 y 0 z 0 steps"),
        ("G90 G0 X0 Y0\n", "x 0 y 0 z 0 steps"),
    ] {
        send(&device, line).success().stdout(is_same(position));
    }
    // It is there already.
    send(&device, "G0 X0 Y0\n")
        .success()
        .stdout(contains("Lines      0 made").and(contains("Steps      0, ")));
    send(&device, "(nothing)\n")
        .code(2)
        .stderr(contains("no command for the mill"));
}

#[test]
fn a_line_is_made_before_the_next_one_arrives() {
    let mut device = mill();
    let mut child = begin(&device, &[], Stdio::piped());
    let mut input = child.stdin.take().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    for (line, sent, place) in [
        ("G91 G0 X0.014", "G00X00014.00Y00000.00;", "x 100 y 0 z 0 "),
        // The modes of the lines before count.
        ("Y0.007", "G00X00014.00Y00007.00;", "x 100 y 50 z 0 "),
        ("G90 X0", "G00X00000.00Y00007.00;", "x 0 y 50 z 0 "),
    ] {
        writeln!(input, "{line}").unwrap();
        let shown = next_line(&mut output);
        let begin = format!("sent {sent} echo {sent} ");
        assert!(
            shown.starts_with(&begin) && shown.ends_with(" steps\n"),
            "{shown}"
        );
        let there = device.type_line("where", "lost");
        assert!(there.starts_with(place), "{there}");
    }
    writeln!(input, "M30\nG0 X1").unwrap();
    let shown = next_line(&mut output);
    assert!(shown.starts_with("sent M30; echo M30; 0 steps"), "{shown}");
    assert_eq!(next_line(&mut output), "Lines      4 made\n");
    let mut rest = String::new();
    output.read_to_string(&mut rest).unwrap();
    assert!(rest.contains("each as in the simulator"), "{rest}");
    assert!(child.wait().unwrap().success());
}

/// What follows a wrong line in a pipe was written for a program with that line.
#[test]
fn a_wrong_line_of_a_pipe_ends_it() {
    let device = mill();
    for (lines, error) in [
        ("G91 G0 X0.014\nG2 X1\nX0.014\n", "<input>:2:"),
        (
            "G91 G0 X0.014\nX-9\nX0.014\n",
            "the move ends beyond the travel",
        ),
        (
            "G91 G0 X0.014\n#1=3\nX#1\n",
            "this line needs the rest of its program",
        ),
    ] {
        send(&device, "G0 X0\n").success();
        send(&device, lines)
            .code(1)
            .stdout(contains("Lines      1 made").and(contains("x 100 y 0 z 0 steps")))
            .stderr(contains(error));
    }
    // There is no terminal to ask at.
    let device = device.port();
    let send = ["send", "-", "-m", "micromill", "--single-block", "--port"];
    if File::open("/dev/tty").is_err() {
        let sent = husillo()
            .args(send)
            .arg(device)
            .write_stdin("M5\n")
            .assert();
        sent.code(2).stderr(contains("and there is none"));
    }
}

/// A file as standard input is a program, which is checked before anything moves.
#[test]
fn a_file_as_standard_input_is_a_whole_program() {
    let device = mill();
    let path = common::written("lines.nc", "#1=0.014\nG91 G0 X#1\nX0.014\n");
    let child = begin(&device, &[], File::open(path).unwrap().into());
    let output = child.wait_with_output().unwrap();
    let out = String::from_utf8(output.stdout).unwrap();
    assert!(out.starts_with("Lines      2 made\n"), "{out}");
}

/// At a terminal each string waits for Enter, and a line with an error may be typed again.
#[test]
fn a_terminal_with_single_block() {
    let mut device = mill();
    let Ok((mut typed, mut terminal)) = TTYPort::pair() else {
        eprintln!("skipped: no pseudo-terminal here");
        return;
    };
    terminal.set_exclusive(false).unwrap();
    typed.set_timeout(Duration::from_secs(20)).unwrap();
    let input = File::open(terminal.name().unwrap()).unwrap();
    let mut child = begin(&device, &["--single-block"], input.into());
    let mut messages = BufReader::new(child.stderr.take().unwrap());
    let mut output = BufReader::new(child.stdout.take().unwrap());
    let mut told = |wanted: &str| {
        let mut line = String::new();
        while !line.contains(wanted) {
            line = next_line(&mut messages);
            assert_ne!(line, "", "no {wanted}");
        }
    };
    told("Each line is made when you end it with Enter");
    writeln!(typed, "G91 G0 X1 X2").unwrap();
    told("error[");
    writeln!(typed, "G91 G0 X0.014 Y0.007").unwrap();
    told("G00X00014.00Y00007.00; Enter sends it (or q to end)");
    let there = device.type_line("where", "lost");
    assert!(there.starts_with("x 0 y 0 z 0 "), "{there}");
    writeln!(typed).unwrap();
    let shown = next_line(&mut output);
    assert!(
        shown.starts_with("sent G00X00014.00Y00007.00; echo "),
        "{shown}"
    );
    let there = device.type_line("where", "lost");
    assert!(there.starts_with("x 100 y 50 z 0 "), "{there}");
    writeln!(typed, "X0.014").unwrap();
    told("G00X00028.00Y00007.00; Enter sends it");
    writeln!(typed, "q").unwrap();
    told("line 3: stopped before G00X00028.00Y00007.00;; 1 line made; motors at x 100 y 50");
    assert_eq!(child.wait().unwrap().code(), Some(1));
}
