//! The circuit-board drill, operated by pages.

use super::emulated::Emulated;
use super::page::{Page, Served};
use super::relay::Relay;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

fn served(options: &[&str]) -> Served {
    Served::new(&[&["-m", "drill"], options].concat())
}

/// A page in control of a drill in the manual mode, which is at zero.
fn manual(served: &Served) -> Page {
    let mut page = served.in_control();
    page.done(json!({"do": "manual", "on": true}));
    page.until("the manual mode", |page| {
        (drill(page)["is_manual"] == true && page.states[0]["state"] == "Idle").then_some(())
    });
    page
}

fn drill(page: &Page) -> &Value {
    &page.states[0]["drill"]
}

fn steps(page: &Page) -> [i64; 2] {
    let steps = drill(page)["steps"].as_array().unwrap();
    [0, 1].map(|axis: usize| steps[axis].as_i64().unwrap())
}

/// Receives until the drill stands, and a little longer.
fn stands(page: &mut Page) -> [i64; 2] {
    page.pass(Duration::from_millis(200));
    page.until_state("Idle");
    let first = steps(page);
    page.pass(Duration::from_millis(400));
    assert_eq!(steps(page), first, "it moves on");
    first
}

/// Holes of a board that is placed for more than a second.
const HOLES: u64 = 300_000;
const BOARD: &str = "M48\nMETRIC,TZ\nT1C0.8\nT2C1.0\n%\nT1\nX10.0Y10.0\nX12.0Y10.0\nT2\n\
                     X10.0Y12.0\nM30\n";

#[test]
fn a_page_learns_what_a_drill_is_and_finds_it_at_rest() {
    let served = served(&["--speed", "20"]);
    let page = served.page();
    let state = &page.states[0];
    assert_eq!(
        (&state["family"], &state["state"]),
        (&json!("drill"), &json!("Idle"))
    );
    assert_eq!(
        drill(&page)["is_homed"],
        true,
        "it homes when it is switched on"
    );
    assert_eq!(drill(&page)["z"], "up");
    assert_eq!(drill(&page)["lights"], json!(["ready"]));
    let token = format!("Authorization: Bearer {}\r\n", served.token);
    let list = served.get("/machines", &token);
    let list: Value = serde_json::from_str(list.split_once("\r\n\r\n").unwrap().1).unwrap();
    assert_eq!(
        list[0]["travel_mm"],
        json!([[0.0, 220.0], [0.0, 45.0], null])
    );
}

#[test]
fn the_link_is_watched_at_rest() {
    let served = served(&["--speed", "4"]);
    let mut page = served.in_control();
    page.until("heartbeats", |page| {
        (drill(page)["heartbeats"].as_u64()? >= 2).then_some(())
    });
    let tested = page.done(json!({"do": "link_test"}));
    assert!(
        (8..100).contains(&tested["ms"].as_u64().unwrap()),
        "{tested}"
    );
}

#[test]
fn keys_are_for_the_manual_mode_which_homes() {
    let served = served(&["--speed", "20"]);
    let mut page = served.in_control();
    let why = page.refused(json!({"do": "steps", "steps": {"x": 10}}));
    assert!(why.contains("manual mode"), "{why}");
    page.refused(json!({"do": "jog", "jog": 1, "axes": {"x": 1}}));
    page.refused(json!({"do": "teach"}));
    page.done(json!({"do": "manual", "on": true}));
    assert_eq!(stands(&mut page), [0, 0]);
    page.done(json!({"do": "steps", "steps": {"x": 130, "y": 7}}));
    assert_eq!(stands(&mut page), [130, 7]);
    page.done(json!({"do": "step", "move_mm": {"x": 1.0}}));
    assert_eq!(stands(&mut page), [237, 7]);
    page.done(json!({"do": "goto", "to_mm": {"x": 2.0, "y": 1.0}}));
    assert_eq!(stands(&mut page), [214, 107]);
    assert!((page.at("machine_mm", 0) - 2.0).abs() < 0.001);
    // A bit that may be in the board is not moved across it.
    page.done(json!({"do": "steps", "steps": {"z": -100}}));
    let why = page.refused(json!({"do": "goto", "to_mm": {"x": 3.0, "y": 1.0}}));
    assert!(why.contains("raise the bit"), "{why}");
    page.done(json!({"do": "steps", "steps": {"z": 100}}));
    assert_eq!(stands(&mut page), [214, 107]);
    // Beyond the switch.
    let why = page.refused(json!({"do": "steps", "steps": {"y": -200}}));
    assert!(why.contains("at its end"), "{why}");
    assert_eq!(stands(&mut page), [214, 0]);
    page.done(json!({"do": "steps", "steps": {"z": -20}}));
    page.until("Z", |page| (drill(page)["z"] == "between").then_some(()));
    page.done(json!({"do": "steps", "steps": {"z": 20}}));
    page.done(json!({"do": "home"}));
    assert_eq!(stands(&mut page), [0, 0]);
    assert_eq!(drill(&page)["is_manual"], true);
    for wrong in [
        json!({"do": "steps", "steps": {"x": 0.5}}),
        json!({"do": "goto", "to_mm": {"z": 1}}),
        json!({"do": "home", "axis": "x"}),
        json!({"do": "zero", "at_mm": {"x": 1, "y": 0}}),
        json!({"do": "zero", "at_mm": {"x": 0}}),
        json!({"do": "line", "text": "X1"}),
        json!({"do": "settings"}),
    ] {
        page.refused(wrong);
    }
    page.done(json!({"do": "manual", "on": false}));
    page.until("its end", |page| {
        (drill(page)["is_manual"] == false).then_some(())
    });
}

