//! The same session with every emulated controller behind a pseudo-terminal, and with one behind a
//! socket.

#![cfg(unix)]

mod common;
mod emulated;

use common::{husillo, signal, written};
use emulated::Emulated;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A machine, and the actions for it.
struct Session {
    machine: &'static str,
    /// Times real time.
    speed: &'static str,
    /// Moves after the job, and what the panel reports after them.
    moves: &'static [&'static str],
    place: &'static str,
    /// A lease that outlasts the delays of a busy computer, where there are leases.
    patience: &'static [&'static str],
    /// A jog that lasts longer than the test.
    jog: [&'static str; 2],
    job: Job,
    /// Whether the session is also held behind a socket. The code of the ports does not depend on
    /// the machine.
    has_socket: bool,
}

/// A program for a homed machine.
struct Job {
    file: &'static str,
    program: &'static str,
    options: &'static [&'static str],
    /// What `send` prints at its end.
    printed: &'static str,
}

/// Checks a machine behind a pseudo-terminal, and behind a socket if it has one or the system has
/// no pseudo-terminals.
fn check(session: &Session) {
    // The line is as much faster, too; leases and dead-man's times are as much shorter.
    let args = ["--speed", session.speed];
    let terminal = Emulated::new(session.machine, session.machine, &args);
    let needs_socket = session.has_socket || terminal.is_none();
    let socket = needs_socket.then(|| Emulated::listening(session.machine, &args));
    // A pseudo-terminal is locked by its client; a socket is closed by the emulation.
    let locked = "another program has this port open";
    let closed = "the other end closed the connection: is another client connected?";
    let terminal = terminal.map(|device| (device, locked));
    let socket = socket.map(|device| (device, closed));
    for (mut device, refusal) in terminal.into_iter().chain(socket) {
        well(session, &device, &["home"]);
        a_job_is_made(session, &device);
        is_moved(session, &mut device);
        ctrl_c_stops_it(session, &mut device);
        a_second_terminal_stops_it(session, &mut device);
        a_second_client_is_turned_away(session, &mut device, refusal);
        the_next_client_takes_over_from_a_killed_one(session, &mut device);
    }
}

#[test]
fn a_session_with_the_micro_mill() {
    check(&Session {
        machine: "micromill",
        speed: "2",
        // The job leaves Y where it was.
        moves: &["y", "30"],
        place: "y 30 z 0 steps from machine zero",
        patience: &["--lease", "3000"],
        jog: ["x+", "60s"],
        job: Job {
            file: "clients.mm",
            program: "G00X00020.00;\n",
            options: &["--no-home"],
            printed: "each as in the simulator",
        },
        has_socket: false,
    });
}

#[test]
fn a_session_with_the_drill() {
    check(&Session {
        machine: "drill",
        speed: "8",
        moves: &["home", "y", "30"],
        place: "y 30 steps from home",
        patience: &["--lease", "9999"],
        jog: ["x+", "60s"],
        job: Job {
            file: "clients.nc",
            program: "%\nG21\nG90\nX1 Y0.5\n%\n",
            options: &[],
            printed: "1 hole drilled",
        },
        has_socket: true,
    });
}

#[test]
fn a_session_with_the_microfactory() {
    check(&Session {
        machine: "microfactory",
        speed: "2",
        moves: &["home", "y", "30"],
        place: "x 0 y 30 z 0 spindle ",
        patience: &["--lease", "2550"],
        jog: ["x+", "60s"],
        job: Job {
            file: "clients.fig",
            program: "20 10\n0 -10\n-20 0\n",
            options: &["--no-home"],
            printed: "2 of 2 actions",
        },
        has_socket: false,
    });
}

