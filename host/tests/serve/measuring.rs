//! A measuring machine, operated by pages.

use super::emulated::Emulated;
use super::page::{Page, Served};
use super::relay::Relay;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

fn served(options: &[&str]) -> Served {
    Served::new(&[&["-m", "cmm3"], options].concat())
}

fn measuring(page: &Page) -> &Value {
    &page.states[0]["measuring"]
}

/// A value of an axis: `work`, `counts`, `error`, ...
fn axis(page: &Page, axis: usize, what: &str) -> f64 {
    measuring(page)["axes"][axis][what].as_f64().unwrap()
}

/// Receives until the machine stands, and checks that it does. Returns the positions.
fn stands(page: &mut Page) -> [f64; 3] {
    page.pass(Duration::from_millis(150));
    page.until_state("Idle");
    page.pass(Duration::from_millis(250));
    let first = [0, 1, 2].map(|one| axis(page, one, "work"));
    page.pass(Duration::from_millis(500));
    for (one, before) in first.iter().enumerate() {
        let moved = (axis(page, one, "work") - before).abs();
        assert!(moved <= 0.005, "axis {one} moves on by {moved} mm");
    }
    first
}

#[test]
fn a_page_learns_the_machine() {
    let served = served(&["-m", "cmm", "--port", "sim", "--port", "sim"]);
    let token = &served.token;
    let list = served.get("/machines", &format!("Authorization: Bearer {token}\r\n"));
    let list: Value = serde_json::from_str(list.split_once("\r\n\r\n").unwrap().1).unwrap();
    assert_eq!(list[0]["family"], "measuring");
    assert_eq!(list[0]["offers"], json!(["routine", "report"]));
    assert_eq!(list[0]["axes"], json!(["X", "Y", "Z"]));
    assert_eq!(list[1]["axes"], json!(["X"]));
    let page = served.page();
    assert_eq!(measuring(&page)["unit"], "mm");
    assert_eq!(page.states[0]["state"], "Idle");
    assert!(page.states[0]["advice"].as_str().unwrap().contains("homed"));
    // The length of a count is not known.
    assert_eq!(page.states[1]["measuring"]["unit"], "counts");
    assert!(page.states[1]["work_mm"].is_null());
    assert_eq!(
        page.states[1]["measuring"]["axes"][0]["machine"],
        Value::Null
    );
}

#[test]
fn it_homes_moves_zeroes_and_is_cancelled() {
    let served = served(&["--speed", "10"]);
    let mut page = served.in_control();
    page.done(json!({"do": "home"}));
    page.until_state("Idle");
    assert!(page.states[0]["advice"].is_null(), "{:?}", page.states[0]);
    page.done(json!({"do": "goto", "to_mm": {"x": 3, "y": -2}}));
    let [x, y, _] = stands(&mut page);
    assert!(
        (x - 3.0).abs() < 0.005 && (y + 2.0).abs() < 0.005,
        "{x} {y}"
    );
    assert!(axis(&page, 0, "error").abs() < 0.005);
    assert!((axis(&page, 0, "machine") - 3.0).abs() < 0.005);
    page.done(json!({"do": "zero", "at_mm": {"x": 0}}));
    let [x, y, _] = stands(&mut page);
    assert!(x.abs() < 0.005 && (y + 2.0).abs() < 0.005, "{x} {y}");
    assert!((axis(&page, 0, "machine") - 3.0).abs() < 0.005);
    page.done(json!({"do": "goto", "to_mm": {"x": 1}, "frame": "machine"}));
    assert!((stands(&mut page)[0] + 2.0).abs() < 0.005);
    page.done(json!({"do": "step", "move_mm": {"z": -0.5}}));
    assert!((stands(&mut page)[2] + 0.5).abs() < 0.005);
    for wrong in [
        json!({"do": "goto", "to_mm": {"x": 500}}),
        json!({"do": "goto", "to_mm": {"a": 1}}),
        json!({"do": "zero", "at_mm": {"x": 1}}),
        json!({"do": "home", "axis": "A"}),
        json!({"do": "touch", "towards": {}}),
        json!({"do": "touch", "towards": {"x": 1, "y": 1}, "reference": 4}),
        json!({"do": "unlock"}),
    ] {
        page.refused(wrong);
    }
    // A cancelled move is answered with a refusal, and the position stays valid.
    page.say(json!({"do": "goto", "id": 900, "to_mm": {"x": 150}, "rapid": true}));
    page.until("motion", |page| (axis(page, 0, "work") > 0.5).then_some(()));
    assert!(axis(&page, 0, "error") > 30.0, "the distance that is left");
    page.done(json!({"do": "cancel"}));
    let [x, ..] = stands(&mut page);
    assert!(x < 140.0, "{x}");
    assert!(page.has_line("stopped") && page.states[0]["advice"].is_null());
    // The target is given up: a move of another axis does not go on to it.
    assert!(axis(&page, 0, "error").abs() < 0.005);
    page.done(json!({"do": "goto", "to_mm": {"z": -1}}));
    assert!((stands(&mut page)[0] - x).abs() < 0.005);
    page.say(json!({"do": "goto", "id": 901, "to_mm": {"x": 150}, "rapid": true}));
    page.until("motion", |page| {
        (axis(page, 0, "work") > x + 0.5).then_some(())
    });
    page.done(json!({"do": "cancel"}));
    let [x, ..] = stands(&mut page);
    page.done(json!({"do": "step", "move_mm": {"x": 1}}));
    assert!((stands(&mut page)[0] - x - 1.0).abs() < 0.01);
    page.done(json!({"do": "goto", "to_mm": {"x": 0}}));
}

