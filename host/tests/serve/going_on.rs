//! A program from one of its lines on.

use super::page::{Page, Served};
use serde_json::{Value, json};

const PART: &str = "G21 G90\nG0 Z2\nG0 X5 Y5\nM3 S800\nG1 Z-1 F900\nM8\nX10\n(a note)\nY9\nX5\n";

/// Receives until the program is in this phase, and the machine stands.
fn ends(page: &mut Page, phase: &str) {
    page.until_phase(phase);
    page.until_state("Idle");
}

/// The answer to the first step of a start. The modes are reported a little after a stop.
fn shown(page: &mut Page, from: usize) -> Value {
    page.until("modes", |page| {
        let request = json!({"do": "run", "from": from});
        match page.ask(request) {
            Err(why) if why.contains("try again") => None,
            answer => Some(answer.unwrap()),
        }
    })
}

#[test]
fn the_state_is_shown_and_then_restored() {
    let served = Served::new(&["--speed", "10"]);
    let mut page = served.operator();
    served.load(page.client, "part.nc", PART);
    let plan = shown(&mut page, 8);
    assert_eq!((&plan["from"], &plan["lines"]), (&json!(9), &json!(2)));
    assert_eq!(plan["state"]["work_mm"], json!([10.0, 5.0, -1.0]));
    assert_eq!(
        plan["state"]["programmed"],
        json!({"feed": 900.0, "rpm": 800.0})
    );
    let modal = plan["state"]["modal"].to_string();
    assert!(
        modal.contains("\"M3\",\"M8\"") && modal.contains("G54"),
        "{modal}"
    );
    let before = plan["before"].as_array().unwrap().clone();
    assert_eq!(before[1], "G0 Z2");
    // Nothing has moved.
    assert_eq!((page.at("work_mm", 0), page.at("work_mm", 2)), (0.0, 0.0));
    assert!(!page.has_line("G0 Z2"));
    let mut lines = page.lines.len();
    page.done(json!({"do": "run", "from": 8, "confirmed": true}));
    ends(&mut page, "done");
    page.until_at("work_mm", 0, 5.0);
    page.until_at("work_mm", 1, 9.0);
    page.until_at("work_mm", 2, -1.0);
    assert_eq!(page.states[0]["accessories"]["spindle"], "cw");
    assert_eq!(page.states[0]["accessories"]["flood"], true);
    // What was shown was sent first, and then the lines from there on.
    let mut expected: Vec<_> = before.iter().map(|line| line.as_str().unwrap()).collect();
    expected.extend(["Y9", "X5", "G4P0"]);
    for line in expected {
        let sent = page
            .lines
            .iter()
            .skip(lines)
            .position(|one| one["from"] == "host" && one["text"] == line);
        lines += sent.unwrap_or_else(|| panic!("{line}: {:?}", page.lines));
    }
    let message = page.states[0]["program"]["message"].to_string();
    assert!(message.contains("2 lines made"), "{message}");
}

#[test]
fn only_what_was_shown_is_started() {
    let served = Served::new(&["--speed", "10"]);
    let mut page = served.operator();
    let start = json!({"do": "run", "from": 5, "confirmed": true});
    page.refused(start.clone());
    served.load(page.client, "part.nc", PART);
    let why = page.refused(start.clone());
    assert!(why.contains("look at it again"), "{why}");
    shown(&mut page, 6);
    page.refused(start.clone());
    // The machine has moved.
    shown(&mut page, 5);
    page.done(json!({"do": "step", "move_mm": {"z": 3}, "feed": 600}));
    page.until_at("work_mm", 2, 3.0);
    page.until_state("Idle");
    page.refused(start.clone());
    assert_eq!(shown(&mut page, 5)["before"][1], "G0 Z3");
    // A watching page neither asks nor starts.
    let mut watcher = served.page();
    assert!(watcher.refused(start.clone()).contains("control"));
    assert!(
        watcher
            .refused(json!({"do": "run", "from": 5}))
            .contains("control")
    );
    for (from, why) in [(11, "no command"), (1000, "no command")] {
        let refused = page.refused(json!({"do": "run", "from": from}));
        assert!(refused.contains(why), "{refused}");
    }
    page.refused(json!({"do": "run", "from": -1}));
}

