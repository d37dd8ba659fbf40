//! The micro mill, operated by pages.

use super::page::{Page, Served};
use serde_json::{Value, json};
use std::time::Duration;

/// A step of the motors, mm.
const STEP_MM: f64 = 0.000_14;

fn served(options: &[&str]) -> Served {
    Served::new(&[&["-m", "micromill"], options].concat())
}

/// A page in control of a mill that is homed.
fn homed(served: &Served) -> Page {
    let mut page = served.in_control();
    page.done(json!({"do": "home"}));
    page.until_state("Idle");
    page
}

fn mill(page: &Page) -> &Value {
    &page.states[0]["mill"]
}

/// The net steps of the motors.
fn motors(page: &Page) -> [i64; 3] {
    let steps = mill(page)["motor_steps"].as_array().unwrap();
    [0, 1, 2].map(|axis: usize| steps[axis].as_i64().unwrap())
}

/// Receives until the mill stands, and a little longer.
fn stands(page: &mut Page) -> [i64; 3] {
    // A state is published at most every 33 ms.
    page.pass(Duration::from_millis(150));
    page.until_state("Idle");
    let first = motors(page);
    page.pass(Duration::from_millis(300));
    assert_eq!(motors(page), first, "it moves on");
    first
}

#[test]
fn a_page_learns_the_family_and_what_it_can_do() {
    let served = served(&["-m", "router", "--port", "sim", "--port", "sim"]);
    let token = &served.token;
    let list = served.get("/machines", &format!("Authorization: Bearer {token}\r\n"));
    let list: Value = serde_json::from_str(list.split_once("\r\n\r\n").unwrap().1).unwrap();
    assert_eq!(list[0]["family"], "micromill");
    assert_eq!(list[0]["offers"], json!(["program", "from", "report"]));
    assert_eq!(list[0]["travel_mm"], json!([[0.0, 10.0], [0.0, 7.0], null]));
    assert_eq!(list[1]["family"], "grbl");
    let page = served.page();
    assert_eq!(page.states[0]["family"], "micromill");
    assert_eq!(page.states[1]["family"], "grbl");
    assert_eq!(page.states[1].get("mill"), None);
}

#[test]
fn homing_finds_machine_zero() {
    let served = served(&["--speed", "20"]);
    let mut page = served.in_control();
    assert_eq!(mill(&page)["is_homed"], false);
    assert!(page.states[0]["machine_mm"].is_null() && page.states[0]["advice"].is_string());
    for request in [
        json!({"do": "line", "text": "G00X00100"}),
        json!({"do": "line", "text": "G1 X1 F1"}),
        json!({"do": "zero", "at_mm": {"x": 0, "y": 0, "z": 0}}),
        json!({"do": "goto", "to_mm": {"x": 0}}),
    ] {
        page.refused(request);
    }
    page.done(json!({"do": "home"}));
    page.until_state("Idle");
    assert_eq!(mill(&page)["is_homed"], true);
    assert_eq!(page.states[0]["machine_mm"], json!([0.0, 0.0, 0.0]));
    assert_eq!(mill(&page)["backlash_um"], json!([204, 178, 0]));
    assert_eq!(
        (&mill(&page)["sent"], &mill(&page)["echo"]),
        (&json!("H;"), &json!("H;"))
    );
    // Z is homed first, then X and Y, each drawn as a rapid.
    assert!(
        page.path.iter().any(|point| point[0] == 1),
        "{:?}",
        page.path
    );
}

#[test]
fn steps_of_each_size_are_made() {
    let served = served(&["--speed", "20"]);
    let mut page = served.in_control();
    let sizes = [1, 10, 14, 28, 50, 100, 1000];
    for size in sizes {
        page.done(json!({"do": "steps", "steps": {"x": size, "z": size}}));
    }
    let all: i64 = sizes.iter().sum();
    assert_eq!(stands(&mut page), [all, 0, all]);
    // More than the four digits of a string.
    page.done(json!({"do": "steps", "steps": {"y": 12_000}}));
    assert_eq!(stands(&mut page)[1], 12_000);
    page.done(json!({"do": "step", "move_mm": {"z": 0.1003}}));
    assert_eq!(stands(&mut page)[2], all + 716);
    for wrong in [
        json!({"x": 0.5}),
        json!({"x": 2e6}),
        json!({"a": 1}),
        json!({}),
    ] {
        page.refused(json!({"do": "steps", "steps": wrong}));
    }
}

