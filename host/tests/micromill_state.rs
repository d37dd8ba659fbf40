//! What only the controller of a micro mill knows: position, work zero, backlash, homing.

mod common;
mod emulated;

use common::{husillo, written};
use emulated::Emulated;
use husillo_transports::micromill::{Answer, Axis, AxisState, Device, Order, State};
use predicates::prelude::*;
use predicates::str::contains;
use std::io::{Read, Write};
use std::net::TcpListener;

/// A mill 40 times as fast as a real one. Its lease would be as much shorter, so there is none.
fn mill() -> Emulated {
    Emulated::listening("micromill", &["--speed", "40"])
}

fn does(device: &Emulated, words: &[&str]) -> assert_cmd::assert::Assert {
    husillo()
        .args(words)
        .args(["-m", "micromill", "--lease", "0", "--port", device.port()])
        .assert()
}

/// A program that reverses both axes.
fn part() -> String {
    let text = "G21 G90\nG1 X0.01 F100\nG1 X0 Y0.01\nG3 X-0.01 Y0 I0 J-0.01\nM30\n";
    written("mill_state.nc", text).to_str().unwrap().to_owned()
}

#[test]
fn a_program_begins_where_the_controller_says() {
    let mut device = mill();
    let part = part();
    does(&device, &["jog", "home", "x", "300", "y", "250", "zero"])
        .success()
        .stdout(contains("motors at x 300 y 250 z 0"));
    // Every program is a session of its own.
    let sent = does(&device, &["send", &part]);
    let is_same = contains("each as in the simulator");
    let there = contains("Position   x 229 y 250 z 0 steps from machine zero");
    sent.success().stdout(is_same.and(there));
    does(&device, &["jog", "backlash", "x", "200"]).success();
    let sent = does(&device, &["send", &part]);
    sent.success().stdout(contains("each as in the simulator"));
    does(&device, &["jog", "x", "-7", "y", "70"]).success();
    let sent = does(&device, &["send", &part, "--no-home"]);
    sent.success().stdout(contains("each as in the simulator"));
    // Streamed lines, and steps that are not all reported.
    for options in [&["--stream"][..], &["--no-home", "--every", "7"]] {
        let sent = does(&device, &[&["send", &part], options].concat());
        sent.success()
            .stdout(contains("Position   x 229 y 250 z 0"));
    }
    // The end of the part is beyond the travel from here.
    does(&device, &["jog", "x", "-200", "zero"]).success();
    let moved = device.type_line("where", "lost");
    let sent = does(&device, &["send", &part, "--no-home"]);
    sent.code(1).stderr(contains("E0401"));
    assert_eq!(device.type_line("where", "lost"), moved);
}

#[test]
fn a_new_session_knows_where_the_mill_is() {
    let mut device = mill();
    does(&device, &["jog", "x", "25", "where"])
        .success()
        .stdout(
            contains(" s, not homed\n  machine   unknown: not homed\n").and(contains(
                "motors at x 25 y 0 z 0 from the position at power-on",
            )),
        );
    does(&device, &["send", &part(), "--no-home"])
        .code(1)
        .stderr(contains("not homed, so its position is unknown"));
    does(&device, &["jog", "home", "x", "700"]).success();
    let rows = " s, homed\n  machine   X 0.098 Y 0 Z 0 mm\n  work      X 0.098 Y 0 Z 0 \
                mm\n  work zero X 0 Y 0 Z 0 mm\n  steps     x 700 y 0 z 0, motors at x 700 y 0 z \
                0\n  backlash  x 1457 y 1271 z 0 steps\n";
    does(&device, &["jog", "where"])
        .success()
        .stdout(contains(rows));
    does(&device, &["jog", "zero", "x", "-1", "where", "--inch"])
        .success()
        .stdout(
            contains("  machine   X 0.0038528 Y 0 Z 0 inch\n")
                .and(contains("  work      X -0.0000055 Y 0 Z 0 inch\n"))
                .and(contains(
                    "steps     x 699 y 0 z 0, motors at x -758 y 0 z 0",
                )),
        );
    // Its positions are lost with the supply.
    device.type_line("reset", "reset");
    does(&device, &["jog", "where"])
        .success()
        .stdout(contains("not homed"));
}

