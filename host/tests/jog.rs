//! `husillo jog` and `husillo emulate microfactory`, as a user calls them.

mod common;
mod emulated;

use common::{husillo, signal};
use emulated::Emulated;
use predicates::prelude::*;
use predicates::str::contains;

/// A device 50 times as fast as a real one, whose leases are as much shorter; `None` where there
/// are no pseudo-terminals.
fn device(name: &str, args: &[&str]) -> Option<Emulated> {
    Emulated::new("microfactory", name, &[&["--speed", "50"], args].concat())
}

fn jog(device: &Emulated, actions: &[&str]) -> assert_cmd::assert::Assert {
    let port = ["jog", "--lease", "0", "--port", device.port()];
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
        // 400 steps at 400 a second; 5 of them, with 200 to take up before.
        .stdout(contains("x +400: 1.").and(contains("z -5: 0.")));
}

/// Before homing the position is unknown, so there are no lengths.
#[test]
fn where_has_steps_millimetres_and_inches() {
    husillo()
        .args(["jog", "where", "home", "x", "400", "z", "-5", "where"])
        .assert()
        .success()
        .stdout(contains(
            "position unknown: not homed; its counters are at x 0 y 0 z 0 spindle 0 steps\n",
        ))
        .stdout(contains(
            "x 400 y 0 z -5 spindle 0 steps, from home; x 0.748 y 0.000 z -0.009 mm; \
             x 0.0294 y 0.0000 z -0.0004 in\n",
        ));
}

#[test]
fn the_same_over_a_pseudo_terminal() {
    let made = std::env::temp_dir().join(format!(
        "husillo-microfactory-made-{}.csv",
        std::process::id()
    ));
    let Some(mut device) = device("microfactory", &["--steps", made.to_str().unwrap()]) else {
        return;
    };
    jog(&device, &["home", "x", "300", "c", "64", "y+", "0.1s"]).success();
    let place = device.type_line("where", "lost");
    assert!(
        place.contains("x 300 ") && place.contains("spindle 64 "),
        "{place}"
    );
    assert!(place.contains("from home; 0 lost"), "{place}");
    // Current and RESET come before the first step of the first move, and the spindle goes last but
    // one.
    device.end();
    let text = std::fs::read_to_string(&made).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    assert_eq!(
        rows[0],
        "event,t_us,wait_ticks,dx,dy,dz,dc,current,reset,machine"
    );
    let ends = |row: usize, end: &str| assert!(rows[row].ends_with(end), "{}", rows[row]);
    ends(1, ",0,0,0,0,0,1,0,1");
    ends(2, ",1000,0,0,0,0,1,1,1");
    ends(3, ",10000,0,0,0,0,1,0,1");
    ends(4, ",2500,-1,0,0,0,1,0,1");
    ends(rows.len() - 1, ",0,0,0,0,0,0,0,1");
    let turns = rows
        .iter()
        .filter(|row| row.ends_with(",3906,0,0,0,1,1,0,1"));
    assert_eq!(turns.count(), 64);
    std::fs::remove_file(made).unwrap();
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
    .stdout(contains(": 3 of 3 actions").count(2))
    .stdout(contains("2 of 2 machines completed all actions"));
    first.type_line("unplug", "unplugged");
    jog_both(&first, &second, &["c", "9"])
        .code(1)
        .stdout(contains("0 of 1 action,").and(contains("then no answer")))
        .stdout(contains("1 of 1 action,").and(contains("1 of 2 machines")));
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
    device.type_line("close y", "y is held closed");
    jog(&device, &["y", "-10"])
        .code(1)
        .stderr(contains("home switch y is still closed"));
    device.read_until("home switch y closed");
    device.read_until("still closed");
    device.type_line("free y", "y is free");
    jog(&device, &["emergency"]).success();
    device.read_until("nothing moves until a reset");
    jog(&device, &["x", "10"]).code(1).stderr(contains(
        "emergency stop has stopped the device: find the reason",
    ));
    device.type_line("reset", "reset");
    jog(&device, &["x", "10"]).success();
    device.type_line("unplug", "unplugged");
    jog(&device, &["x", "10"])
        .code(1)
        .stderr(contains("no answer"));
}

