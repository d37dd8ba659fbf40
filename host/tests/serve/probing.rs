//! Moves that probe. The plate of the simulated machine is at Z -10 mm.

use super::page::{Page, Served};
use serde_json::{Value, json};
use std::time::Duration;

/// The modes that the controller has reported, when it stands.
fn modes(page: &mut Page) -> String {
    page.until_state("Idle");
    page.pass(Duration::from_millis(400));
    page.states[0]["modal"].to_string()
}

#[test]
fn the_contact_becomes_the_work_zero() {
    let served = Served::new(&["--speed", "5"]);
    let mut page = served.operator();
    page.done(json!({"do": "line", "text": "G20 G91 G1 F30"}));
    let before = modes(&mut page);
    assert!(before.contains("G20") && before.contains("G91"), "{before}");
    let answer = page.done(json!({
        "do": "probe", "axis": "z", "by_mm": -20, "feed": 300, "back_mm": 2, "set_mm": 1.5
    }));
    assert_eq!(answer["touched"], true);
    let contact = answer["at_mm"][2].as_f64().unwrap();
    assert!((contact + 10.0).abs() < 0.05, "{contact}");
    page.until("the work zero", |page| {
        (page.states[0]["undo"] == 1).then_some(())
    });
    let above = page.at("machine_mm", 2) - contact;
    assert!((1.8..2.1).contains(&above), "{above}");
    page.until_at("work_mm", 2, 1.5 + above);
    // Modes and feed are what they were: 30 inches are 762 mm.
    assert_eq!(modes(&mut page), before);
    let feed = page.states[0]["programmed"]["feed"].as_f64().unwrap();
    assert!((feed - 762.0).abs() < 0.1, "{feed}");
    page.done(json!({"do": "undo_zero"}));
    page.until_at("work_mm", 2, contact + above);
}

#[test]
fn without_a_contact_it_is_an_alarm_and_beside_it_is_not() {
    let served = Served::new(&["--speed", "5"]);
    let mut page = served.operator();
    let beside = json!({"do": "probe", "axis": "z", "by_mm": -3, "feed": 300, "beside": true});
    assert_eq!(page.done(beside)["touched"], false);
    page.until_at("machine_mm", 2, -3.0);
    let refused = page.refused(json!({
        "do": "probe", "axis": "z", "by_mm": -2, "feed": 300, "back_mm": 1, "set_mm": 0
    }));
    assert!(refused.contains("probing z"), "{refused}");
    page.until("an end", |page| {
        (page.states[0]["stopping"] == false).then_some(())
    });
    assert_eq!(page.states[0]["undo"], 0);
}

fn probe(axis: &str, by_mm: f64, feed: f64) -> Value {
    json!({"do": "probe", "axis": axis, "by_mm": by_mm, "feed": feed})
}

#[test]
fn what_has_no_sense_or_no_control_is_refused() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    for request in [
        probe("q", 1.0, 100.0),
        probe("z", 0.0, 100.0),
        probe("z", -1.0, 0.0),
    ] {
        page.refused(request);
    }
    let mut watcher = served.page();
    assert!(watcher.refused(probe("z", -1.0, 100.0)).contains("control"));
    // Not while something moves.
    page.done(json!({"do": "line", "text": "G1 X20 F600"}));
    page.until_state("Run");
    let why = page.refused(probe("z", -1.0, 100.0));
    assert!(why.contains("state Run"), "{why}");
    page.done(json!({"do": "stop"}));
    page.until_state("Idle");
}

/// Its page is closed: the axis stops, and the position stays valid.
#[test]
fn it_ends_with_its_page() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    let mut watcher = served.page();
    page.say(json!({"do": "probe", "id": 9, "axis": "z", "by_mm": -9, "feed": 60}));
    watcher.until("motion", |page| {
        (page.at("machine_mm", 2) < -0.3).then_some(())
    });
    drop(page);
    watcher.until_state("Idle");
    assert!(watcher.has_line("its operator has gone"));
    let stands = watcher.at("machine_mm", 2);
    assert!(stands > -8.0, "{stands}");
    watcher.pass(Duration::from_millis(400));
    assert_eq!(watcher.at("machine_mm", 2), stands);
}