#[test]
fn positions_come_often_while_it_moves() {
    let served = served(&[]);
    let mut page = served.in_control();
    page.say(json!({"do": "goto", "to_mm": {"x": 20}}));
    page.until("motion", |page| {
        (axis(page, 0, "work") > 0.05).then_some(())
    });
    let (begun, mut seen) = (Instant::now(), vec![0.0]);
    while begun.elapsed() < Duration::from_secs(2) {
        assert!(page.receive());
        let now = axis(&page, 0, "work");
        if seen.last() != Some(&now) {
            seen.push(now);
        }
    }
    // Four in a second are promised.
    assert!(seen.len() > 8, "{} positions in 2 s", seen.len());
    assert!(seen.windows(2).all(|pair| pair[1] > pair[0] - 0.01));
    let line = measuring(&page)["line"].as_array().unwrap();
    assert!(
        line[0]["sent"].as_str().unwrap().starts_with("aa "),
        "{line:?}"
    );
    assert!(page.path.iter().any(|point| point[0] == 1));
}

#[test]
fn a_joystick_has_two_speeds_and_moves_several_axes() {
    let served = served(&[]);
    let mut page = served.in_control();
    page.done(json!({"do": "home", "axis": "X"}));
    page.until_state("Idle");
    let (from, begun) = (axis(&page, 0, "work"), Instant::now());
    page.done(json!({"do": "jog", "jog": 1, "axes": {"x": 1, "y": -0.3}}));
    page.hold(1, Duration::from_millis(1500));
    assert_eq!(page.states[0]["state"], "Jog");
    assert_eq!(page.states[0]["jog"]["jog"], 1);
    let way = axis(&page, 0, "work") - from;
    let speed = way / begun.elapsed().as_secs_f64();
    // The other axis alone, without letting go.
    page.done(json!({"do": "jog", "jog": 1, "axes": {"y": -0.3}}));
    page.hold(1, Duration::from_millis(300));
    page.done(json!({"do": "release", "jog": 1}));
    let [_, y, _] = stands(&mut page);
    // 2.4 mm/s, with a ramp, and 0.4 mm/s.
    assert!((0.8..2.5).contains(&speed), "{speed} mm/s");
    assert!(y < -0.2 && y > -way, "{y} mm and {way} mm");
    assert!(page.states[0]["jog"].is_null());
}

#[test]
fn a_jog_stops_when_it_is_not_renewed_and_when_its_page_is_closed() {
    let served = served(&[]);
    let mut page = served.in_control();
    page.done(json!({"do": "jog", "jog": 7, "axes": {"y": 1}}));
    page.hold(7, Duration::from_millis(500));
    page.until("the end", |page| {
        page.has_line("jog 7: the page did not renew it")
            .then_some(())
    });
    stands(&mut page);
    let mut watcher = served.page();
    page.done(json!({"do": "jog", "jog": 8, "axes": {"y": 1}}));
    page.hold(8, Duration::from_millis(500));
    watcher.pass(Duration::from_millis(30));
    let from = axis(&watcher, 1, "work");
    drop(page);
    let way = stands(&mut watcher)[1] - from;
    // Not homed: 0.4 mm/s, for less than 0.5 s.
    assert!(way < 0.3, "{way} mm after the page was closed");
}