/// A controller of two machines: `#2` after the port is the second one.
#[test]
fn two_machines_of_one_controller() {
    let Some(mut device) = device("pair", &["--machines", "2"]) else {
        return;
    };
    let second = format!("{}#2", device.port());
    let jog = |port: &str, actions: &[&str]| {
        let all = [&["jog", "--lease", "0", "--port", port], actions].concat();
        husillo().args(all).assert()
    };
    let first = device.port().to_owned();
    jog(&first, &["home", "x", "40"]).success();
    jog(&second, &["home", "z", "7"]).success();
    jog(&first, &["y", "3"]).success();
    let place = device.type_line("where", "lost");
    assert!(place.starts_with("x 40 y 3 z 0 "), "{place}");
    let place = device.type_line("2: where", "lost");
    assert!(place.starts_with("x 0 y 0 z 7 "), "{place}");
    husillo()
        .args(["send", "../examples/microfactory/zigzag.fig"])
        .args(["-m", "microfactory", "--lease", "0", "--port", &second])
        .assert()
        .success();
    device.read_until("2: the tool touches");
    let place = device.type_line("where", "lost");
    assert!(place.starts_with("x 40 y 3 z 0 "), "{place}");
    jog(&first, &["emergency"]).success();
    device.type_line("2: where", "lost");
    jog(&second, &["x", "4"])
        .code(1)
        .stderr(contains("emergency stop"));
    jog(&format!("{first}#3"), &["x", "4"])
        .code(2)
        .stderr(contains("PORT#2"));
}

/// One host drives both machines of a controller: on one link, each with its own figure, in turns.
#[test]
fn one_host_drives_both_machines_of_a_controller() {
    let Some(mut device) = device("both", &["--machines", "2"]) else {
        return;
    };
    let first = device.port().to_owned();
    let second = format!("{first}#2");
    let both = ["--lease", "0", "--port", &first, "--port", &second];
    husillo()
        .args(["send", "../examples/microfactory/triangle.nc"])
        .args(["../examples/microfactory/zigzag.fig", "-m", "microfactory"])
        .args(both)
        .assert()
        .success()
        .stdout(contains("load triangle.nc").and(contains("load zigzag.fig")))
        .stdout(contains(": 3 of 3 actions").count(2))
        .stdout(contains("2 of 2 machines completed all actions"));
    for machine in ["", "2: "] {
        let place = device.type_line(&format!("{machine}where"), "lost");
        assert!(place.starts_with("x 0 y 1380 z 0 "), "{place}");
        assert!(place.contains("from home; 0 lost"), "{place}");
    }
    let jog = |actions: &[&str]| husillo().arg("jog").args(both).args(actions).assert();
    jog(&[
        "x", "30", "1:", "y", "-5", "z+", "0.2s", "2:", "c", "9", "z+", "0.2s",
    ])
    .success()
    .stdout(contains(": 3 of 3 actions").count(2));
    let place = device.type_line("where", "lost");
    assert!(place.starts_with("x 30 y 1375 z "), "{place}");
    let place = device.type_line("2: where", "lost");
    assert!(place.starts_with("x 30 y 1380 z "), "{place}");
    // A machine in trouble does not stop the other one.
    device.type_line("2: close y", "y is held closed");
    jog(&["y", "-10"])
        .code(1)
        .stdout(contains("home switch y").and(contains("1 of 2 machines")));
    device.type_line("2: free y", "y is free");
    let place = device.type_line("where", "lost");
    assert!(place.starts_with("x 30 y 1365 z "), "{place}");
    jog(&["1:", "emergency"]).success();
    jog(&["x", "4"])
        .code(1)
        .stdout(contains("0 of 2 machines").and(contains("emergency stop")));
    // The same machine twice, with and without its number.
    let first_again = format!("{first}#1");
    husillo()
        .args(["jog", "--port", &first, "--port", &first_again, "home"])
        .assert()
        .code(2)
        .stdout("")
        .stderr(contains("named twice"));
}