fn jog(session: &Session, device: &Emulated, actions: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_husillo"));
    command
        .args(["jog", "-m", session.machine, "--port", device.port()])
        .args(session.patience)
        .args(actions)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn well(session: &Session, device: &Emulated, actions: &[&str]) {
    let output = jog(session, device, actions).output().unwrap();
    assert!(output.status.success(), "{actions:?}: {}", text(&output));
}

fn text(output: &Output) -> String {
    let [out, error] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    format!("{out}{error}")
}

/// A jog in progress, after homing if the client homes first.
fn begin(session: &Session, device: &mut Emulated) -> Child {
    let child = jog(session, device, &session.jog).spawn().unwrap();
    moves(device);
    child
}

/// Waits until it moves, with its axes homed.
fn moves(device: &mut Emulated) {
    let end = Instant::now() + Duration::from_secs(30);
    loop {
        let before = device.type_line("where", "lost");
        sleep(Duration::from_millis(50));
        let place = device.type_line("where", "lost");
        if place != before
            && ![&before, &place]
                .iter()
                .any(|text| text.contains("not homed"))
        {
            return;
        }
        assert!(Instant::now() < end, "it does not jog: {place}");
    }
}

/// Where it stands, once it does. The time that a stop takes is measured in simulated time by the
/// tests of the controllers and clients. The jogs here would last much longer than this waits.
fn stands(device: &mut Emulated) -> String {
    let end = Instant::now() + Duration::from_secs(20);
    loop {
        let before = device.type_line("where", "lost");
        sleep(Duration::from_millis(300));
        let place = device.type_line("where", "lost");
        if place == before {
            return place;
        }
        assert!(Instant::now() < end, "it goes on: {before} {place}");
    }
}

fn is_moved(session: &Session, device: &mut Emulated) {
    well(session, device, session.moves);
    let place = device.type_line("where", "lost");
    assert!(
        place.contains(session.place),
        "{}: {place}",
        session.machine
    );
    let is_whole = place.contains(" 0 steps lost") || place.contains("; 0 lost");
    assert!(is_whole, "{}: {place}", session.machine);
}

fn a_job_is_made(session: &Session, device: &Emulated) {
    let job = &session.job;
    let output = husillo()
        .args(["send", "-m", session.machine, "--port", device.port()])
        .args(session.patience)
        .arg(written(job.file, job.program))
        .args(job.options)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", text(&output));
    assert!(text(&output).contains(job.printed), "{}", text(&output));
}

fn ctrl_c_stops_it(session: &Session, device: &mut Emulated) {
    let child = begin(session, device);
    signal(&child, "INT");
    let output = child.wait_with_output().unwrap();
    assert!(!output.status.success(), "{}", text(&output));
    stands(device);
}

fn stop(session: &Session, device: &Emulated, arguments: &[&str]) -> Output {
    let stop = husillo()
        .args(["stop", "-m", session.machine, "--port", device.port()])
        .args(arguments)
        .output();
    stop.unwrap()
}

/// The program that holds the port stops its machine; the machine confirms it.
fn a_second_terminal_stops_it(session: &Session, device: &mut Emulated) {
    let child = begin(session, device);
    let stopped = stop(session, device, &[]);
    assert!(stopped.status.success(), "{}", text(&stopped));
    let holder = format!("`husillo jog -m {} ", session.machine);
    assert!(text(&stopped).contains(&holder), "{}", text(&stopped));
    stands(device);
    let output = child.wait_with_output().unwrap();
    assert!(!output.status.success(), "{}", text(&output));
    // And while no program holds the port.
    let stopped = stop(session, device, &[]);
    assert!(stopped.status.success(), "{}", text(&stopped));
    assert!(text(&stopped).starts_with("stop: "), "{}", text(&stopped));
}

fn a_second_client_is_turned_away(session: &Session, device: &mut Emulated, refusal: &str) {
    let child = begin(session, device);
    let second = jog(session, device, session.moves).output().unwrap();
    let errors = String::from_utf8_lossy(&second.stderr);
    assert!(!second.status.success(), "{}", session.machine);
    assert!(errors.contains(refusal), "{}: {errors}", session.machine);
    // The first one has not heard of it.
    moves(device);
    signal(&child, "INT");
    child.wait_with_output().unwrap();
}

fn the_next_client_takes_over_from_a_killed_one(session: &Session, device: &mut Emulated) {
    let mut child = begin(session, device);
    child.kill().unwrap();
    child.wait().unwrap();
    // A microfactory carries out the words that it has; the others have a lease.
    stands(device);
    well(session, device, &["home"]);
    is_moved(session, device);
}
