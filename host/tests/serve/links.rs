//! A controller that is lost and comes back.

use super::emulated::Emulated;
use super::page::Served;
use serde_json::json;

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
