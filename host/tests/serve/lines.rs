//! Moves and lines by hand, the work zero, overrides.

use super::page::Served;
use serde_json::json;
use std::time::Duration;

#[test]
fn lines_move_the_machine_and_appear_in_the_console() {
    let served = Served::new(&["--speed", "20"]);
    let mut page = served.operator();
    page.done(json!({"do": "line", "text": "G1 X5 Y-2 F1200"}));
    page.until_at("work_mm", 0, 5.0);
    page.until_at("work_mm", 1, -2.0);
    page.until("the modes", |page| {
        let modal = page.states[0]["modal"].as_array()?;
        modal.contains(&json!("G1")).then_some(())
    });
    assert_eq!(page.states[0]["programmed"]["feed"], 1200.0);
    let why = page.refused(json!({"do": "line", "text": "G1 X5 Q7"}));
    assert!(why.starts_with("error 20"), "{why}");
    page.until("both lines", |page| {
        (page.has_line("G1 X5 Y-2 F1200") && page.has_line("error:20")).then_some(())
    });
    page.done(json!({"do": "line", "text": "$#"}));
    page.until("parameters", |page| page.has_line("[G54:").then_some(()));
    for text in ["", "G1\nX5", "G1 X5 ! Y2", "\u{85}", &"X".repeat(256)] {
        page.refused(json!({"do": "line", "text": text}));
    }
}

#[test]
fn steps_and_positions() {
    let served = Served::new(&["--speed", "20"]);
    let mut page = served.operator();
    page.done(json!({"do": "step", "move_mm": {"x": 0.5, "z": -1}, "feed": 600}));
    page.until_at("work_mm", 2, -1.0);
    page.until_state("Idle");
    page.done(json!({"do": "goto", "to_mm": {"x": 3}, "feed": 600}));
    page.until_at("work_mm", 0, 3.0);
    page.until_state("Idle");
    page.done(json!({"do": "zero", "at_mm": {"x": 0, "y": 12.5}}));
    page.until_at("work_mm", 0, 0.0);
    page.until_at("work_mm", 1, 12.5);
    page.done(json!({"do": "goto", "to_mm": {"x": 1}, "frame": "machine", "feed": 600}));
    page.until_at("machine_mm", 0, 1.0);
    page.until_at("work_mm", 0, -2.0);
    assert_eq!(page.states[0]["zero_mm"][0], 3.0);
    // A restored work zero does not move the machine.
    page.until_state("Idle");
    assert_eq!(page.states[0]["undo"], 1);
    page.done(json!({"do": "undo_zero"}));
    page.until_at("work_mm", 0, 1.0);
    page.until_at("work_mm", 1, 0.0);
    page.until("no more", |page| {
        (page.states[0]["undo"] == 0).then_some(())
    });
    page.refused(json!({"do": "undo_zero"}));
}

#[test]
fn homing_gives_the_machine_its_position() {
    let served = Served::new(&["--speed", "20"]);
    let mut page = served.operator();
    page.done(json!({"do": "home"}));
    page.until_state("Idle");
    page.until_at("machine_mm", 0, -1.0);
    page.until_at("machine_mm", 2, -1.0);
}

#[test]
fn a_move_is_held_and_goes_on_at_another_speed() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    page.done(json!({"do": "line", "text": "G1 X20 F600"}));
    page.until_state("Run");
    page.done(json!({"do": "hold"}));
    page.until("a hold", |page| {
        (page.states[0]["detail"] == 0).then_some(())
    });
    let held = page.at("work_mm", 0);
    assert!(held < 20.0);
    assert!(
        page.refused(json!({"do": "line", "text": "G0 X0"}))
            .contains("held")
    );
    page.pass(Duration::from_millis(300));
    assert_eq!(page.at("work_mm", 0), held);
    page.done(json!({"do": "override", "what": "feed", "percent": 187}));
    page.done(json!({"do": "override", "what": "rapid", "percent": 50}));
    page.refused(json!({"do": "override", "what": "rapid", "percent": 60}));
    page.refused(json!({"do": "override", "what": "feed", "percent": 9}));
    page.until("overrides", |page| {
        let set = &page.states[0]["override"];
        (set["feed"] == 187 && set["rapid"] == 50).then_some(())
    });
    page.done(json!({"do": "resume"}));
    page.until_at("work_mm", 0, 20.0);
    page.until_state("Idle");
}