#[test]
fn a_jog_moves_while_it_is_held_and_stops_when_it_is_released() {
    let served = served(&[]);
    let mut page = manual(&served);
    page.done(json!({"do": "jog", "jog": 1, "axes": {"x": 1, "y": 1}}));
    page.hold(1, Duration::from_millis(1000));
    assert_eq!(page.states[0]["state"], "Jog");
    let [x, y] = steps(&page);
    assert!(x > 50 && y > 50, "both axes take turns: {x} {y}");
    page.done(json!({"do": "release", "jog": 1}));
    let end = stands(&mut page);
    // At most a second at 247 steps/s, on a busy computer. Without the release it goes on.
    let way = end[0] - x + end[1] - y;
    assert!(way <= 247, "{way} steps after the release");
    assert!(page.path.iter().any(|point| point[0] == 0));
}

#[test]
fn a_jog_that_is_not_renewed_stops() {
    let served = served(&[]);
    let mut page = manual(&served);
    page.done(json!({"do": "jog", "jog": 7, "axes": {"x": 1}}));
    page.hold(7, Duration::from_millis(600));
    let [from, _] = steps(&page);
    page.until("the end", |page| {
        page.has_line("jog 7 ends: the page did not renew it")
            .then_some(())
    });
    let way = stands(&mut page)[0] - from;
    assert!(way <= 247, "{way} steps after the last renewal");
}

#[test]
fn a_jog_and_the_spindle_stop_when_their_page_is_closed() {
    let served = served(&[]);
    let (mut page, mut watcher) = (manual(&served), served.page());
    page.done(json!({"do": "spindle", "on": true}));
    page.done(json!({"do": "jog", "jog": 1, "axes": {"x": 1}}));
    page.hold(1, Duration::from_millis(600));
    watcher.pass(Duration::from_millis(30));
    assert_eq!(drill(&watcher)["spindle"], true);
    let [from, _] = steps(&watcher);
    drop(page);
    watcher.until("the spindle", |page| {
        (drill(page)["spindle"] == false).then_some(())
    });
    let way = stands(&mut watcher)[0] - from;
    assert!(way <= 247, "{way} steps after the page was closed");
}

#[test]
fn holes_are_taught_and_become_a_program() {
    let served = served(&["--speed", "20"]);
    let mut page = manual(&served);
    page.refused(json!({"do": "taught"}));
    page.done(json!({"do": "steps", "steps": {"x": 300}}));
    page.done(json!({"do": "teach"}));
    page.done(json!({"do": "steps", "steps": {"y": 107}}));
    page.done(json!({"do": "teach"}));
    page.until("two holes", |page| {
        (drill(page)["taught_mm"].as_array()?.len() == 2).then_some(())
    });
    let report = page.done(json!({"do": "taught"}));
    assert_eq!(
        (&report["name"], &report["errors"]),
        (&json!("taught.txt"), &json!(0))
    );
    let token = format!("Authorization: Bearer {}\r\n", served.token);
    let text = served.get("/machines/1/program", &token);
    assert!(text.contains("X2.804") || text.contains("X2.80"), "{text}");
    let plan = page.done(json!({"do": "run"}));
    assert_eq!(plan["lines"], 2);
    assert!(
        plan["warnings"][0]
            .as_str()
            .unwrap()
            .contains("2 taught holes"),
        "{plan}"
    );
    let records = served.get("/machines/1/records", &token);
    assert!(records.contains("T0.cod"), "{records}");
    // The present position becomes zero.
    page.done(json!({"do": "zero", "at_mm": {"x": 0, "y": 0}}));
    page.until_at("work_mm", 0, 0.0);
    page.until_at("zero_mm", 1, 1.0);
    assert_eq!(drill(&page)["taught_mm"], json!([]));
}