#[test]
fn anybody_stops_it() {
    let served = served(&[]);
    let (mut page, mut watcher) = (served.in_control(), served.page());
    page.say(json!({"do": "goto", "to_mm": {"x": 50}}));
    watcher.until_state("Run");
    watcher.until("motion", |page| {
        (axis(page, 0, "work") > 0.05).then_some(())
    });
    watcher.done(json!({"do": "stop"}));
    let from = axis(&watcher, 0, "work");
    let way = stands(&mut watcher)[0] - from;
    assert!(way < 0.3, "{way} mm after STOP");
    // A move ends with its page, too.
    page.say(json!({"do": "goto", "to_mm": {"x": 50}}));
    watcher.until_state("Run");
    watcher.pass(Duration::from_millis(300));
    drop(page);
    let from = axis(&watcher, 0, "work");
    let way = stands(&mut watcher)[0] - from;
    assert!(way < 0.3, "{way} mm after the page was closed");
    watcher.refused(json!({"do": "goto", "to_mm": {"x": 0}}));
}

#[test]
fn a_touch_has_trigger_contact_and_pre_travel() {
    let served = Served::new(&["-m", "cmm", "--speed", "10"]);
    let mut page = served.in_control();
    page.done(json!({"do": "tip", "pre_travel": [18, 18]}));
    page.until("the tip", |page| {
        (measuring(page)["tip"]["pre_travel"] == json!([18.0, 18.0])).then_some(())
    });
    page.done(json!({"do": "goto", "to_mm": {"x": 2000}}));
    page.done(json!({"do": "touch", "towards": {"x": 1}, "touches": 3}));
    page.pass(Duration::from_millis(300));
    let touch = measuring(&page)["touch"].clone();
    assert_eq!(touch["trigger"], json!([3018.0]));
    assert_eq!(touch["contact"], json!([3000.0]));
    assert_eq!(
        (&touch["pre_travel"], &touch["touches"]),
        (&json!(18.0), &json!(3))
    );
    assert!(page.has_line("trigger X 3018 counts; contact X 3000 counts"));
    // The face at a known position tells the pre-travel.
    page.done(json!({"do": "touch", "towards": {"x": 1}, "reference": 3010}));
    page.pass(Duration::from_millis(200));
    let tip = &measuring(&page)["tip"];
    assert_eq!(tip["pre_travel"], json!([8.0, 18.0]));
    assert_eq!(measuring(&page)["touch"]["contact"], json!([3010.0]));
    page.done(json!({"do": "goto", "to_mm": {"x": 2000}}));
    // Nothing is in the way.
    let why = page.refused(json!({"do": "touch", "towards": {"x": -1}, "within": 50}));
    assert!(!why.is_empty());
    page.refused(json!({"do": "routine_run", "name": "a.routine", "text": "goto x1"}));
}

const ROUTINE: &str = "\
safe z -10
clearance 1
search 2
plane top towards -z at x14 y14 z-20 at x20 y14 z-20 at x14 y20 z-20 at x20 y20 z-20 form 0.01
point left towards +x at x10 y30 z-25 x 10 +-0.02
point wrong towards +y at x30 y10 z-25 y 11 +-0.02
";