/// Obeys orders at once. `reports` steps of ten are reported; `None`: it reports no state either.
fn controller(reports: Option<u32>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut device = Device::<512>::new();
        let _ = device.transmit(); // it was switched on long ago
        let mut state = State {
            is_homed: true,
            ..State::default()
        };
        let mut bytes = [0; 64];
        while let Ok(count) = stream.read(&mut bytes) {
            if count == 0 {
                return;
            }
            for byte in &bytes[..count] {
                match device.push(*byte) {
                    None => {}
                    Some(Order::Report) if reports.is_some() => device.report(&state),
                    Some(Order::Report) => device.answer(Answer::Wrong),
                    Some(Order::Home) => {
                        state = state.homed();
                        device.answer(Answer::Done);
                    }
                    Some(Order::Steps(axis, steps)) => {
                        let AxisState { load_steps, .. } = &mut state.axes[axis as usize];
                        *load_steps += i32::from(steps);
                        for count in 0..u32::from(steps.unsigned_abs()) {
                            if count % 10 < reports.unwrap_or(10) {
                                device.step(axis, steps > 0);
                            }
                        }
                        device.answer(Answer::Done);
                    }
                    Some(Order::Line(_)) => {
                        device.step(Axis::X, true);
                        state.axes[0].load_steps += 1;
                        device.answer(Answer::Done);
                    }
                    Some(_) => device.answer(Answer::Done),
                }
            }
            let told: Vec<u8> = std::iter::from_fn(|| device.transmit()).collect();
            let _ = stream.write_all(&told);
        }
    });
    port
}

/// An older controller does not know the string.
#[test]
fn what_the_controller_cannot_say_is_unknown() {
    let jog = |actions: &[&str]| {
        let port = controller(None);
        let begin = ["jog", "-m", "micromill", "--port", &port];
        husillo().args(begin).args(actions).assert().success()
    };
    jog(&["where"]).stdout(contains(
        " s, position, work zero and backlash are unknown: the controller does not \
         report where it is",
    ));
    jog(&["x", "25"]).stdout(contains(
        "25 steps; motors moved by x 25 y 0 z 0, the controller does not report where it is",
    ));
    let line = written("mill_step.mm", "G00X00000.14;\n");
    husillo()
        .args(["send", line.to_str().unwrap(), "-m", "micromill", "--port"])
        .arg(controller(None))
        .assert()
        .success()
        .stdout(
            contains("State      unknown: the controller does not report position")
                .and(contains("Steps      1, each as in the simulator"))
                .and(contains("Position").not()),
        );
}

/// Bytes of the line may be lost. The controller's own count shows it.
#[test]
fn steps_that_were_not_reported_are_noticed() {
    let well = controller(Some(10));
    let jog = ["jog", "-m", "micromill", "--port"];
    let jog = |port: &str| husillo().args(jog).args([port, "y", "-40"]).assert();
    jog(&well).success();
    let lossy = controller(Some(9));
    jog(&lossy)
        .code(1)
        .stderr(contains("36 steps; motors at x 0 y -40 z 0").and(contains(
            "the controller is x +0 y -4 z +0 steps from where its reported steps end",
        )));
}

/// The file of a mill whose motors make quarter steps.
#[test]
fn a_mill_with_other_steps_has_a_file() {
    let text = std::fs::read_to_string("../machines/micromill.toml").unwrap();
    let text = text.replace("\"0.14 um\"", "\"0.035 um\"");
    let text = text.replace("mode = \"full\"", "mode = \"quarter\"");
    let file = written("quarter.toml", &text);
    let file = file.to_str().unwrap();
    let jog = |port: &str| {
        let jog = ["jog", "y", "-40", "where", "-m", file, "--port", port];
        husillo().args(jog).assert()
    };
    jog(&controller(Some(10)))
        .success()
        .stdout(contains("machine   X 0 Y -0.0014 Z 0 mm"));
    jog("sim").code(2).stderr(contains("steps of 140 nm"));
    let line = written("quarter.mm", "G00X00000.04;\n");
    husillo()
        .args(["send", line.to_str().unwrap(), "-m", file, "--port"])
        .arg(controller(Some(10)))
        .assert()
        .success()
        .stdout(contains("Position   x 1 y 0 z 0 steps"));
}
