//! `husillo measure`: homes, travels, end switches and tables of errors, as a user calls them.

mod common;
mod emulated;

use common::{husillo, measured, near, number, printed, scratch, written};
use emulated::Emulated;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use std::io::{BufRead, BufReader};

/// A machine file with more lines.
fn cmm3_with(name: &str, lines: &str) -> String {
    let machines = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines");
    let text = std::fs::read_to_string(machines.join("cmm3.toml")).unwrap();
    let path = written(name, &format!("{text}\n{lines}"));
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_table_of_errors_needs_a_home() {
    let machine = cmm3_with(
        "table.toml",
        "[axis.x.calibration]\nscale = \"50 um/m\"\ntable = [[\"-200 mm\", \"0 um\", \"0 um\"], \
         [\"0 mm\", \"100 um\", \"100 um\"], [\"200 mm\", \"0 um\", \"0 um\"]]\n",
    );
    let on = |args: &[&str]| {
        let mut command = husillo();
        command.args(["measure", "-m", &machine]).args(args);
        command.assert()
    };
    let not_homed =
        "error: X is not homed: its table of errors counts from the index\n  help: `home` it first";
    for args in [
        &["goto", "Y1"][..],
        &["touch", "+x"],
        &["home", "y", "goto", "X1"],
        &["calibrate", "sphere", "X0", "Y0", "Z-20", "R10"],
    ] {
        on(args).code(1).stderr(contains(not_homed));
    }
    // What needs no place is done.
    on(&["jog", "+x", "200ms", "status", "zero", "x"]).success();
    let routine = written(
        "homed.routine",
        "goto x 3 y 1\npoint P at x 5.1 y 1 z 0 towards +x\n",
    );
    let run = [
        "run",
        routine.to_str().unwrap(),
        "--contact",
        "1:2500",
        "--ball",
        "0",
    ];
    on(&run).code(3).stderr(contains("X is not homed"));
    // The index of the simulated encoder is at its start: at 0 the table has 100 um, at 5 mm 97.5.
    let rows = measured(&["-m", &machine, "home", "x", "goto", "X5"]);
    near(&rows[1]["position"], 5.0, 0.002);
    let before = on(&[&["home", "x", "goto", "X1"], &run[..]].concat()).success();
    let told = String::from_utf8_lossy(&before.get_output().stdout).into_owned();
    assert!(
        told.contains("X home: at ") && told.contains("point P"),
        "{told}"
    );
}

/// Scales that read 2 mm/m short: errors are reported in positions, as results are.
#[test]
fn troubles_name_true_positions() {
    let machine = cmm3_with(
        "short-scales.toml",
        "[axis.x.calibration]\nscale = \"2000 um/m\"\n",
    );
    for (args, told) in [
        (
            &["goto", "X250"][..],
            "error: X 250.0000 mm is outside the travel, -200.4000 mm to 200.4000 mm",
        ),
        (
            &["goto", "X10", "zero", "goto", "X250"],
            "error: X 250.0000 mm is outside the travel, -210.4",
        ),
        (
            &["touch", "+x"],
            "to X 200.4000 mm, Y 0.0000 mm, Z 0.0000 mm",
        ),
    ] {
        husillo()
            .args(["measure", "-m", &machine])
            .args(args)
            .assert()
            .code(1)
            .stderr(contains(told));
    }
}

#[test]
fn home_is_where_the_index_is_met_from_below() {
    // The index is at every 400 counts, and at 0 when it is switched on.
    let rows = measured(&[
        "home", "x", "goto", "-50", "goto", "130", "home", "goto", "-400",
    ]);
    for (row, wanted) in rows.iter().zip([0.0, -50.0, 130.0, 0.0, -400.0]) {
        near(&row["position"], wanted, 1.0);
    }
    // The second one is the next: 400 farther, so 400 less are left of the travel of 8000.
    let far = ["goto", "7590", "home", "goto", "0"];
    let rows = measured(&far);
    near(&rows[1]["position"], 0.0, 1.0);
    let rows = measured(&["-m", "cmm3", "--axis", "y", "goto", "0.1", "home", "status"]);
    near(&rows[1]["position"], 0.0, 0.002);
    // None between 50 and 300.
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let short = written(
        "short.toml",
        &text.replace("\"8000 counts\"]", "\"300 counts\"]"),
    );
    husillo()
        .args([
            "measure",
            "-m",
            short.to_str().unwrap(),
            "goto",
            "50",
            "home",
        ])
        .assert()
        .code(1)
        .stderr(contains("error: no index of X up to the end of the travel"));
}

#[test]
fn an_axis_is_jogged_at_two_speeds_and_within_its_travel() {
    let jogs = [
        "home", "jog", "+x", "2s", "jog", "-", "500ms", "slow", "goto", "0",
    ];
    let rows = &measured(&jogs)[1..];
    let at = |row: &Value| row["position"].as_f64().unwrap();
    // 1200 counts/s for 2 s, with ramps of 0.2 s; 200 counts/s for half a second.
    assert!((2250.0..2450.0).contains(&at(&rows[0])), "{rows:?}");
    assert!(
        (75.0..125.0).contains(&(at(&rows[0]) - at(&rows[1]))),
        "{rows:?}"
    );
    near(&rows[2]["position"], 0.0, 1.0);
    // Before homing the speed is that of a search in both cases.
    let rows = measured(&["jog", "+x", "2s", "jog", "-x", "60s"]);
    assert!((375.0..425.0).contains(&at(&rows[0])), "{rows:?}");
    let rows = measured(&["jog", "-x", "60s"]);
    assert!((-8000.0..-7500.0).contains(&at(&rows[0])), "{rows:?}");
}

#[test]
fn an_axis_that_brakes_for_long_is_waited_for() {
    // 1200 counts/s and 300 counts/s^2: 4 s to brake.
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let slow = scratch("slow.toml");
    let text = text.replace("6000 counts/s^2", "300 counts/s^2");
    std::fs::write(&slow, text).unwrap();
    let slow = slow.to_str().unwrap();
    let rows = &measured(&["-m", slow, "home", "jog", "+", "5s", "goto", "0"])[1..];
    // 2400 counts to 1200 counts/s in 4 s, 1200 in one more, 2400 to brake.
    let at = rows[0]["position"].as_f64().unwrap();
    assert!((5900.0..6200.0).contains(&at), "{rows:?}");
    near(&rows[1]["position"], 0.0, 1.0);
}

/// Zero and home hold from one command to the next, also after an interruption and a stop. They
/// end with a reset of the modules.
#[cfg(unix)]
#[test]
fn the_next_command_goes_on_where_the_last_one_ended() {
    let Some(mut network) = Emulated::new("cmm", "memory", &["--speed", "20"]) else {
        return;
    };
    let port = network.port().to_owned();
    // A file of the name of the machine is not the machine.
    let folder = scratch("memory-folder");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("cmm"), "").unwrap();
    let folders = std::cell::Cell::new(0);
    let run = |actions: &[&str]| {
        let mut command = husillo();
        command.args(["measure", "--port", &port, "--format", "json"]);
        folders.set(folders.get() + 1);
        if folders.get() % 2 == 0 {
            command.current_dir(&folder);
        }
        let output = command.args(actions).output().unwrap();
        let errors = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{actions:?}: {errors}");
        let mut rows: Value = serde_json::from_slice(&output.stdout).unwrap();
        (rows["results"].take(), errors)
    };
    let (_, told) = run(&["goto", "30", "home", "x", "goto", "120", "zero"]);
    assert!(
        told.contains("note: the servos stay on and hold; zero and home are kept\n"),
        "{told}"
    );
    let (rows, told) = run(&["goto", "100"]);
    near(&rows[0]["position"], 100.0, 1.0);
    assert!(!told.contains("lost"), "{told}");
    // The index was met at 400 counts, so the module counts 400 + 120 + 100.
    let (rows, _) = run(&["home", "x"]);
    near(&rows[0]["position"], 0.0, 1.0);

    // A killed program leaves a jog that runs on. The next command stops it and keeps what is
    // known, and so does a stop.
    run(&["goto", "50", "zero"]);
    let killed = |actions: &[&str]| {
        let mut jog = std::process::Command::new(env!("CARGO_BIN_EXE_husillo"))
            .env("XDG_STATE_HOME", common::state())
            .args(["measure", "--raw", "--port", &port])
            .args(actions)
            .stderr(std::process::Stdio::piped())
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        let lines = BufReader::new(jog.stderr.take().unwrap()).lines();
        // A trajectory, and some readings after it.
        let lines = lines
            .map_while(Result::ok)
            .skip_while(|line| !line.starts_with("> aa 01 d4 "));
        assert_eq!(lines.take(40).count(), 40);
        jog.kill().unwrap();
        jog.wait().unwrap();
    };
    let origins = || {
        let (rows, told) = run(&["where"]);
        assert!(!told.contains("killed") && !told.contains("lost"), "{told}");
        let of = |name: &str| number(&rows[0][name]);
        // Of the module at home, and from home to the zero.
        [of("steps") - of("machine"), of("machine") - of("work")]
    };
    let before = origins();
    killed(&["jog", "+x", "60s"]);
    let (rows, told) = run(&["status"]);
    assert!(
        told.starts_with("note: the program before was killed."),
        "{told}"
    );
    assert!(number(&rows[0]["position"]) > 5.0, "{rows}");
    assert_eq!(origins(), before);
    // Homing that was not completed changes nothing: the earlier home holds.
    run(&["goto", "300"]);
    killed(&["home", "x"]);
    let (_, told) = run(&["status"]);
    assert!(
        told.starts_with("note: the program before was killed."),
        "{told}"
    );
    assert_eq!(origins(), before);
    run(&["goto", "0"]);
    killed(&["jog", "+x", "60s"]);
    let stopped = printed(&["stop", "-m", "cmm", "--port", &port]);
    let at = stopped
        .split_whitespace()
        .nth(3)
        .unwrap()
        .parse::<f64>()
        .unwrap();
    let (rows, told) = run(&["status"]);
    assert!(!told.contains("lost"), "{told}");
    assert!(number(&rows[0]["position"]) > 5.0, "{rows}");
    let zero = at - number(&rows[0]["position"]);
    let (rows, _) = run(&["--reset", "status"]);
    near(&rows[0]["position"], 0.0, 1.0);
    assert!(zero > 400.0, "{zero}");

    // A pulled cable loses nothing, also if a command has failed meanwhile.
    let fails = || {
        let mut command = husillo();
        let output = command.args(["measure", "--port", &port, "where"]).output();
        let errors = String::from_utf8(output.unwrap().stderr).unwrap();
        assert!(errors.contains("no module on the line"), "{errors}");
        assert!(!errors.contains("lost"), "{errors}");
    };
    run(&["home", "x", "goto", "50", "zero"]);
    let before = origins();
    network.type_line("unplug", "unplugged");
    fails();
    network.type_line("plug", "plugged in");
    assert_eq!(origins(), before);

    network.type_line("power off", "power is off");
    fails();
    network.type_line("power on", "power is on");
    let (rows, told) = run(&["status"]);
    let lost = "note: the modules were reset or moved, so zero and home are lost\n";
    assert!(told.starts_with(lost), "{told}");
    near(&rows[0]["position"], 0.0, 1.0);
}