#[test]
fn a_board_is_drilled_with_its_tools_and_has_a_report() {
    // Lamps are lit long enough to be seen on a busy computer.
    let served = served(&["--speed", "10"]);
    let mut page = served.in_control();
    let (status, report) = served.load(page.client, "board.drl", BOARD);
    assert_eq!((status, &report["errors"]), (200, &json!(0)), "{report}");
    assert!(report["time_s"].as_f64().unwrap() > 90.0);
    let token = format!("Authorization: Bearer {}\r\n", served.token);
    let board = served.get("/machines/1/board", &token);
    let board: Value = serde_json::from_str(board.split_once("\r\n\r\n").unwrap().1).unwrap();
    assert_eq!(board["holes"][1]["file_mm"], json!([12.0, 10.0]));
    assert_eq!(board["tools"][1]["diameter_mm"], 1.0);
    let plan = page.done(json!({"do": "run"}));
    assert!(
        plan["warnings"][0]
            .as_str()
            .unwrap()
            .contains("T1 (0.8 mm)"),
        "{plan}"
    );
    page.done(json!({"do": "run", "confirmed": true}));
    let mut lamps = std::collections::BTreeSet::new();
    page.until("the tool", |page| {
        for lamp in drill(page)["lights"].as_array()? {
            lamps.insert(lamp.as_str()?.to_owned());
        }
        (page.states[0]["program"]["phase"] == "waiting").then_some(())
    });
    assert!(
        ["x", "y", "drill"].iter().all(|lamp| lamps.contains(*lamp)),
        "{lamps:?}"
    );
    let program = &page.states[0]["program"];
    assert_eq!(program["waits_before"], 3);
    assert!(
        program["message"].as_str().unwrap().contains("T2 (1 mm)"),
        "{program}"
    );
    // Every part ends at zero, with the spindle off.
    assert_eq!(
        (steps(&page), &drill(&page)["spindle"]),
        ([0, 0], &json!(false))
    );
    page.refused(json!({"do": "home"}));
    page.done(json!({"do": "resume"}));
    page.until_phase("done");
    assert_eq!(page.states[0]["program"]["progress"], 1.0);
    assert!(page.has_line("drilled at 1070,1070") && page.has_line("drilled at 1070,1284"));
    let report = served.get("/machines/1/report", &token);
    assert!(report.contains("holes drilled") && report.contains("3 of 3"));
}

#[test]
fn stop_ends_a_drilling_and_the_program_goes_on_with_that_hole() {
    let served = served(&["--speed", "4"]);
    let (mut page, mut watcher) = (served.in_control(), served.page());
    assert_eq!(served.load(page.client, "board.drl", BOARD).0, 200);
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("the drill", |page| {
        let lights = drill(page)["lights"].as_array()?;
        (lights.contains(&json!("drill")) && page.states[0]["program"]["line"] == 1).then_some(())
    });
    page.pass(Duration::from_millis(800));
    watcher.done(json!({"do": "stop"}));
    page.until_phase("stopped");
    assert_eq!(stands(&mut page), [1070, 1070], "the position stays valid");
    assert_eq!(
        (&drill(&page)["z"], &drill(&page)["spindle"]),
        (&json!("up"), &json!(false))
    );
    assert_eq!(page.states[0]["program"]["resume_line"], 1);
    assert!(page.states[0]["why"].is_null());
    // The memory is left empty, for holes that are taught.
    assert_eq!(drill(&page)["records"], 0);
    page.refused(json!({"do": "run", "from": 4}));
    // STOP ends a move of X as well.
    page.done(json!({"do": "home"}));
    assert_eq!(stands(&mut page), [0, 0]);
    page.done(json!({"do": "run", "from": 1, "confirmed": true}));
    page.until("X", |page| {
        let lights = drill(page)["lights"].as_array()?;
        lights.contains(&json!("x")).then_some(())
    });
    page.pass(Duration::from_millis(200));
    page.done(json!({"do": "stop"}));
    page.until_phase("stopped");
    let [x, y] = stands(&mut page);
    assert!(0 < x && x < 1070 && y == 0, "{x} {y}");
}