#[test]
fn a_jog_moves_several_axes_until_it_is_released() {
    let served = served(&[]);
    let mut page = served.in_control();
    page.done(json!({"do": "jog", "jog": 1, "axes": {"x": 1, "y": 1, "z": 1}}));
    page.hold(1, Duration::from_millis(900));
    assert_eq!(page.states[0]["state"], "Jog");
    let hz = mill(&page)["step_hz"].as_i64().unwrap();
    assert!((120..=200).contains(&hz), "{hz} steps/s");
    assert_eq!(mill(&page)["jog_hz"], 170);
    let [x, ..] = motors(&page);
    page.done(json!({"do": "release", "jog": 1}));
    let [end_x, end_y, end_z] = stands(&mut page);
    assert!(
        end_x == end_y && end_z == end_x && end_x > 50,
        "{end_x} {end_y} {end_z}"
    );
    // The report is 0.1 s old at most, and the stop needs less than 0.3 s.
    assert!(
        end_x - x <= 170 * 5 / 10,
        "{} steps after the release",
        end_x - x
    );
    assert!(page.states[0]["jog"].is_null());
    assert!(page.path.iter().any(|point| point[0] == 0));
}

#[test]
fn a_jog_that_is_not_renewed_stops() {
    let served = served(&[]);
    let mut page = served.in_control();
    page.done(json!({"do": "jog", "jog": 7, "axes": {"y": 1}}));
    page.hold(7, Duration::from_millis(500));
    let from = motors(&page)[1];
    page.until("the end", |page| {
        page.has_line("jog 7 ends: the page did not renew it")
            .then_some(())
    });
    let way = stands(&mut page)[1] - from;
    assert!(way <= 170 * 65 / 100, "{way} steps after the last renewal");
    page.say(json!({"do": "renew", "jog": 7}));
    page.pass(Duration::from_millis(200));
    assert_eq!(page.states[0]["state"], "Idle");
}

#[test]
fn a_jog_stops_when_its_page_is_closed() {
    let served = served(&[]);
    let (mut page, mut watcher) = (served.in_control(), served.page());
    page.done(json!({"do": "jog", "jog": 1, "axes": {"x": 1}}));
    page.hold(1, Duration::from_millis(500));
    watcher.pass(Duration::from_millis(30));
    let from = motors(&watcher)[0];
    drop(page);
    let way = stands(&mut watcher)[0] - from;
    assert!(way <= 170 * 5 / 10, "{way} steps after the page was closed");
}

#[test]
fn a_jog_changes_direction_and_speed() {
    let served = served(&[]);
    let mut page = served.in_control();
    page.refused(json!({"do": "pace", "faster": true}));
    page.done(json!({"do": "jog", "jog": 1, "axes": {"x": 1}}));
    page.hold(1, Duration::from_millis(200));
    for _ in 0..3 {
        page.done(json!({"do": "pace", "faster": false}));
    }
    page.done(json!({"do": "pace", "faster": true}));
    page.hold(1, Duration::from_millis(600));
    assert_eq!(mill(&page)["jog_hz"], 150);
    page.done(json!({"do": "jog", "jog": 2, "axes": {"x": -1}}));
    page.hold(2, Duration::from_millis(400));
    let turned = motors(&page)[0];
    page.hold(2, Duration::from_millis(400));
    assert!(motors(&page)[0] < turned);
    page.done(json!({"do": "release", "jog": 2}));
    stands(&mut page);
    // At a speed of its own.
    page.done(json!({"do": "jog", "jog": 3, "axes": {"z": 1}, "hz": 40}));
    page.hold(3, Duration::from_millis(700));
    let hz = mill(&page)["step_hz"].as_i64().unwrap();
    assert!((30..=50).contains(&hz), "{hz} steps/s");
    page.done(json!({"do": "release", "jog": 3}));
    stands(&mut page);
    let jog = |axes: Value, hz: u16| json!({"do": "jog", "jog": 4, "axes": axes, "hz": hz});
    page.refused(jog(json!({"x": 1, "y": 1}), 40));
    page.refused(jog(json!({"x": 1}), 999));
    page.refused(json!({"do": "jog", "jog": 4, "axes": {"x": 0}}));
}