#[test]
fn a_routine_is_checked_sketched_and_run() {
    let served = served(&["--speed", "40"]);
    let mut page = served.in_control();
    let wrong = "bore B at x1 y1 z1\n";
    let checked = page.done(json!({"do": "routine", "name": "a.routine", "text": wrong}));
    assert_eq!(checked["findings"][0]["code"], "E1003");
    assert_eq!(checked["findings"][0]["line"], 1);
    page.refused(json!({"do": "routine_run", "name": "a.routine", "text": wrong}));
    let checked = page.done(json!({"do": "routine", "name": "a.routine", "text": ROUTINE}));
    assert_eq!(checked["findings"], json!([]));
    assert_eq!(checked["sketch"][0]["touches"].as_array().unwrap().len(), 4);
    assert_eq!(
        checked["sketch"][1]["touches"][0]["at"],
        json!([10.0, 30.0, -25.0])
    );
    page.done(json!({"do": "tip", "pre_travel": [0.008, 0.008], "ball": 1}));
    page.done(json!({"do": "home"}));
    let run = json!({"do": "routine_run", "name": "a.routine", "text": ROUTINE, "part": "7"});
    page.done(run);
    page.until("a line", |page| {
        (measuring(page)["routine"]["line"] == 5).then_some(())
    });
    page.refused(json!({"do": "goto", "to_mm": {"x": 0}}));
    page.until("the end", |page| {
        let routine = &measuring(page)["routine"];
        (routine["phase"] == "done" && page.states[0]["state"] == "Idle").then_some(())
    });
    let routine = measuring(&page)["routine"].clone();
    assert_eq!(
        (&routine["is_good"], &routine["features"]),
        (&json!(false), &json!(3))
    );
    let summary = routine["summary"].as_str().unwrap();
    assert!(summary.contains("1 of 3 tolerances not kept"), "{summary}");
    let measured = page.done(json!({"do": "measured"}));
    assert_eq!(measured["text"], ROUTINE);
    let x = measured["features"][1]["dimensions"][0]["actual"]
        .as_f64()
        .unwrap();
    assert!((x - 10.0).abs() < 0.01, "{x}");
    assert_eq!(measured["features"][1]["in_tolerance"], true);
    assert_eq!(measured["features"][2]["in_tolerance"], false);
    let token = &served.token;
    let report = served.get(
        "/machines/1/report",
        &format!("Authorization: Bearer {token}\r\n"),
    );
    assert!(report.starts_with("HTTP/1.1 200"), "{report}");
    assert!(report.contains("filename=\"a-") && report.contains("part 7"));
}

#[test]
fn a_routine_is_stopped_and_survives_its_page() {
    let served = served(&["--speed", "5"]);
    let mut page = served.in_control();
    let long = "goto x5\ngoto x0\n".repeat(200);
    page.done(json!({"do": "routine_run", "name": "long.routine", "text": long}));
    page.until("a line", |page| {
        (measuring(page)["routine"]["line"] == 2).then_some(())
    });
    drop(page);
    let mut watcher = served.page();
    watcher.pass(Duration::from_millis(500));
    assert_eq!(measuring(&watcher)["routine"]["phase"], "running");
    watcher.done(json!({"do": "stop"}));
    stands(&mut watcher);
    let routine = &measuring(&watcher)["routine"];
    assert_eq!(routine["phase"], "stopped");
    assert!(routine["message"].as_str().unwrap().contains("line "));
}

#[test]
fn a_collision_in_a_jog_stops_it() {
    let served = Served::new(&["-m", "cmm", "--speed", "10"]);
    let mut page = served.in_control();
    page.done(json!({"do": "goto", "to_mm": {"x": 2700}}));
    page.done(json!({"do": "jog", "jog": 1, "axes": {"x": 1}}));
    let begun = Instant::now();
    while !page.has_line("jog 1 ends: ") {
        assert!(
            begun.elapsed() < Duration::from_secs(20),
            "{:?}",
            page.lines
        );
        page.hold(1, Duration::from_millis(60));
    }
    page.until_state("Idle");
    page.pass(Duration::from_millis(200));
    assert!(page.has_line("collision"), "{:?}", page.lines);
    assert_eq!(measuring(&page)["is_pressed"], true);
    let at = axis(&page, 0, "counts");
    assert!((2900.0..3400.0).contains(&at), "{at}");
    page.done(json!({"do": "goto", "to_mm": {"x": 2000}}));
    page.pass(Duration::from_millis(200));
    assert_eq!(measuring(&page)["is_pressed"], false);
}

/// The modules know no lease: each next position comes from this program, so they stop with it.
#[test]
fn a_killed_server_moves_nothing_on() {
    let device = Emulated::listening("cmm3", &[]);
    let folder = std::env::temp_dir().join(format!("husillo-measuring-{}", std::process::id()));
    let state = [("XDG_STATE_HOME", folder.to_str().unwrap())];
    let options = ["-m", "cmm3", "--port", device.port()];
    let mut served = Served::with(&options, &state);
    let mut page = served.in_control();
    page.done(json!({"do": "jog", "jog": 1, "axes": {"x": 1}}));
    page.hold(1, Duration::from_millis(800));
    let before = axis(&page, 0, "work");
    served.process.kill().unwrap();
    served.process.wait().unwrap();
    std::thread::sleep(Duration::from_secs(2));
    // The next session finds the axis where it stood; it keeps its counts.
    let again = Served::with(&options, &state);
    let mut page = again.page();
    page.until("the console", |page| {
        page.has_line("zero and home are kept").then_some(())
    });
    let way = axis(&page, 0, "work") - before;
    assert!(
        (-0.01..0.3).contains(&way),
        "{way} mm after the end of the server"
    );
    let _ = std::fs::remove_dir_all(folder);
}

