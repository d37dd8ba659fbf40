//! Programs: loaded, checked, run, held, stopped.

use super::page::{Page, Served};
use serde_json::{Value, json};
use std::time::Duration;

/// A square of 10 mm, and a pocket of many short moves.
fn part() -> String {
    let there = (1..=300).map(|number| format!("X{:.2}\n", 5.0 + f64::from(number) / 100.0));
    let short: String = there.collect();
    format!("%\n(part)\nG21 G90 G94\nG0 X0 Y0\nG1 X10 F3000\nY10\nX0\nY0\nG1 X5\n{short}M2\n%\n")
}

fn program(page: &Page) -> &Value {
    &page.states[0]["program"]
}

#[test]
fn a_program_runs_to_its_end() {
    let served = Served::new(&["--speed", "10"]);
    let mut page = served.operator();
    let text = part();
    let (status, report) = served.load(page.client, "part.nc", &text);
    assert_eq!((status, &report["errors"]), (200, &json!(0)), "{report}");
    let time_s = report["time_s"].as_f64().unwrap();
    assert!((0.9..3.0).contains(&time_s), "{time_s}");
    page.until_phase("loaded");
    assert_eq!(program(&page)["load"], 1);
    let path = "/machines/1/program";
    let bearer = format!("Authorization: Bearer {}\r\n", served.token);
    assert!(served.get(path, &bearer).ends_with(&text));
    let scene = served.get("/machines/1/scene", &bearer);
    // The first bytes of a zlib stream of the best compression, in base64.
    assert!(
        scene.split("\r\n\r\n").nth(1).unwrap().starts_with("eN"),
        "{scene}"
    );
    // The first step tells what would happen.
    let shown = page.done(json!({"do": "run"}));
    assert_eq!(
        (&shown["lines"], &shown["name"]),
        (&json!(308), &json!("part.nc"))
    );
    page.pass(Duration::from_millis(200));
    assert_eq!(page.states[0]["state"], "Idle");
    page.done(json!({"do": "run", "confirmed": true}));
    page.until_phase("done");
    // The same state tells that there is a report.
    assert_eq!(program(&page)["runs"], 1);
    page.until_state("Idle");
    page.until_at("work_mm", 0, 8.0);
    page.until_at("work_mm", 1, 0.0);
    assert_eq!(program(&page)["progress"], 1.0);
    assert_eq!(program(&page)["answered"], 308);
    assert!(
        program(&page)["message"]
            .as_str()
            .unwrap()
            .starts_with("308 lines made")
    );
    // Once more.
    page.done(json!({"do": "run", "confirmed": true}));
    page.until_phase("running");
    page.until_phase("done");
    page.done(json!({"do": "unload"}));
    page.until("none", |page| program(page).is_null().then_some(()));
    for path in [path, "/machines/1/scene"] {
        assert!(served.get(path, &bearer).starts_with("HTTP/1.1 404"));
    }
}

#[test]
fn a_program_with_errors_is_not_run() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    page.refused(json!({"do": "run", "confirmed": true}));
    let (status, report) = served.load(page.client, "bad.nc", "G21 G90\n\nG2 X1 Y1 F100\n");
    assert_eq!((status, &report["errors"]), (200, &json!(1)));
    let finding = &report["findings"][0];
    assert_eq!(
        (&finding["code"], &finding["line"]),
        (&json!("E0301"), &json!(3))
    );
    assert!(report["time_s"].is_null());
    let why = page.refused(json!({"do": "run", "confirmed": true}));
    assert!(why.contains("errors"), "{why}");
}

/// What was checked is what is run.
#[test]
fn a_program_is_checked_again_after_a_change() {
    let served = Served::new(&["--speed", "20"]);
    let mut page = served.operator();
    assert_eq!(
        served
            .load(page.client, "part.nc", "G21 G90\nG1 X1 F600\n")
            .0,
        200
    );
    page.done(json!({"do": "run"}));
    page.done(json!({"do": "zero", "at_mm": {"x": 5}}));
    page.until_at("work_mm", 0, 5.0);
    let why = page.refused(json!({"do": "run", "confirmed": true}));
    assert!(why.contains("load it again"), "{why}");
    assert_eq!(
        served
            .load(page.client, "part.nc", "G21 G90\nG1 X1 F600\n")
            .0,
        200
    );
    page.done(json!({"do": "run"}));
    page.done(json!({"do": "settings_save", "values": {"110": "5000"}}));
    page.refused(json!({"do": "run", "confirmed": true}));
}

#[test]
fn only_the_operator_loads_a_program() {
    let served = Served::new(&[]);
    let (page, watcher) = (served.operator(), served.page());
    for client in [watcher.client, 0, 99] {
        assert_eq!(served.load(client, "part.nc", "G0 X1\n").0, 403);
    }
    assert_eq!(served.load(page.client, "part.nc", "G0 X1\n").0, 200);
    assert_eq!(
        served.load(page.client, "part.nc", &"G0 X1 ".repeat(30)).0,
        400
    );
}

