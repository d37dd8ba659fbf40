//! A controller that is lost and comes back.

use super::emulated::Emulated;
use super::page::Served;
use super::slow_line::SlowLine;
use serde_json::json;
use std::time::{Duration, Instant};

#[test]
fn a_lost_controller_is_reported_and_found_again() {
    let device = Emulated::listening("grbl", &[]);
    let port = device.port().to_owned();
    let served = Served::new(&["--port", &port]);
    let mut page = served.in_control();
    page.done(json!({"do": "line", "text": "G1 X40 F300"}));
    page.until_state("Run");
    drop(device);
    page.until("the loss", |page| {
        (page.states[0]["link"] == "lost").then_some(())
    });
    assert!(page.states[0]["machine_mm"].is_null());
    assert!(page.states[0]["why"].is_string() && page.states[0]["advice"].is_string());
    assert!(page.refused(json!({"do": "unlock"})).contains("lost"));
    let (status, why) = served.load(page.client, "part.nc", "G1 X1 F300\n");
    assert_eq!(status, 400);
    assert!(
        why.as_str().unwrap().contains("the controller is lost"),
        "{why}"
    );
    // The operator has not changed.
    assert_eq!(page.states[0]["operator"], page.client);
    let again = Emulated::listening_at(port.trim_start_matches("tcp:"), "grbl", &[]);
    page.until("the link", |page| {
        (page.states[0]["link"] == "up").then_some(())
    });
    page.until_state("Idle");
    page.done(json!({"do": "step", "move_mm": {"x": 1}, "feed": 500}));
    page.until_at("machine_mm", 0, 1.0);
    drop(again);
}

#[test]
fn a_reset_of_the_controller_is_noticed() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    page.done(json!({"do": "reset"}));
    page.until("the start", |page| {
        let mut lines = page.lines.iter().rev();
        let start = lines.find(|line| line["text"].as_str().unwrap().starts_with("Grbl"))?;
        let reset = page
            .lines
            .iter()
            .find(|line| line["text"] == "0x18 (reset)")?;
        (start["number"].as_u64() > reset["number"].as_u64()).then_some(())
    });
    page.until_state("Idle");
    page.done(json!({"do": "step", "move_mm": {"x": 0.1}, "feed": 600}));
}

/// While it moves, a controller does not tell its settings.
#[test]
fn the_settings_are_known_after_a_connection_in_motion() {
    let device = Emulated::listening("grbl", &[]);
    let served = Served::new(&["--port", device.port()]);
    let mut page = served.operator();
    page.done(json!({"do": "line", "text": "G1 X8 F300"}));
    page.until_state("Run");
    drop((page, served));
    let served = Served::new(&["--port", device.port()]);
    let mut page = served.page();
    page.until_state("Run");
    page.done(json!({"do": "take"}));
    page.until_state("Idle");
    let asked = json!({"do": "settings_diff", "values": {"110": "1234"}});
    let diff = page.until("the settings", |page| {
        let diff = page.done(asked.clone());
        diff["refused"]
            .as_array()
            .unwrap()
            .is_empty()
            .then_some(diff)
    });
    assert_eq!(diff["changes"][0]["to"], "1234");
}

/// A controller that takes equal bytes of an override as one reaches the wanted one all the same.
#[test]
fn an_override_is_reached() {
    let device = Emulated::listening("grbl", &[]);
    let served = Served::new(&["--port", device.port()]);
    let mut page = served.operator();
    for percent in [150, 10, 137, 100] {
        page.done(json!({"do": "override", "what": "feed", "percent": percent}));
        page.until("the override", |page| {
            (page.states[0]["override"]["feed"] == percent).then_some(())
        });
    }
}

/// A slow line is not filled with requests for reports.
#[test]
fn one_report_is_awaited_at_a_time() {
    let device = Emulated::listening("grbl", &[]);
    let line = SlowLine::to(device.port(), Duration::from_millis(100));
    let served = Served::new(&["--port", &line.port]);
    let mut page = served.operator();
    page.done(json!({"do": "line", "text": "G1 X20 F600"}));
    page.until_state("Run");
    let (begun, before) = (Instant::now(), line.requests());
    page.pass(Duration::from_secs(1));
    let each_s = f64::from(line.requests() - before) / begun.elapsed().as_secs_f64();
    assert!(each_s < 12.0, "{each_s} requests a second");
}