/// The point of the path that was drawn last, mm.
fn drawn(page: &Page) -> [f64; 3] {
    let last = page.path.last().unwrap();
    [1, 2, 3].map(|at: usize| last[at].as_f64().unwrap() / 1e6)
}

/// Over the block of `examples/piece.toml`, homed, with the tip that it is touched with.
fn over_the_block(served: &Served) -> Page {
    let mut page = served.in_control();
    page.done(json!({"do": "tip", "pre_travel": [0.008, 0.008], "ball": 1}));
    page.done(json!({"do": "home"}));
    page.done(json!({"do": "goto", "to_mm": {"x": 14, "y": 14}, "rapid": true}));
    page
}

/// Runs a routine. Returns its state after the end.
fn run(page: &mut Page, name: &str, text: &str) -> Value {
    let runs = |page: &Page| measuring(page)["routine"]["runs"].as_u64().unwrap_or(0);
    let before = runs(page);
    page.done(json!({"do": "routine_run", "name": name, "text": text}));
    page.until("the end", |page| {
        (runs(page) > before && page.states[0]["state"] == "Idle").then_some(())
    });
    measuring(page)["routine"].clone()
}

#[test]
fn a_collision_spoils_what_is_measured_then_and_nothing_later() {
    let served = served(&["--speed", "40"]);
    let mut page = over_the_block(&served);
    let why = page.refused(json!({"do": "goto", "to_mm": {"z": -25}}));
    assert!(why.contains("collision"), "{why}");
    page.done(json!({"do": "goto", "to_mm": {"z": -10}}));
    let point = "point left towards +x at x10 y30 z-25 x 10 +-0.02\n";
    let text = format!("safe z -10\nclearance 1\nsearch 2\n{point}");
    let good = run(&mut page, "a.routine", &text);
    assert_eq!(
        (&good["phase"], &good["is_good"]),
        (&json!("done"), &json!(true))
    );
    // What has failed, and that nothing counts, are both said.
    let into = format!("{text}goto z-10\ngoto x14 y14\ngoto z-25\n");
    let spoiled = run(&mut page, "a.routine", &into);
    assert_eq!(
        (&spoiled["phase"], &spoiled["is_good"]),
        (&json!("failed"), &json!(false))
    );
    let message = spoiled["message"].as_str().unwrap();
    assert!(message.contains("no result counts"), "{message}");
    assert!(message.contains("line 7: "), "{message}");
    page.done(json!({"do": "goto", "to_mm": {"z": -10}}));
    assert_eq!(run(&mut page, "a.routine", &text)["is_good"], true);
}

#[test]
fn a_stop_ends_what_was_asked_for_before_it() {
    let served = served(&[]);
    let mut page = served.in_control();
    let mut from = 0.0;
    for _ in 0..4 {
        let waits = page.begin(json!({"do": "goto", "to_mm": {"x": 50}}));
        page.done(json!({"do": "stop"}));
        page.answer(waits).unwrap_err();
        let [x, ..] = stands(&mut page);
        assert!((x - from).abs() < 0.3, "{from} {x}");
        from = x;
    }
    page.done(json!({"do": "goto", "to_mm": {"x": from + 0.2}}));
}

#[test]
fn a_jog_back_begins_when_the_axes_have_braked() {
    let served = served(&[]);
    let mut page = served.in_control();
    page.done(json!({"do": "home", "axis": "X"}));
    page.until_state("Idle");
    let mut jog = 0;
    for part in [1.0, -1.0, 1.0] {
        jog += 1;
        let begun = page.begin(json!({"do": "jog", "jog": jog, "axes": {"x": part}}));
        page.until("the jog", |page| {
            page.say(json!({"do": "renew", "jog": jog}));
            (page.states[0]["jog"]["jog"] == jog).then_some(())
        });
        page.answer(begun).unwrap();
        let from = axis(&page, 0, "work");
        page.hold(jog, Duration::from_millis(800));
        let way = (axis(&page, 0, "work") - from) * part;
        assert!(way > 0.2, "jog {jog}: {way} mm");
        page.done(json!({"do": "release", "jog": jog}));
    }
    // Let go again before the axes have braked: nothing begins.
    let begun = page.begin(json!({"do": "jog", "jog": 9, "axes": {"x": -1}}));
    page.done(json!({"do": "release", "jog": 9}));
    page.answer(begun).unwrap();
    stands(&mut page);
    // A stop ends the jog that waits, too.
    page.done(json!({"do": "jog", "jog": 10, "axes": {"x": 1}}));
    page.hold(10, Duration::from_millis(400));
    page.done(json!({"do": "release", "jog": 10}));
    let waits = page.begin(json!({"do": "jog", "jog": 11, "axes": {"x": -1}}));
    page.done(json!({"do": "stop"}));
    page.answer(waits).unwrap_err();
    stands(&mut page);
}

