//! One page is in control, the others watch and may stop.

use super::emulated::Emulated;
use super::page::Served;
use serde_json::json;
use std::process::Command;
use std::time::Duration;

#[test]
fn one_page_is_in_control() {
    let served = Served::new(&[]);
    let (mut one, mut other) = (served.page(), served.page());
    assert_eq!(one.refused(json!({"do": "unlock"})), "take control first");
    one.done(json!({"do": "take"}));
    other.refused(json!({"do": "take"}));
    let client = one.client;
    other.until("the operator", |page| {
        (page.states[0]["operator"] == client).then_some(())
    });
    assert_eq!(other.states[0]["clients"], 2);
    other.done(json!({"do": "take", "force": true}));
    one.refused(json!({"do": "unlock"}));
    other.done(json!({"do": "give"}));
    one.done(json!({"do": "take"}));
    drop(one);
    // Its socket is closed, so it is in control no more.
    other.until("nobody", |page| {
        page.states[0]["operator"].is_null().then_some(())
    });
    other.done(json!({"do": "take"}));
}

#[test]
fn a_server_that_watches_lets_nobody_take_control_and_stops() {
    let served = Served::new(&["--watch-only"]);
    let mut page = served.page();
    assert!(
        page.refused(json!({"do": "take", "force": true}))
            .contains("--watch-only")
    );
    page.refused(json!({"do": "unlock"}));
    page.done(json!({"do": "stop"}));
    page.until("the stop", |page| {
        page.has_line("the machine has stopped").then_some(())
    });
}

#[test]
fn a_watcher_stops_a_move() {
    let served = Served::new(&[]);
    let (mut operator, mut watcher) = (served.operator(), served.page());
    operator.done(json!({"do": "step", "move_mm": {"x": 100}, "feed": 600}));
    watcher.until_state("Jog");
    watcher.done(json!({"do": "stop"}));
    operator.until("the stop", |page| {
        page.has_line("the machine has stopped").then_some(())
    });
    operator.until_state("Idle");
    let stands = operator.at("machine_mm", 0);
    assert!(stands > 0.0 && stands < 90.0, "{stands}");
    operator.pass(Duration::from_millis(300));
    assert_eq!(operator.at("machine_mm", 0), stands);
    // It goes on from there.
    operator.done(json!({"do": "step", "move_mm": {"x": -1}, "feed": 600}));
    operator.until_at("machine_mm", 0, stands - 1.0);
}

#[test]
fn a_stop_ends_lines_and_homing() {
    let served = Served::new(&[]);
    let (mut operator, mut watcher) = (served.operator(), served.page());
    operator.say(json!({"do": "home", "id": 900}));
    watcher.until_state("Home");
    // Without a machine it is for all.
    watcher
        .socket
        .send(r#"{"do": "stop", "id": 901}"#.into())
        .unwrap();
    watcher.until("the stop", |page| {
        page.has_line("the machine has stopped").then_some(())
    });
    watcher.until("a stand", |page| {
        (page.states[0]["state"] != "Home").then_some(())
    });
    assert_eq!(watcher.states[0]["link"], "up");
}

#[test]
fn machines_stand_side_by_side() {
    let served = Served::new(&["--port", "sim", "--port", "sim"]);
    let mut page = served.page();
    for machine in [1, 2] {
        page.done(json!({"do": "take", "machine": machine}));
        page.done(json!({"do": "unlock", "machine": machine}));
    }
    page.until("unlocked", |page| {
        (page.states[1]["state"] == "Idle").then_some(())
    });
    page.done(json!({"do": "step", "machine": 2, "move_mm": {"y": -1}, "feed": 1200}));
    page.until("machine 2", |page| {
        (page.states[1]["work_mm"][1] == -1.0).then_some(())
    });
    assert_eq!(page.at("work_mm", 1), 0.0);
    assert!(
        page.refused(json!({"do": "unlock", "machine": 3}))
            .contains("machine")
    );
}

/// Ctrl-C stops the machine before the program ends.
#[cfg(unix)]
#[test]
fn the_end_of_the_program_stops_the_machine() {
    let mut served = Served::new(&[]);
    let mut page = served.operator();
    page.done(json!({"do": "step", "move_mm": {"x": 100}, "feed": 600}));
    page.until_state("Jog");
    let kill = std::process::Command::new("kill")
        .args(["-INT", &served.process.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    page.until("the stop", |page| {
        let has_stopped = page.has_line("the machine has stopped");
        (has_stopped || !page.receive()).then_some(())
    });
    assert_eq!(served.process.wait().unwrap().code(), Some(130));
}

/// Grbl reports that it is idle during a dwell, and has lines that it will make.
#[test]
fn the_end_of_the_server_stops_a_program_in_a_dwell() {
    let device = Emulated::listening("grbl", &[]);
    let served = Served::new(&["--port", device.port()]);
    let mut page = served.operator();
    let text = "G21 G91\nG1 X1 F600\nG4 P3\nG1 X50 F600\n";
    served.load(page.client, "dwell.nc", text);
    page.done(json!({"do": "run", "confirmed": true}));
    page.until_at("work_mm", 0, 1.0);
    page.until("the dwell", |page| {
        let state = &page.states[0];
        (state["state"] == "Idle" && state["program"]["phase"] == "running").then_some(())
    });
    let id = served.process.id().to_string();
    let sent = Command::new("kill").args(["-INT", &id]).status();
    assert!(sent.unwrap().success());
    while page.receive() {}
    drop((page, served));
    let served = Served::new(&["--port", device.port()]);
    let mut page = served.page();
    page.pass(Duration::from_secs(4));
    assert_eq!(page.at("machine_mm", 0), 1.0);
}

/// A zero is set with the modes that the lines before it have set.
#[test]
fn a_zero_waits_for_the_modes() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    page.done(json!({"do": "line", "text": "G20"}));
    page.done(json!({"do": "zero", "at_mm": {"x": 10}}));
    page.until_at("work_mm", 0, 10.0);
}