#[test]
fn a_program_does_not_go_on_from_another_zero() {
    let served = served(&["--speed", "40"]);
    let mut page = served.in_control();
    assert_eq!(served.load(page.client, "board.drl", BOARD).0, 200);
    page.done(json!({"do": "breakpoints", "lines": [3]}));
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("hole 3", |page| {
        (page.states[0]["program"]["waits_before"] == 3).then_some(())
    });
    page.done(json!({"do": "stop"}));
    page.until_phase("stopped");
    page.done(json!({"do": "manual", "on": true}));
    page.until("the manual mode", |page| {
        (drill(page)["is_manual"] == true).then_some(())
    });
    page.done(json!({"do": "steps", "steps": {"x": 100, "y": 50}}));
    page.done(json!({"do": "zero", "at_mm": {"x": 0, "y": 0}}));
    let why = page.refused(json!({"do": "run", "from": 3}));
    assert!(why.contains("the zero has changed"), "{why}");
    // All holes from another zero are another board.
    page.done(json!({"do": "run"}));
}

#[test]
fn stop_ends_homing_and_the_drill_knows_that_it_is_lost() {
    let served = served(&["--speed", "2"]);
    let mut page = manual(&served);
    page.done(json!({"do": "steps", "steps": {"x": 500}}));
    page.say(json!({"do": "home"}));
    page.until_state("Home");
    page.pass(Duration::from_millis(300));
    page.done(json!({"do": "stop"}));
    page.until("the stop", |page| {
        (page.states[0]["stopping"] == false && page.states[0]["state"] == "Idle").then_some(())
    });
    page.pass(Duration::from_millis(200));
    assert_eq!(drill(&page)["is_homed"], false);
    assert!(page.states[0]["advice"].is_string());
    assert_eq!(served.load(page.client, "board.drl", BOARD).0, 200);
    let why = page.refused(json!({"do": "run"}));
    assert!(why.contains("home"), "{why}");
    page.done(json!({"do": "home"}));
    page.until("home", |page| {
        (drill(page)["is_homed"] == true).then_some(())
    });
}

#[test]
fn a_program_waits_between_holes() {
    let served = served(&["--speed", "40"]);
    let mut page = served.in_control();
    assert_eq!(served.load(page.client, "board.drl", BOARD).0, 200);
    page.done(json!({"do": "single_block", "on": true}));
    page.done(json!({"do": "run", "confirmed": true}));
    page.until_phase("waiting");
    assert_eq!(page.states[0]["program"]["waits_before"], 2);
    page.done(json!({"do": "single_block", "on": false}));
    page.done(json!({"do": "breakpoints", "lines": [3]}));
    page.done(json!({"do": "resume"}));
    page.until("hole 3", |page| {
        (page.states[0]["program"]["waits_before"] == 3).then_some(())
    });
    page.done(json!({"do": "stop"}));
    page.until_phase("stopped");
    assert_eq!(page.states[0]["program"]["resume_line"], 3);
}

#[test]
fn a_board_is_registered_on_measured_holes() {
    let served = served(&["--speed", "20"]);
    let mut page = served.in_control();
    page.refused(json!({"do": "place", "placing": {}}));
    assert_eq!(served.load(page.client, "board.drl", BOARD).0, 200);
    let reference =
        |file: [f64; 2], measured: [f64; 2]| json!({"file_mm": file, "measured_mm": measured});
    let one = reference([10.0, 10.0], [15.0, 10.0]);
    let why = page.refused(json!({"do": "place", "placing": {"references": [one]}}));
    assert!(why.contains("one reference"), "{why}");
    let two = [one, reference([12.0, 10.0], [15.0, 12.0])];
    let report = page.done(json!({"do": "place", "placing": {"references": two}}));
    assert_eq!(report["errors"], 0);
    let token = format!("Authorization: Bearer {}\r\n", served.token);
    let board = served.get("/machines/1/board", &token);
    let board: Value = serde_json::from_str(board.split_once("\r\n\r\n").unwrap().1).unwrap();
    assert!(
        (board["fit"]["turn_degrees"].as_f64().unwrap() - 90.0).abs() < 1e-6,
        "{board}"
    );
    let x = board["holes"][1]["at_mm"][0].as_f64().unwrap();
    assert!((x - 15.0).abs() < 0.006, "{board}");
    page.refused(json!({"do": "place", "placing": {"only": [9]}}));
    page.refused(json!({"do": "place", "placing": {"turn_degrees": 1e300}}));
    page.done(json!({"do": "place", "placing": {"only": [2], "shortest": true, "corner": true}}));
    page.until("one hole", |page| {
        (page.states[0]["program"]["lines"] == 1).then_some(())
    });
}