/// Ctrl-C, a request to end and a closed terminal stop what moves; Ctrl-C twice is an emergency
/// stop.
#[cfg(unix)]
#[test]
fn an_interruption_stops_what_moves() {
    let Some(mut device) = Emulated::new("microfactory", "interrupted-microfactory", &[]) else {
        return;
    };
    let where_ = |device: &mut Emulated| device.type_line("where", "lost");
    let y = |place: &str| -> i32 {
        let (_, rest) = place.split_once(" y ").unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    for (times, name, told) in [
        (
            1,
            "INT",
            "stopped; position unknown: not homed; its counters are at x 0 y ",
        ),
        (
            1,
            "TERM",
            "stopped; position unknown: not homed; its counters are at x 0 y ",
        ),
        (
            1,
            "HUP",
            "stopped; position unknown: not homed; its counters are at x 0 y ",
        ),
        (2, "INT", "stopped; emergency stop: stopped for good"),
    ] {
        let before = y(&where_(&mut device));
        let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .args(["jog", "--lease", "2550", "--port", device.port()])
            .args(["y+", "100s"])
            .stderr(std::process::Stdio::piped())
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        while y(&where_(&mut device)) < before + 5 {
            std::thread::sleep(std::time::Duration::from_millis(20));
            assert_eq!(child.try_wait().unwrap(), None);
        }
        jog(&device, &["where"])
            .code(2)
            .stderr(contains("another program has this port open"));
        for _ in 0..times {
            signal(&child, name);
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        let output = child.wait_with_output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{errors}");
        assert!(errors.contains(told), "{errors}");
        let after = where_(&mut device);
        assert_eq!(after, where_(&mut device));
        assert!(y(&after) < before + 9000, "{after}");
    }
    jog(&device, &["y", "1"])
        .code(1)
        .stderr(contains("emergency stop"));
}

/// Power that goes and comes back at the panel, and a contact that is closed there.
#[test]
fn power_and_contact_at_the_panel() {
    let Some(mut device) = device("power", &[]) else {
        return;
    };
    jog(&device, &["home", "x", "5"]).success();
    device.type_line("power off", "power is off");
    jog(&device, &["x", "5"])
        .code(1)
        .stderr(contains("no answer"));
    device.type_line("power on", "power is on");
    // Where it stands it does not know any more.
    jog(&device, &["figure"])
        .code(1)
        .stderr(contains("not homed"));
    device.type_line("close contact", "contact is held closed");
    jog(&device, &["home", "figure"]).success();
    let place = device.type_line("where", "lost");
    // The square and its diagonal, from where the tool has touched at once.
    assert!(place.starts_with("x 1000 y 0 z 1000 "), "{place}");
}

#[test]
fn the_original_does_not_answer() {
    let Some(mut device) = device("faithful", &["--faithful"]) else {
        return;
    };
    jog(&device, &["home"])
        .code(1)
        .stderr(contains("--without-answers"));
    jog(&device, &["--without-answers", "z", "7"]).success();
    let place = device.type_line("where", "lost");
    assert!(place.contains(" z 7 "), "{place}");
}

/// A switch that closes during an action ends it. The device backs off by 200 steps and reports it.
#[test]
fn a_switch_on_the_way_is_reported_over_the_link() {
    let Some(mut device) = device("switch", &[]) else {
        return;
    };
    jog(&device, &["home", "x", "300"]).success();
    jog(&device, &["x", "-600"])
        .code(1)
        .stderr(contains("home switch x closed").and(contains("x 0 y 0 z 0")));
    let place = device.type_line("where", "lost");
    assert!(
        place.contains("x 0 ") && place.contains("from home; 0 lost"),
        "{place}"
    );
}

/// Two machines, each with its own figure, one as a program and one as a list. Then one is
/// unplugged during its figure.
#[test]
fn figures_are_sent_to_two_machines_at_once() {
    let (Some(mut first), Some(mut second)) = (device("left", &[]), device("right", &[])) else {
        return;
    };
    let list = "../examples/microfactory/zigzag.fig";
    let triangle = "../examples/microfactory/triangle.nc";
    let both = |first: &Emulated, second: &Emulated, more: &[&str]| {
        let ports = ["--port", first.port(), "--port", second.port()];
        let ports = [&["--lease", "0"], &ports[..]].concat();
        let send = ["send", triangle, list, "-m", "microfactory"];
        husillo().args(send).args(ports).args(more).assert()
    };
    both(&first, &second, &[])
        .success()
        .stdout(contains("load triangle.nc").and(contains("load zigzag.fig")))
        .stdout(contains(": 3 of 3 actions").count(2))
        .stdout(contains("2 of 2 machines completed all actions"));
    for device in [&mut first, &mut second] {
        device.read_until("the tool touches");
        device.read_until("done");
        let place = device.type_line("where", "lost");
        // Both figures end where they begin, Y at the work piece.
        assert!(place.starts_with("x 0 y 1380 z 0 "), "{place}");
        assert!(place.contains("from home; 0 lost"), "{place}");
    }
    second.type_line("unplug", "unplugged");
    both(&first, &second, &["--no-home"])
        .code(1)
        .stdout(contains(": 2 of 2 actions").and(contains("1 of 2 machines")))
        .stderr(contains("no answer"));
}

/// A program as a list; the list is the same figure.
#[test]
fn a_figure_becomes_a_list_that_can_be_edited() {
    let list = common::scratch("square.fig");
    let list = list.to_str().unwrap();
    let compile = ["compile", "-m", "microfactory"];
    let square = "../examples/microfactory/square.nc";
    common::printed(&[&compile[..], &[square, "-o", list]].concat());
    let text = common::printed(&[&compile[..], &[list]].concat());
    let moves: Vec<&str> = text.lines().skip(1).collect();
    assert_eq!(
        moves,
        ["1000 0", "0 1000", "-1000 0", "0 -1000", "1000 1000"]
    );
    common::printed(&["send", list, "-m", "microfactory"]);
    // And is drawn as the program is.
    let run = |file: &str| {
        let mut run = common::json(&["run", file, "-m", "microfactory", "--format", "json"]);
        (
            run["events"].take(),
            run["end_nm"].take(),
            run["max_nm"].take(),
        )
    };
    assert_eq!(run(list), run(square));
    // A list is for no other machine.
    husillo().args(["send", list]).assert().success();
    for command in [&["run"][..], &["send", "-m", "drill"]] {
        husillo()
            .args(command)
            .arg(list)
            .assert()
            .code(2)
            .stderr(contains("-m microfactory"));
    }
}

#[test]
fn figures_and_machines_must_match() {
    let square = "../examples/microfactory/square.nc";
    let ports = ["--port", "sim", "--port", "sim", "--port", "sim"];
    husillo()
        .args(["send", square, square, "-m", "microfactory"])
        .args(ports)
        .assert()
        .code(2)
        .stderr(contains("2 figures for 3 machines: give one"));
    husillo()
        .args(["send", square, "-m", "microfactory"])
        .args(&ports[..4])
        .assert()
        .success()
        .stdout(contains("load square.nc").and(contains("2 of 2 machines")));
}

/// The original has its figure built in, and does not answer.
#[test]
fn the_original_takes_no_figure() {
    let Some(device) = device("builtin", &["--faithful"]) else {
        return;
    };
    let send = [
        "send",
        "../examples/microfactory/square.nc",
        "-m",
        "microfactory",
    ];
    husillo()
        .args(send)
        .args(["--port", device.port()])
        .assert()
        .code(1)
        .stdout(contains("FAILED: no answer"))
        .stderr(contains("--without-answers"));
}

/// A machine file with bytes of its own, at both ends.
#[test]
fn the_bytes_are_those_of_the_machine_file() {
    let text = std::fs::read_to_string("../machines/microfactory.toml").unwrap();
    let text = text
        .replace("home = \"H\"", "home = \"h\"")
        .replace("ask = \"5\"", "ask = \"0\"");
    let file = common::written("mine.toml", &text);
    let machine = file.to_str().unwrap();
    husillo()
        .args(["jog", "-m", machine, "home", "x", "63", "where"])
        .assert()
        .success()
        .stdout(contains("x 63 y 0 z 0"));
    let Some(device) = Emulated::new(machine, "bytes", &["--speed", "50"]) else {
        return;
    };
    jog(&device, &["home"]).code(1);
    husillo()
        .args(["jog", "-m", machine, "--lease", "0", "--port"])
        .args([device.port(), "home"])
        .assert()
        .success();
    let twice = common::written("twice.toml", &text.replace("keep = \"6\"", "keep = \"J\""));
    husillo()
        .args(["jog", "-m", twice.to_str().unwrap(), "home"])
        .assert()
        .code(2)
        .stderr(contains("have the same byte"));
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