/// A run that was stopped goes on where it was, and makes the same part.
#[test]
fn a_stopped_run_goes_on() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    let lines = (1..=60).map(|number| format!("G1 X{number} F1500\n"));
    let text: String = lines.collect();
    served.load(page.client, "long.nc", &text);
    assert!(page.states[0]["program"]["resume_line"].is_null());
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("motion", |page| (page.at("work_mm", 0) > 5.0).then_some(()));
    page.done(json!({"do": "stop"}));
    ends(&mut page, "stopped");
    let from = page.states[0]["program"]["resume_line"].as_u64().unwrap();
    let stands = page.at("work_mm", 0);
    // Line N ends at N mm: all before it are made.
    assert!(
        from > 1 && stands >= from as f64 - 1.0,
        "{from} at {stands}"
    );
    let plan = shown(&mut page, from as usize);
    assert_eq!(plan["state"]["work_mm"][0], from as f64 - 1.0);
    page.done(json!({"do": "run", "from": from, "confirmed": true}));
    page.until("running", |page| {
        (page.states[0]["program"]["phase"] == "running").then_some(())
    });
    assert!(page.states[0]["program"]["resume_line"].is_null());
    ends(&mut page, "done");
    page.until_at("work_mm", 0, 60.0);
}

/// The work zero is not the machine zero: the approach is in work coordinates.
#[test]
fn it_goes_on_from_another_work_zero() {
    let served = Served::new(&["--speed", "10"]);
    let mut page = served.operator();
    page.done(json!({"do": "goto", "to_mm": {"x": -40, "y": -30, "z": -5}, "feed": 3000}));
    page.until_at("machine_mm", 0, -40.0);
    page.until_state("Idle");
    page.done(json!({"do": "zero", "at_mm": {"x": 0, "y": 0, "z": 0}}));
    page.until_at("work_mm", 0, 0.0);
    served.load(page.client, "part.nc", PART);
    let plan = shown(&mut page, 9);
    assert_eq!(plan["state"]["work_mm"], json!([10.0, 5.0, -1.0]));
    assert_eq!(
        (&plan["before"][1], &plan["before"][2]),
        (&json!("G0 Z2"), &json!("G0 X10 Y5"))
    );
    page.done(json!({"do": "run", "from": 9, "confirmed": true}));
    ends(&mut page, "done");
    page.until_at("work_mm", 1, 9.0);
    page.until_at("machine_mm", 0, -35.0);
    page.until_at("machine_mm", 2, -6.0);
    // A shift of the work zero in the program cannot be restored.
    served.load(page.client, "shifted.nc", "G92 X3\nG0 X1\nX2\n");
    let why = page.refused(json!({"do": "run", "from": 3}));
    assert!(why.contains("work zero"), "{why}");
}

/// Lines without motion are answered at once, so they do not wait among the moves of the
/// controller.
#[test]
fn lines_without_motion_do_not_count_as_moves() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    let lines = (1..=60).map(|number| format!("G1 X{number} F1500\nF1500\n"));
    let text: String = lines.collect();
    served.load(page.client, "feeds.nc", &text);
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("motion", |page| {
        (page.at("work_mm", 0) > 20.0).then_some(())
    });
    page.done(json!({"do": "stop"}));
    page.until_phase("stopped");
    page.until_state("Idle");
    let from = page.states[0]["program"]["resume_line"].as_u64().unwrap();
    let stands = page.at("work_mm", 0);
    // Line 2 N - 1 ends at N mm: all before it are made, and most of them are not made again.
    let made = from.div_ceil(2) as f64 - 1.0;
    assert!(stands >= made && made > 1.0, "line {from}, {stands} mm");
}
