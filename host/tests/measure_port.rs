//! `husillo measure`: its output, its failures and its port, as a user calls them.

mod common;
mod emulated;

use common::{husillo, measured, near, scratch, written};
use emulated::Emulated;
use predicates::prelude::*;
use predicates::str::contains;
use std::net::TcpListener;

#[test]
fn failures_are_named() {
    let fails = |args: &[&str], message: &str| {
        let assert = husillo().arg("measure").args(args).assert();
        assert
            .code(1)
            .stderr(contains(message).and(contains("help: ")));
    };
    fails(
        &["touch", "-"],
        "error: no contact from 0 counts to -8000 counts",
    );
    fails(
        &["touch", "+", "--contact", "1:-5"],
        "error: contact at start",
    );
    // A servo too weak to follow.
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let weak = written(
        "weak.toml",
        &text.replace("p = 2000, i = 50", "p = 1, i = 0"),
    );
    fails(
        &["-m", weak.to_str().unwrap(), "goto", "5000"],
        "error: position error at ",
    );
    // It is left without drive: the last stop is motor off, amplifier off.
    let output = husillo()
        .args([
            "measure",
            "-m",
            weak.to_str().unwrap(),
            "goto",
            "5000",
            "--raw",
        ])
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let last = told.lines().rfind(|line| line.starts_with("> aa 01 17"));
    assert_eq!(last, Some("> aa 01 17 02 1a"), "{told}");
    husillo()
        .args(["measure", "-m", "cmm", "goto", "1 mm"])
        .assert()
        .code(2)
        .stderr(contains("a position of this machine is in counts"));
    husillo()
        .args(["measure", "jump"])
        .assert()
        .code(2)
        .stderr(contains("unknown action `jump`"));
    husillo()
        .args(["run", "-m", "cmm", "../examples/circles.nc"])
        .assert()
        .code(2)
        .stderr(contains("see `husillo measure`"));
}

#[test]
fn results_as_text_and_table_and_the_bytes_beside_them() {
    let path = scratch("touches.csv");
    husillo()
        .args(["measure", "touch", "+", "--contact", "1:200", "--raw", "-o"])
        .arg(&path)
        .assert()
        .success()
        .stdout(contains("X touch +\n    trigger    "))
        .stderr(contains("> aa 00 21 01 ff 21\n< 19 19\n"))
        .stderr(contains("> aa 01 13 20 34\n< 19 00 04 1d\n"));
    let table = std::fs::read_to_string(path).unwrap();
    assert!(table.starts_with("action,axis,unit,position,direction,trigger,"));
    assert!(table.contains("\ntouch,X,counts,"), "{table}");
}

#[test]
fn a_dead_port_is_reported() {
    husillo()
        .args(["measure", "--port", "/dev/no-such-port", "status"])
        .assert()
        .code(2)
        .stderr(contains("/dev/no-such-port: "));
    // A port that takes everything and never answers.
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    husillo()
        .args(["measure", "--port", &port, "status"])
        .assert()
        .code(1)
        .stderr(contains("error: no answer: no module on the line"))
        .stderr(contains("help: is it the right port"));
}

#[test]
fn the_same_through_a_pseudo_terminal() {
    let args = ["--contact", "1:318", "--contact", "1:..-118"];
    let modules = ["--modules", "servo:4,servo:4", "--speed", "10"];
    let Some(network) = Emulated::new(
        "cmm",
        "measure-network",
        &[&args[..], &modules[..]].concat(),
    ) else {
        return;
    };
    let actions = ["touch", "+", "goto", "0", "touch", "-", "--pretravel", "18"];
    let simulated = measured(&[&actions[..], &args[..]].concat());
    let port = ["--port", network.port()];
    let real = measured(&[&actions[..], &port[..]].concat());
    assert_eq!(real.len(), 3);
    for row in [&simulated, &real] {
        near(&row[0]["corrected"], 300.0, 1.0);
        near(&row[1]["position"], 0.0, 1.0);
        near(&row[2]["corrected"], -100.0, 1.0);
    }
}

#[test]
fn an_emulation_ends_and_takes_its_link_away() {
    let link = scratch("short-network");
    let output = husillo()
        .args(["emulate", "cmm", "--for", "0.2", "--link"])
        .arg(&link)
        .output()
        .unwrap();
    if !output.status.success() {
        eprintln!("skipped: {}", String::from_utf8_lossy(&output.stderr));
        return;
    }
    assert!(
        String::from_utf8_lossy(&output.stdout).contains("Connect: husillo measure -m cmm --port ")
    );
    assert!(std::fs::symlink_metadata(&link).is_err());
    husillo()
        .args(["emulate", "cmm", "--modules", "stepper", "--link", "x"])
        .assert()
        .code(2)
        .stderr(contains("expected servo:4"));
}

#[test]
fn a_reader_that_is_gone_is_no_error() {
    let status = ["measure", "-m", "cmm", "status"];
    let step = ["tune", "-m", "cmm", "--method", "step"];
    for args in [&status[..], &step[..]] {
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .args(args)
            .stdin(std::process::Stdio::null())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{args:?}");
        assert_eq!(output.status.code(), Some(0), "{args:?}");
    }
}