/// An axis that is not homed moves slowly. A note says so once.
#[test]
fn an_axis_that_is_not_homed_is_announced_once() {
    let note = "note: X is not homed: it moves at 200 counts/s, and its travel counts from where \
                it stood\n";
    let told = |actions: &[&str]| {
        let output = husillo().arg("measure").args(actions).output().unwrap();
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(told(&["goto", "300", "jog", "+x", "1s", "goto", "0"]), note);
    assert_eq!(told(&["home", "x", "goto", "300"]), "");
    // From home at the second index on, 400 counts from where the axis stood.
    let beyond = told(&["goto", "30", "home", "goto", "8001"]);
    assert!(beyond.contains("error: X 8001 counts is outside the travel, -8000 counts to 8000"));
    let rows = measured(&["goto", "30", "home", "goto", "8000", "where"]);
    near(&rows[3]["steps"], 8400.0, 1.0);
}

/// A machine of one axis with a low end switch at limit 2.
fn with_end_switch(name: &str) -> String {
    let text = std::fs::read_to_string("../machines/cmm.toml").unwrap();
    let text = text.replace("in_position", "limit_2 = \"end-low\"\nin_position");
    written(name, &text).to_str().unwrap().to_owned()
}

#[test]
fn an_end_switch_is_a_fault_with_an_exit_status_of_its_own() {
    let machine = with_end_switch("end-switch.toml");
    let on = ["measure", "-m", &machine, "--end", "1:..-500"];
    let met = [&on[..], &["goto", "-900", "goto", "0"]].concat();
    husillo().args(met).assert().code(5).stderr(
        contains("error: the low end switch of X has closed at X -500 counts, at about ")
            .and(contains(" counts/s; all axes have been stopped"))
            .and(contains("  help: move in the opposite direction")),
    );
    // A session goes on, away from the switch.
    let session = husillo()
        .args([&on[..], &["session", "--format", "csv"]].concat())
        .write_stdin("goto -900\ngoto -950\ngoto 0\ngoto 10\nend\n")
        .assert()
        .code(5)
        .stderr(contains(" has closed at ").and(contains(
            "error: the low end switch of X is closed at X -50",
        )));
    let text = String::from_utf8(session.get_output().stdout.clone()).unwrap();
    assert_eq!(text.matches("goto,X,counts,").count(), 2, "{text}");
    // Home is the same index next to the switch, wherever the axis stood.
    for away in ["-300", "100", "700"] {
        let on = ["-m", &machine, "--end", "1:..-650"];
        let rows = measured(&[&on[..], &["goto", away, "home", "where"]].concat());
        near(&rows[2]["steps"], -400.0, 1.0);
        near(&rows[2]["machine"], 0.0, 1.0);
    }
    husillo()
        .args(["measure", "-m", &machine, "--end", "1:500", "status"])
        .assert()
        .code(2)
        .stderr(contains(
            "no axis of the machine has a high end switch there",
        ));
}
