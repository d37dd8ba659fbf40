//! A micro mill that moves, and a host that is asked to end: the machine stops first.

#![cfg(unix)]

mod common;

use common::signal;
use husillo_transports::micromill::{Answer, Axis, Device, Order, State};
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// A step of the controller.
const STEP: Duration = Duration::from_millis(6);
/// Most steps from the request to the last one. A jog of these tests makes 5000 in 30 s if nothing
/// stops it. How quickly the host stops it depends on the computer.
const MOST_STEPS: u64 = 3000;

/// What a controller did.
#[derive(Clone, Copy, Default)]
struct Seen {
    steps: u64,
    is_moving: bool,
    /// It hears nothing any more once it moves.
    is_deaf: bool,
    /// Orders to stop (`A`) that came since.
    unheard: u64,
}

/// A controller's end of the link on a socket: every motion continues until it is stopped, with or
/// without a host.
struct Controller {
    port: u16,
    seen: Arc<Mutex<Seen>>,
}

impl Controller {
    fn new(is_deaf: bool) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        listener.set_nonblocking(true).unwrap();
        let port = listener.local_addr().unwrap().port();
        let seen = Arc::new(Mutex::new(Seen {
            is_deaf,
            ..Seen::default()
        }));
        let shared = Arc::clone(&seen);
        std::thread::spawn(move || control(&listener, &shared));
        Self { port, seen }
    }

    fn seen(&self) -> Seen {
        *self.seen.lock().unwrap()
    }

    fn begin(&self, words: &[&str]) -> Child {
        let port = format!("tcp:127.0.0.1:{}", self.port);
        let child = Command::new(env!("CARGO_BIN_EXE_husillo"))
            .args(words)
            .args(["-m", "micromill", "--port", &port])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let end = Instant::now() + Duration::from_secs(20);
        while self.seen().steps < 20 && Instant::now() < end {
            std::thread::sleep(Duration::from_millis(5));
        }
        child
    }
}

fn control(listener: &TcpListener, seen: &Mutex<Seen>) {
    let mut device = Device::<256>::new();
    let mut line: Option<TcpStream> = None;
    let mut last = Instant::now();
    loop {
        if let Ok((stream, _)) = listener.accept() {
            stream.set_nodelay(true).unwrap();
            stream.set_nonblocking(true).unwrap();
            line = Some(stream);
        }
        let mut bytes = [0; 64];
        let count = match line.as_mut().map(|line| line.read(&mut bytes)) {
            Some(Ok(0)) => {
                line = None;
                0
            }
            Some(Ok(count)) => count,
            Some(Err(error)) if error.kind() != ErrorKind::WouldBlock => {
                line = None;
                0
            }
            _ => 0,
        };
        let mut seen = seen.lock().unwrap();
        for byte in &bytes[..count] {
            if seen.is_deaf && seen.is_moving {
                seen.unheard += u64::from(*byte == b'A');
            } else if let Some(order) = device.push(*byte) {
                obey(&mut device, &mut seen, order);
            }
        }
        if seen.is_moving && last.elapsed() >= STEP {
            last = Instant::now();
            seen.steps += 1;
            device.step(Axis::X, true);
        }
        drop(seen);
        let told: Vec<u8> = std::iter::from_fn(|| device.transmit()).collect();
        if let Some(line) = &mut line {
            let _ = line.write_all(&told);
        }
        std::thread::sleep(Duration::from_micros(500));
    }
}

fn obey(device: &mut Device<256>, seen: &mut Seen, order: Order) {
    match order {
        Order::Stop if seen.is_moving => {
            seen.is_moving = false;
            device.set_motion(false, false);
            device.answer(Answer::Stopped);
        }
        Order::Jog(_) | Order::Run(..) | Order::Steps(..) | Order::Line(_) => {
            seen.is_moving = true;
            device.set_motion(true, matches!(order, Order::Jog(_)));
            if device.is_streaming() {
                device.answer(Answer::Taken);
            }
        }
        Order::Faster | Order::Slower | Order::Renew => {}
        Order::Report => {
            let mut state = State {
                is_homed: true,
                ..State::default()
            };
            state.axes[0].load_steps = seen.steps as i32;
            device.report(&state);
        }
        _ => device.answer(Answer::Done),
    }
}

/// A program of one long move.
fn program() -> String {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("long-way.nc");
    std::fs::write(&path, "G21 G90\nG1 X5 F10\nG1 X0\nM30\n").unwrap();
    path.to_str().unwrap().to_owned()
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Ctrl-C, a request to end and a terminal that is closed, whatever moves.
#[test]
fn a_host_that_is_asked_to_end_stops_the_mill() {
    let program = program();
    for (words, name) in [
        (&["jog", "x+", "30s"][..], "INT"),
        (&["jog", "x", "5000"], "TERM"),
        (&["jog", "run", "y", "100", "30s"], "HUP"),
        (&["jog", "home", "x", "5000"], "INT"),
        (&["send", &program, "--no-home"], "INT"),
        (&["send", &program], "TERM"),
        (&["send", &program, "--stream"], "INT"),
    ] {
        let controller = Controller::new(false);
        let child = controller.begin(words);
        let before = controller.seen().steps;
        assert!(before >= 20, "{words:?} does not move");
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        let after = controller.seen();
        let told = text(&output);
        assert_eq!(output.status.code(), Some(130), "{words:?}: {told}");
        assert!(!after.is_moving, "{words:?}: it moves still; {told}");
        let steps = after.steps - before;
        assert!(steps <= MOST_STEPS, "{words:?}: {steps} steps");
        let stood = format!("motors at x {} y 0 z 0", after.steps);
        assert!(
            told.contains("interrupted: the controller has stopped; ") && told.contains(&stood),
            "{words:?}: {told}, not {stood}"
        );
    }
}

/// Without an answer the stop is sent all the same, and the host does not wait without end. After a
/// second request it waits no longer.
#[test]
fn a_mill_that_does_not_answer_the_stop_is_reported() {
    for (times, why) in [(1, "no answer"), (2, "the wait was ended")] {
        let controller = Controller::new(true);
        let child = controller.begin(&["jog", "run", "x", "100", "30s"]);
        let start = Instant::now();
        signal(&child, "INT");
        while controller.seen().unheard == 0 {
            assert!(
                start.elapsed() < Duration::from_secs(20),
                "no stop was sent"
            );
            std::thread::sleep(Duration::from_millis(1));
        }
        if times > 1 {
            signal(&child, "INT");
        }
        let output = child.wait_with_output().unwrap();
        let told = text(&output);
        assert_eq!(output.status.code(), Some(130), "{told}");
        assert!(
            told.contains("is not confirmed")
                && told.contains(why)
                && told.contains("be ready to switch off the mill"),
            "{told}"
        );
    }
}

/// What a host that was killed has left moving is stopped by another.
#[test]
fn stop_is_an_action_of_its_own() {
    let controller = Controller::new(false);
    let mut child = controller.begin(&["jog", "run", "x", "100", "30s"]);
    child.kill().unwrap();
    child.wait().unwrap();
    std::thread::sleep(Duration::from_millis(100));
    assert!(controller.seen().is_moving);
    let output = controller.begin(&["jog", "stop"]).wait_with_output();
    let output = output.unwrap();
    assert!(output.status.success(), "{}", text(&output));
    assert!(!controller.seen().is_moving);
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("stop: "));
}