#[test]
fn a_program_is_held_and_stopped() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    let lines = (1..=100).map(|number| format!("G1 X{number} F1200\n"));
    let text: String = lines.collect();
    served.load(page.client, "long.nc", &text);
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("progress", |page| {
        (program(page)["answered"].as_u64()? > 16).then_some(())
    });
    page.done(json!({"do": "hold"}));
    page.until_phase("held");
    page.until("a stand", |page| {
        (page.states[0]["detail"] == 0).then_some(())
    });
    let held = page.at("work_mm", 0);
    page.pass(Duration::from_millis(300));
    assert_eq!(page.at("work_mm", 0), held);
    page.done(json!({"do": "resume"}));
    page.until_phase("running");
    page.until("motion", |page| {
        (page.at("work_mm", 0) > held + 0.5).then_some(())
    });
    let left = program(&page)["remaining_s"].as_f64().unwrap();
    // 20 mm/s.
    let expected = (100.0 - page.at("work_mm", 0)) / 20.0;
    assert!((left - expected).abs() < 1.0, "{left} s for {expected} s");
    // Nothing else comes between.
    assert!(
        page.refused(json!({"do": "line", "text": "G0 X0"}))
            .contains("runs")
    );
    assert!(
        page.refused(json!({"do": "step", "move_mm": {"x": 1}, "feed": 60}))
            .contains("runs")
    );
    assert_eq!(served.load(page.client, "other.nc", "G0 X1\n").0, 409);
    page.done(json!({"do": "stop"}));
    page.until_phase("stopped");
    page.until_state("Idle");
    let stands = page.at("work_mm", 0);
    let message = program(&page)["message"].as_str().unwrap();
    let next = message.rsplit(' ').nth(2).unwrap().parse::<f64>();
    let next = next.unwrap_or_else(|_| panic!("{message}"));
    // Line N ends at N mm: all before `next` are made.
    assert!(stands >= next - 1.0, "{message} at {stands}");
    page.pass(Duration::from_millis(300));
    assert_eq!(page.at("work_mm", 0), stands);
}

#[test]
fn breakpoints_and_single_blocks() {
    let served = Served::new(&["--speed", "10"]);
    let mut page = served.operator();
    served.load(page.client, "steps.nc", "G21 G90\nG1 X1 F600\nX2\nX3\nX4\n");
    page.done(json!({"do": "breakpoints", "lines": [4]}));
    page.done(json!({"do": "run", "confirmed": true}));
    page.until_phase("waiting");
    assert_eq!(program(&page)["waits_before"], 4);
    page.until_at("work_mm", 0, 2.0);
    page.done(json!({"do": "single_block", "on": true}));
    page.done(json!({"do": "resume"}));
    page.until("line 5", |page| {
        (program(page)["waits_before"] == 5).then_some(())
    });
    page.until_at("work_mm", 0, 3.0);
    page.done(json!({"do": "single_block", "on": false}));
    page.done(json!({"do": "resume"}));
    page.until_phase("done");
    page.until_at("work_mm", 0, 4.0);
}

/// The check knows the work zero and the soft limits of the controller.
#[test]
fn a_program_that_leaves_the_machine_is_refused() {
    let served = Served::new(&["--speed", "20"]);
    let mut page = served.operator();
    page.done(json!({"do": "home"}));
    page.until("homed", |page| {
        let is_idle = page.states[0]["state"] == "Idle";
        (is_idle && page.at("machine_mm", 0) < 0.0).then_some(())
    });
    page.done(json!({"do": "settings_save", "values": {"20": "1"}}));
    let (_, report) = served.load(page.client, "far.nc", "G21 G90\nG1 X-250 F600\nX-310\n");
    let finding = &report["findings"][0];
    assert_eq!(
        (&finding["code"], &finding["line"]),
        (&json!("E0401"), &json!(3)),
        "{report}"
    );
    page.until_state("Idle");
    page.done(json!({"do": "zero", "at_mm": {"x": -100}}));
    page.until_at("work_mm", 0, -100.0);
    let (_, report) = served.load(page.client, "far.nc", "G21 G90\nG1 X-250 F600\nX-310\n");
    assert_eq!(report["errors"], 0, "{report}");
}

/// A work zero counts from its answer on, not from the next report.
#[test]
fn a_program_is_checked_with_the_work_zero_just_set() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    for x in 1..12 {
        page.done(json!({"do": "zero", "at_mm": {"x": x}}));
        let (status, _) = served.load(page.client, "part.nc", "G21 G90\nG1 X1 F600\n");
        assert_eq!(status, 200);
        page.done(json!({"do": "run"}));
    }
}

/// The reason stays, although the dwell behind the line is answered.
#[test]
fn a_refused_line_in_single_block_is_a_failure() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    // In this mode, each line needs a feed.
    page.done(json!({"do": "line", "text": "G93"}));
    let text = "G21 G90\nG1 X1 F60\nG1 X3\nG1 X5\n";
    served.load(page.client, "part.nc", text);
    page.done(json!({"do": "single_block", "on": true}));
    page.done(json!({"do": "run", "confirmed": true}));
    for _ in 0..2 {
        page.until_phase("waiting");
        page.done(json!({"do": "resume"}));
        page.until("the line", |page| {
            (program(page)["phase"] != "waiting").then_some(())
        });
    }
    page.until("the end", |page| {
        page.has_line("the machine has stopped").then_some(())
    });
    page.until_state("Idle");
    assert_eq!(program(&page)["phase"], "failed");
    let message = program(&page)["message"].to_string();
    assert!(
        message.contains("line 3") && message.contains("error 22"),
        "{message}"
    );
}
