//! `husillo emulate`: the ports for its clients, and the errors of its files.

#![cfg(unix)]

mod common;
mod emulated;

use common::{husillo, scratch};
use emulated::Emulated;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// A device of the machine, which ends itself after at most this many seconds.
fn emulate(machine: &str, seconds: &str, args: &[&str]) -> assert_cmd::assert::Assert {
    let mut command = husillo();
    command
        .args(["emulate", machine, "--for", seconds])
        .args(args);
    command.assert()
}

#[test]
fn a_full_steps_file_is_named_alone() {
    if !Path::new("/dev/full").exists() {
        eprintln!("skipped: no /dev/full here");
        return;
    }
    for machine in ["micromill", "drill", "microfactory"] {
        let args = ["--listen", "127.0.0.1:0", "--steps", "/dev/full"];
        emulate(machine, "30", &args)
            .code(2)
            .stderr(contains("error: /dev/full: No space left").and(contains("127.0.0.1").not()));
    }
}

#[test]
fn a_full_standard_output_is_named_alone() {
    let Ok(full) = std::fs::OpenOptions::new().write(true).open("/dev/full") else {
        eprintln!("skipped: no /dev/full here");
        return;
    };
    let output = Command::new(env!("CARGO_BIN_EXE_husillo"))
        .args(["emulate", "drill", "--for", "30", "--listen", "127.0.0.1:0"])
        .stdin(Stdio::null())
        .stdout(full)
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(
        errors.starts_with("error: standard output: No space left"),
        "{errors}"
    );
    assert_eq!(output.status.code(), Some(2));
}

/// As every other command does.
#[test]
fn it_ends_when_the_reader_of_its_output_is_gone() {
    for machine in ["micromill", "drill", "microfactory", "cmm"] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_husillo"))
            .args(["emulate", machine, "--for", "30", "--listen", "127.0.0.1:0"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        // It may have ended already.
        let _ = writeln!(child.stdin.take().unwrap(), "where");
        let output = child.wait_with_output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(errors, "", "{machine}");
        assert_eq!(output.status.code(), Some(0), "{machine}");
    }
}

#[test]
fn a_port_that_cannot_be_had_is_named() {
    let link = scratch("no-such-folder/l1");
    let link = link.to_str().unwrap();
    for machine in ["micromill", "cmm"] {
        emulate(machine, "30", &["--link", link])
            .failure()
            .stderr(contains(format!(
                "{link}: there is no folder for this link"
            )));
    }
    for address in ["127.0.0.1", ":7000", "127.0.0.1:65536"] {
        emulate("drill", "30", &["--listen", address])
            .code(2)
            .stderr(contains("expected HOST:PORT"));
    }
}

#[test]
fn it_listens_at_the_name_of_a_host() {
    let device = Emulated::listening_at("localhost:0", "micromill", &[]);
    let port = device.port().to_owned();
    husillo()
        .args(["jog", "-m", "micromill", "--port", &port, "stop"])
        .assert()
        .success();
}

/// A Grbl controller answers, with the axes of a machine file.
#[test]
fn a_grbl_controller_has_the_axes_of_a_machine() {
    let device = Emulated::listening("grbl", &["-m", "router", "--speed", "20"]);
    let address = device.port().strip_prefix("tcp:").unwrap();
    let mut line = std::net::TcpStream::connect(address).unwrap();
    line.set_read_timeout(Some(std::time::Duration::from_secs(60)))
        .unwrap();
    line.write_all(b"$100=\n").unwrap();
    line.write_all(b"$$\n").unwrap();
    let mut said = String::new();
    while !said.ends_with("ok\r\n") {
        let mut bytes = [0; 256];
        let count = std::io::Read::read(&mut line, &mut bytes).unwrap();
        said.push_str(std::str::from_utf8(&bytes[..count]).unwrap());
    }
    assert!(said.contains("error:2\r\n"), "{said}");
    // 2.5 um a step.
    assert!(said.contains("$100=400.000\r\n"), "{said}");
}

#[test]
fn options_of_other_machines_are_not_for_grbl() {
    emulate(
        "grbl",
        "1",
        &["--listen", "127.0.0.1:0", "--contact", "1:300"],
    )
    .code(2)
    .stderr(contains("--contact is not for grbl"));
}