#[test]
fn errors_have_places_and_nothing_moves() {
    let served = served(&["--speed", "20"]);
    let mut page = served.in_control();
    let (status, report) = served.load(page.client, "part.txt", "%\nG21\nX10 Y5\nX300 Q1\n%\n");
    assert_eq!(status, 200);
    assert!(report["errors"].as_u64().unwrap() > 0, "{report}");
    assert_eq!(report["findings"][0]["line"], 4);
    let why = page.refused(json!({"do": "run", "confirmed": true}));
    assert!(why.contains("errors"), "{why}");
    let (_, report) = served.load(page.client, "far.drl", &BOARD.replace("Y12.0", "Y60.0"));
    assert_eq!(report["findings"][0]["code"], "E0401");
    page.refused(json!({"do": "place", "placing": {"tango": true, "turn_degrees": null}}));
}

#[test]
fn a_lost_answer_at_rest_ends_neither_a_waiting_program_nor_the_link() {
    let device = Emulated::listening("drill", &[]);
    let relay = Relay::to(device.port());
    let served = served(&["--port", &relay.port]);
    let mut page = served.in_control();
    let asked_again = |page: &mut Page, times: usize| {
        relay.lose(4);
        page.until("the second question", |page| {
            let lines = page.lines.iter().map(|line| line["text"].as_str().unwrap());
            (lines
                .filter(|text| text.starts_with("asked once more"))
                .count()
                == times)
                .then_some(())
        });
        page.pass(Duration::from_millis(1500));
        assert_eq!(page.states[0]["link"], "up", "{:?}", page.states[0]);
    };
    let near = "%\nG21\nG90\nX0.1 Y0.1\nX0.2\n%\n";
    assert_eq!(served.load(page.client, "near.txt", near).0, 200);
    page.done(json!({"do": "breakpoints", "lines": [2]}));
    page.done(json!({"do": "run", "confirmed": true}));
    page.until_phase("waiting");
    asked_again(&mut page, 1);
    assert_eq!(page.states[0]["program"]["phase"], "waiting");
    page.done(json!({"do": "stop"}));
    page.until_phase("stopped");
    // The manual mode ends, so that its keys are known to arrive.
    page.done(json!({"do": "manual", "on": true}));
    page.until("the manual mode", |page| {
        (drill(page)["is_manual"] == true && page.states[0]["state"] == "Idle").then_some(())
    });
    asked_again(&mut page, 2);
    assert_eq!(drill(&page)["is_manual"], false);
    let why = page.refused(json!({"do": "steps", "steps": {"x": 10}}));
    assert!(why.contains("manual mode"), "{why}");
    page.done(json!({"do": "link_test"}));
}

#[test]
fn stop_does_not_wait_for_a_board_that_is_placed() {
    let served = served(&["--speed", "20"]);
    let mut page = served.in_control();
    let hole = |at: u64| {
        let [x, y] = [at * 7919 % 21_400, at * 104_729 % 4400];
        format!("X{}.{:02}Y{}.{:02}\n", x / 100, x % 100, y / 100, y % 100)
    };
    let holes: String = (0..HOLES).map(hole).collect();
    let board = format!("M48\nMETRIC,TZ\nT1C0.8\n%\nT1\n{holes}M30\n");
    assert_eq!(served.load(page.client, "large.drl", &board).0, 200);
    let placing = page.begin(json!({"do": "place", "placing": {"shortest": true}}));
    let begun = Instant::now();
    // The driver answers while the board is placed.
    page.done(json!({"do": "single_block", "on": true}));
    let why = page.refused(json!({"do": "run"}));
    assert!(why.contains("being placed"), "{why}");
    page.done(json!({"do": "stop"}));
    let why = page.answer(placing).unwrap_err();
    assert_eq!(why, "stopped");
    println!("{HOLES} holes: STOP after {:?}", begun.elapsed());
    page.until("the stop", |page| {
        page.has_line("the machine has stopped").then_some(())
    });
    let shown = &page.states[0]["program"];
    assert_eq!(
        (&shown["load"], &shown["lines"]),
        (&json!(1), &json!(HOLES))
    );
}