#[test]
fn the_zero_of_an_axis_that_is_not_homed_counts_from_where_it_was_switched_on() {
    let served = served(&["--speed", "10"]);
    let mut page = served.in_control();
    page.done(json!({"do": "goto", "to_mm": {"x": 3}}));
    stands(&mut page);
    assert!((drawn(&page)[0] - 3.0).abs() < 0.06, "{:?}", drawn(&page));
    page.done(json!({"do": "zero", "at_mm": {"x": 0}}));
    assert!(stands(&mut page)[0].abs() < 0.005);
    assert!((page.at("zero_mm", 0) - 3.0).abs() < 0.005);
    page.done(json!({"do": "goto", "to_mm": {"x": 1}}));
    stands(&mut page);
    assert!((drawn(&page)[0] - 4.0).abs() < 0.06, "{:?}", drawn(&page));
}

#[test]
fn a_program_tells_its_line_and_waits() {
    let served = served(&["--speed", "4"]);
    let mut page = served.in_control();
    let text = "G21 G90 G94 F60\nG1 X1\nM0\nG1 X3\nM2\n";
    page.done(json!({"do": "routine_run", "name": "part.nc", "text": text}));
    for (line, phase) in [(2, "running"), (3, "waiting"), (4, "running")] {
        page.until(&format!("line {line}"), |page| {
            let routine = &measuring(page)["routine"];
            (routine["line"] == line && routine["phase"] == phase).then_some(())
        });
        if phase == "waiting" {
            assert_eq!(measuring(&page)["routine"]["waits_at"], 3);
            page.done(json!({"do": "resume"}));
        }
    }
    page.until("the end", |page| {
        (measuring(page)["routine"]["phase"] == "done").then_some(())
    });
}

/// The cable is pulled, and then the modules lose their supply.
#[test]
fn a_lost_link_loses_nothing_and_a_reset_is_told() {
    let device = Emulated::listening("cmm3", &[]);
    let address = device.port().trim_start_matches("tcp:").to_owned();
    let relay = Relay::to(device.port());
    let folder = std::env::temp_dir().join(format!("husillo-link-{}", std::process::id()));
    let state = [("XDG_STATE_HOME", folder.to_str().unwrap())];
    let served = Served::with(&["-m", "cmm3", "--port", &relay.port], &state);
    let mut page = served.in_control();
    page.done(json!({"do": "tip", "pre_travel": [0.007, 0.009], "ball": 1.5}));
    page.done(json!({"do": "home", "axis": "X"}));
    page.until_state("Idle");
    let tip = measuring(&page)["tip"].clone();
    assert_eq!(tip["ball"], 1.5);
    page.done(json!({"do": "jog", "jog": 1, "axes": {"x": 1}}));
    page.hold(1, Duration::from_millis(800));
    let before = axis(&page, 0, "machine");
    relay.pull();
    let link = |page: &mut Page, is: &str| {
        page.until(is, |page| (page.states[0]["link"] == is).then_some(()));
    };
    link(&mut page, "lost");
    relay.plug();
    link(&mut page, "up");
    page.until("the note", |page| {
        page.has_line("zero and home are kept").then_some(())
    });
    let now = axis(&page, 0, "machine");
    assert!((-0.01..1.0).contains(&(now - before)), "{before} {now}");
    assert_eq!(measuring(&page)["tip"], tip);
    drop(device);
    link(&mut page, "lost");
    let again = Emulated::listening_at(&address, "cmm3", &[]);
    link(&mut page, "up");
    page.until("the note", |page| {
        page.has_line("the modules were reset or moved, so zero and home are lost")
            .then_some(())
    });
    assert!(measuring(&page)["axes"][0]["machine"].is_null());
    assert_eq!(measuring(&page)["tip"], tip);
    drop(again);
    let _ = std::fs::remove_dir_all(folder);
}