#[test]
fn every_page_can_stop_a_move_and_the_position_stays_valid() {
    let served = served(&[]);
    let (mut page, mut watcher) = (served.in_control(), served.page());
    page.say(json!({"do": "steps", "steps": {"x": 5000}}));
    page.until_state("Run");
    page.pass(Duration::from_millis(300));
    watcher.done(json!({"do": "stop"}));
    let [x, ..] = stands(&mut page);
    assert!((20..4000).contains(&x), "{x} steps");
    assert!(
        page.states[0]["why"].is_null(),
        "{:?}",
        page.states[0]["why"]
    );
    assert_eq!(page.states[0]["stopping"], false);
    page.done(json!({"do": "steps", "steps": {"x": -x}}));
    assert_eq!(stands(&mut page)[0], 0);
}

#[test]
fn lines_are_strings_of_the_mill_or_g_code() {
    let served = served(&["--speed", "20"]);
    let mut page = homed(&served);
    page.done(json!({"do": "line", "text": "g01x00100.00f08;"}));
    page.until_at("machine_mm", 0, 0.1);
    let echo = json!("G01X00100.00F08;");
    assert_eq!((&mill(&page)["sent"], &mill(&page)["echo"]), (&echo, &echo));
    page.until("the end", |page| {
        (mill(page)["outcome"] == "done").then_some(())
    });
    page.done(json!({"do": "line", "text": "G1 X0.2 Y0.1 F1"}));
    page.until_at("machine_mm", 1, 0.1);
    page.until_at("machine_mm", 0, 0.2);
    // A work zero, and a position from it.
    page.done(json!({"do": "zero", "at_mm": {"x": 0, "y": 0, "z": 0}}));
    page.until_at("work_mm", 0, 0.0);
    page.done(json!({"do": "goto", "to_mm": {"x": -0.1, "z": 0.05}}));
    page.until_at("machine_mm", 0, 0.1);
    page.until_at("work_mm", 2, 0.05);
    page.done(json!({"do": "line", "text": "M03S1000"}));
    page.until("the spindle", |page| {
        (page.states[0]["rpm"] == 1000.0).then_some(())
    });
    page.done(json!({"do": "backlash", "um": {"x": 200}}));
    page.until("the backlash", |page| {
        (mill(page)["backlash_um"][0] == 200).then_some(())
    });
    for text in [
        "JX+;",
        "FX+250",
        "L0000",
        "S1",
        "G1 X99 F1",
        "G2 X1",
        "nonsense",
        "",
    ] {
        page.refused(json!({"do": "line", "text": text}));
    }
    assert!((page.at("machine_mm", 0) - 0.1).abs() < 2.0 * STEP_MM);
    // The rows of homing were drawn from where the mill was switched on. Now they have a place.
    assert!(page.path.iter().any(|point| point[0] == 2));
}

const SQUARE: &str = "G21 G90\nG1 X0.1 F1.4\nG1 Y0.1\nG1 X0\nG1 Y0\nM30\n";

#[test]
fn a_program_runs_with_its_line_and_has_a_report() {
    let served = served(&["--speed", "10"]);
    let mut page = served.in_control();
    let (status, report) = served.load(page.client, "square.nc", SQUARE);
    assert_eq!((status, &report["errors"]), (200, &json!(0)), "{report}");
    assert!(report["time_s"].as_f64().unwrap() > 10.0);
    let why = page.refused(json!({"do": "run", "confirmed": true}));
    assert!(why.contains("home"), "{why}");
    page.done(json!({"do": "home"}));
    page.until_state("Idle");
    let plan = page.done(json!({"do": "run"}));
    assert_eq!(
        (&plan["name"], &plan["lines"]),
        (&json!("square.nc"), &json!(5))
    );
    page.done(json!({"do": "run", "confirmed": true}));
    let mut seen = Vec::new();
    page.until("its end", |page| {
        let program = &page.states[0]["program"];
        // Before it starts there is no line.
        let line = program["line"].as_u64()?;
        if seen.last() != Some(&line) {
            seen.push(line);
        }
        assert_ne!(program["phase"], "failed", "{program}");
        (program["phase"] == "done").then_some(())
    });
    assert!(
        [2, 3, 4, 5].iter().all(|line| seen.contains(line)),
        "{seen:?}"
    );
    page.until_at("machine_mm", 0, 0.0);
    page.until_at("machine_mm", 1, 0.0);
    assert_eq!(page.states[0]["program"]["progress"], 1.0);
    assert!(page.has_line("G01X00100.00"));
    let token = &served.token;
    let report = served.get(
        "/machines/1/report",
        &format!("Authorization: Bearer {token}\r\n"),
    );
    assert!(
        report.contains("5 of 5"),
        "{}",
        &report[..report.len().min(600)]
    );
}

#[test]
fn a_program_waits_stops_and_goes_on_in_the_middle_of_a_line() {
    let served = served(&["--speed", "2"]);
    let mut page = homed(&served);
    let text = "G21 G90\nG1 X0.1 F1.4\nM6 T2\nG1 Y0.1\nG1 X0\nM30\n";
    assert_eq!(served.load(page.client, "part.nc", text).0, 200);
    page.done(json!({"do": "breakpoints", "lines": [5]}));
    page.done(json!({"do": "run", "confirmed": true}));
    let waits = |page: &mut Page, line: u64| {
        page.until("a wait", |page| {
            let program = &page.states[0]["program"];
            (program["phase"] == "waiting" && program["waits_before"] == line).then_some(())
        });
    };
    waits(&mut page, 3);
    let message = page.states[0]["program"]["message"]
        .as_str()
        .unwrap()
        .to_owned();
    assert!(message.contains("tool 2"), "{message}");
    page.done(json!({"do": "resume"}));
    page.until("line 4", |page| {
        (page.at("machine_mm", 1) > 0.02).then_some(())
    });
    page.done(json!({"do": "stop"}));
    page.until("the stop", |page| {
        (page.states[0]["program"]["phase"] == "stopped").then_some(())
    });
    let stopped = page.at("machine_mm", 1);
    assert!(stopped < 0.1);
    assert_eq!(page.states[0]["program"]["resume_line"], 4);
    page.done(json!({"do": "breakpoints", "lines": [5]}));
    page.done(json!({"do": "run", "from": 4}));
    page.done(json!({"do": "run", "from": 4, "confirmed": true}));
    waits(&mut page, 5);
    page.until_at("machine_mm", 1, 0.1);
    page.done(json!({"do": "resume"}));
    page.until("its end", |page| {
        (page.states[0]["program"]["phase"] == "done").then_some(())
    });
    page.until_at("machine_mm", 0, 0.0);
}

#[test]
fn what_the_mill_does_not_have_is_refused() {
    let served = served(&[]);
    let mut page = served.in_control();
    for request in [
        json!({"do": "unlock"}),
        json!({"do": "settings"}),
        json!({"do": "home", "axis": "x"}),
        json!({"do": "override", "what": "feed", "percent": 50}),
        json!({"do": "zero", "at_mm": {"x": 0}}),
        json!({"do": "backlash", "um": {"x": 1000}}),
        json!({"do": "resume"}),
    ] {
        page.refused(request);
    }
    let (status, report) = served.load(page.client, "wrong.nc", "G1 X1\n");
    assert_eq!(status, 200);
    assert!(report["errors"].as_u64().unwrap() > 0, "{report}");
    page.refused(json!({"do": "run"}));
}
