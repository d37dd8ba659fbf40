//! The desktop microfactory, operated by pages.

use super::emulated::Emulated;
use super::page::{Page, Served};
use super::relay::Relay;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

const ZIGZAG: &str = include_str!("../../../examples/microfactory/zigzag.fig");
const SQUARE: &str = include_str!("../../../examples/microfactory/square.nc");

fn served(options: &[&str]) -> Served {
    Served::new(&[&["-m", "microfactory"], options].concat())
}

/// A page in control of a microfactory that is homed.
fn homed(served: &Served) -> Page {
    let mut page = served.in_control();
    page.done(json!({"do": "home"}));
    page.until("home", |page| {
        (factory(page)["is_homed"] == true).then_some(())
    });
    page.until_state("Idle");
    page
}

fn factory(page: &Page) -> &Value {
    &page.states[0]["factory"]
}

fn steps(page: &Page) -> [i64; 4] {
    let steps = factory(page)["steps"].as_array().unwrap();
    [0, 1, 2, 3].map(|motor: usize| steps[motor].as_i64().unwrap())
}

/// Receives until nothing moves, and a little longer.
fn stands(page: &mut Page) -> [i64; 4] {
    page.pass(Duration::from_millis(200));
    page.until("rest", |page| {
        let state = page.states[0]["state"].as_str()?;
        ["Idle", "Alarm"].contains(&state).then_some(())
    });
    // At rest it is asked twice a second.
    page.pass(Duration::from_millis(700));
    let first = steps(page);
    page.pass(Duration::from_millis(700));
    assert_eq!(steps(page), first, "it moves on");
    first
}

fn token(served: &Served) -> String {
    format!("Authorization: Bearer {}\r\n", served.token)
}

#[test]
fn a_page_learns_what_a_microfactory_is() {
    let served = served(&["--speed", "20"]);
    let mut page = served.page();
    let state = &page.states[0];
    assert_eq!(
        (&state["family"], &state["state"]),
        (&json!("microfactory"), &json!("Idle"))
    );
    assert_eq!(factory(&page)["is_homed"], false);
    assert!(state["machine_mm"].is_null() && state["advice"].is_string());
    let list = served.get("/machines", &token(&served));
    let list: Value = serde_json::from_str(list.split_once("\r\n\r\n").unwrap().1).unwrap();
    assert_eq!(list[0]["offers"], json!(["program", "report"]));
    assert!(list[0]["travel_mm"].is_null());
    page.refused(json!({"do": "home"}));
    page.done(json!({"do": "take"}));
    for wrong in [
        json!({"do": "home", "axis": "x"}),
        json!({"do": "run"}),
        json!({"do": "hold"}),
        json!({"do": "line", "text": "G0 X1"}),
        json!({"do": "zero", "at_mm": {"x": 0}}),
        json!({"do": "goto", "to_mm": {"x": 0}}),
    ] {
        page.refused(wrong);
    }
    page.done(json!({"do": "home"}));
    assert_eq!(stands(&mut page), [0; 4]);
    assert_eq!(page.states[0]["machine_mm"], json!([0.0, 0.0, 0.0]));
    assert!(page.states[0]["advice"].is_null());
    assert_eq!(factory(&page)["report"], "homed");
}

#[test]
fn one_motor_turns_by_counted_steps() {
    let served = served(&["--speed", "20"]);
    let mut page = homed(&served);
    page.done(json!({"do": "steps", "steps": {"x": 255}}));
    page.done(json!({"do": "steps", "steps": {"x": -5}}));
    page.done(json!({"do": "steps", "steps": {"z": 40}}));
    page.done(json!({"do": "steps", "steps": {"c": -7}}));
    assert_eq!(stands(&mut page), [250, 0, 40, -7]);
    assert!((page.at("machine_mm", 0) - 0.4675).abs() < 1e-6);
    for wrong in [
        json!({"x": 256}),
        json!({"x": 0}),
        json!({"x": 0.5}),
        json!({"x": 1, "y": 1}),
        json!({"a": 1}),
        json!({}),
    ] {
        page.refused(json!({"do": "steps", "steps": wrong}));
    }
    assert_eq!(stands(&mut page), [250, 0, 40, -7]);
    // Towards the switch, which is 200 steps before home. The axis backs off it.
    let back = json!({"do": "steps", "steps": {"y": -250}});
    let why = page.refused(back);
    assert!(why.contains("home switch y"), "{why}");
}

#[test]
fn a_jog_turns_one_motor_while_it_is_held() {
    let served = served(&[]);
    let mut page = served.in_control();
    let why = page.refused(json!({"do": "jog", "jog": 1, "axes": {"x": 1, "y": 1}}));
    assert!(why.contains("one motor"), "{why}");
    page.done(json!({"do": "jog", "jog": 2, "axes": {"y": 1}}));
    page.hold(2, Duration::from_millis(900));
    assert_eq!(
        (&page.states[0]["state"], &factory(&page)["motion"]),
        (&json!("Jog"), &json!("y+"))
    );
    let [_, y, ..] = steps(&page);
    assert!(y > 100, "{y}");
    page.refused(json!({"do": "steps", "steps": {"x": 1}}));
    page.done(json!({"do": "release", "jog": 2}));
    let [_, end, ..] = stands(&mut page);
    // A third of a second at 400 steps/s, on a busy computer. Without the release it goes on.
    assert!(end - y <= 133, "{} steps after the release", end - y);
    assert!(page.path.iter().any(|point| point[0] == 0));
    // A jog that nobody renews.
    page.done(json!({"do": "jog", "jog": 3, "axes": {"c": -1}}));
    page.hold(3, Duration::from_millis(500));
    let [.., from] = steps(&page);
    page.until("the end", |page| {
        page.has_line("jog 3 ends: the page did not renew it")
            .then_some(())
    });
    let [.., to] = stands(&mut page);
    assert!(from < 0 && from - to <= 160, "{from} {to}");
    // The page is closed.
    let mut watcher = served.page();
    page.done(json!({"do": "jog", "jog": 4, "axes": {"y": 1}}));
    page.hold(4, Duration::from_millis(500));
    watcher.pass(Duration::from_millis(50));
    let [_, from, ..] = steps(&watcher);
    drop(page);
    let [_, to, ..] = stands(&mut watcher);
    assert!(
        to - from <= 200,
        "{} steps after the page was closed",
        to - from
    );
}

#[test]
fn a_switch_ends_a_jog_and_the_axis_backs_off() {
    let served = served(&["--speed", "2"]);
    let mut page = homed(&served);
    page.done(json!({"do": "jog", "jog": 1, "axes": {"y": -1}}));
    page.until("the switch", |page| {
        page.say(json!({"do": "renew", "jog": 1}));
        page.has_line("jog 1 ends: home switch y closed")
            .then_some(())
    });
    let [_, y, ..] = stands(&mut page);
    assert!(y.abs() <= 2, "200 steps off its switch is home: {y}");
    page.done(json!({"do": "steps", "steps": {"y": 3}}));
}

#[test]
fn a_figure_is_stored_cut_and_has_a_report() {
    let served = served(&["--speed", "5"]);
    let mut page = served.in_control();
    let (status, report) = served.load(page.client, "zigzag.fig", ZIGZAG);
    assert_eq!(
        (status, &report["errors"], &report["lines"]),
        (200, &json!(0), &json!(5))
    );
    let why = page.refused(json!({"do": "run"}));
    assert!(why.contains("home"), "{why}");
    page.done(json!({"do": "home"}));
    page.until_state("Idle");
    let plan = page.done(json!({"do": "run"}));
    assert!(
        (plan["time_s"].as_f64().unwrap() - 11.72).abs() < 0.01,
        "{plan}"
    );
    page.refused(json!({"do": "run", "from": 2}));
    page.done(json!({"do": "run", "confirmed": true}));
    let (mut moves, mut lines) = (BTreeSet::new(), BTreeSet::new());
    let (mut had_contact, mut progress) = (false, 0.0);
    page.until("the end", |page| {
        let program = &page.states[0]["program"];
        let is_cut = factory(page)["contact"] == true && program["phase"] == "running";
        had_contact |= is_cut;
        if is_cut {
            moves.insert(program["line"].as_u64()?);
            lines.insert(factory(page)["line"].as_u64()?);
        }
        let now = program["progress"].as_f64()?;
        assert!(now >= progress - 1e-9, "{progress} {now}");
        progress = now;
        (program["phase"] == "done").then_some(())
    });
    assert!(had_contact);
    assert_eq!(moves, (1..=5).collect());
    // The program that is drawn has a line with the modes before.
    assert_eq!(lines, (2..=6).collect());
    let program = &page.states[0]["program"];
    assert_eq!(
        (&program["answered"], &program["progress"]),
        (&json!(5), &json!(1.0))
    );
    let [x, y, z, _] = stands(&mut page);
    assert_eq!([x, z], [0, 0]);
    assert!(y > 500, "{y}");
    // The work zero is where the tool has touched.
    assert_eq!(page.states[0]["work_mm"], json!([0.0, 0.0, 0.0]));
    assert!(page.at("machine_mm", 1) > 0.9);
    assert!(page.has_line("the tool touches") && page.has_line("5 moves stored"));
    let kinds = |kind: i64| page.path.iter().filter(|point| point[0] == kind).count();
    assert!(kinds(1) > 10 && kinds(2) > 100, "{} {}", kinds(1), kinds(2));
    let report = served.get("/machines/1/report", &token(&served));
    assert!(report.contains("moves cut") && report.contains("5 of 5"));
    // A program has the same way, and a picture before.
    let (_, report) = served.load(page.client, "square.nc", SQUARE);
    assert_eq!(
        (&report["errors"], &report["lines"]),
        (&json!(0), &json!(5))
    );
    assert!(
        served
            .get("/machines/1/scene", &token(&served))
            .starts_with("HTTP/1.1 200")
    );
    page.done(json!({"do": "unload"}));
    page.until("nothing", |page| {
        page.states[0]["program"].is_null().then_some(())
    });
}

#[test]
fn what_cannot_be_cut_has_its_line() {
    let served = served(&["--speed", "20"]);
    let mut page = homed(&served);
    let many = "1 0\n-1 0\n".repeat(501);
    for (name, text, line) in [
        ("a.fig", "100 0\n100 x\n", 2),
        ("b.nc", "G21 G1 F40 X1\nG18 G2 X2 I0.5\n", 2),
        ("c.nc", "G21 G1 F40 X1\nY1\n", 2),
        ("d.nc", "G21 G1 X1\n", 1),
        ("e.fig", "; nothing\n", 0),
        ("f.fig", &many, 0),
    ] {
        let (status, report) = served.load(page.client, name, text);
        assert_eq!(status, 200, "{name}: {report}");
        assert!(report["errors"].as_u64().unwrap() > 0, "{name}: {report}");
        let findings = report["findings"].as_array().unwrap();
        let errors = findings.iter().filter(|one| one["severity"] == "error");
        let lines: Vec<_> = errors.map(|one| one["line"].as_u64().unwrap()).collect();
        assert!(line == 0 || lines == [line], "{name}: {report}");
        let why = page.refused(json!({"do": "run", "confirmed": true}));
        assert!(why.contains("errors"), "{name}: {why}");
    }
    assert_eq!(stands(&mut page), [0; 4]);
}

#[test]
fn stop_ends_a_figure_and_the_position_stays_valid() {
    let served = served(&["--speed", "4"]);
    let (mut page, mut watcher) = (homed(&served), served.page());
    assert_eq!(served.load(page.client, "zigzag.fig", ZIGZAG).0, 200);
    page.done(json!({"do": "run", "confirmed": true}));
    page.refused(json!({"do": "home"}));
    page.refused(json!({"do": "unload"}));
    page.until("move 3", |page| {
        (page.states[0]["program"]["line"] == 3 && factory(page)["contact"] == true).then_some(())
    });
    watcher.done(json!({"do": "stop"}));
    page.until_phase("stopped");
    let [x, ..] = stands(&mut page);
    assert!((600..=900).contains(&x), "{x}");
    assert_eq!(factory(&page)["is_homed"], true);
    let message = page.states[0]["program"]["message"].as_str().unwrap();
    assert_eq!(message, "stopped; all moves before move 3 are cut");
    let report = served.get("/machines/1/report", &token(&served));
    assert!(report.contains("STOP at move 3") && report.contains("2 of 5"));
    page.done(json!({"do": "home"}));
    assert_eq!(stands(&mut page)[..3], [0; 3]);
}

#[test]
fn stop_does_not_wait_while_a_figure_is_stored() {
    // A thousand moves take ten seconds.
    let served = served(&[]);
    let mut page = homed(&served);
    let many = "1 0\n-1 0\n".repeat(500);
    assert_eq!(served.load(page.client, "many.fig", &many).0, 200);
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("stored", |page| {
        (factory(page)["stored"].as_u64()? > 20).then_some(())
    });
    let begun = Instant::now();
    page.done(json!({"do": "stop"}));
    page.until_phase("stopped");
    assert!(
        begun.elapsed() < Duration::from_secs(2),
        "{:?}",
        begun.elapsed()
    );
    assert_eq!(stands(&mut page), [0; 4], "nothing has moved");
    assert!(factory(&page)["stored"].is_null());
}

#[test]
fn an_emergency_stop_holds_until_the_reset() {
    let served = served(&["--speed", "4"]);
    let (mut page, mut watcher) = (homed(&served), served.page());
    assert_eq!(served.load(page.client, "zigzag.fig", ZIGZAG).0, 200);
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("the figure", |page| {
        (factory(page)["contact"] == true).then_some(())
    });
    watcher.done(json!({"do": "emergency"}));
    page.until_state("Alarm");
    page.until_phase("stopped");
    stands(&mut page);
    assert_eq!(
        (&factory(&page)["is_latched"], &factory(&page)["is_homed"]),
        (&json!(true), &json!(false))
    );
    assert!(
        page.states[0]["alarm"]["text"]
            .as_str()
            .unwrap()
            .contains("emergency")
    );
    for refused in [
        json!({"do": "home"}),
        json!({"do": "steps", "steps": {"x": 1}}),
        json!({"do": "jog", "jog": 9, "axes": {"x": 1}}),
        json!({"do": "run", "confirmed": true}),
    ] {
        let why = page.refused(refused);
        assert!(why.contains("emergency"), "{why}");
    }
    page.done(json!({"do": "stop"}));
    page.until("the stop", |page| {
        page.has_line("the machine has stopped").then_some(())
    });
    assert_eq!(
        factory(&page)["is_latched"],
        true,
        "a STOP does not unlatch it"
    );
    watcher.refused(json!({"do": "reset"}));
    page.done(json!({"do": "reset"}));
    page.until_state("Idle");
    assert_eq!(
        (&factory(&page)["is_latched"], &factory(&page)["is_homed"]),
        (&json!(false), &json!(false))
    );
    page.done(json!({"do": "home"}));
    assert_eq!(stands(&mut page)[..3], [0; 3]);
    // Other machines have none.
    let router = Served::new(&[]);
    let why = router.page().refused(json!({"do": "emergency"}));
    assert!(why.contains("STOP"), "{why}");
}

#[test]
fn the_panel_at_the_machine_and_the_line_are_told() {
    let mut device = Emulated::listening("microfactory", &[]);
    let relay = Relay::to(device.port());
    let served = served(&["--port", &relay.port]);
    let mut page = homed(&served);
    assert!(
        page.refused(json!({"do": "reset"}))
            .contains("at the machine")
    );
    // An answer that is lost is asked for again.
    relay.lose(9);
    page.pass(Duration::from_millis(2500));
    assert_eq!(
        (&page.states[0]["link"], &page.states[0]["state"]),
        (&json!("up"), &json!("Idle"))
    );
    // The tool finds nothing to touch.
    device.type_line("open contact", "held open");
    assert_eq!(served.load(page.client, "zigzag.fig", ZIGZAG).0, 200);
    let mut message = String::new();
    // On a busy computer the lease of 250 ms may end the approach, which takes 12 s.
    while message.is_empty() || message.contains("the host was silent") {
        page.done(json!({"do": "run", "confirmed": true}));
        page.until_phase("running");
        page.until_phase("failed");
        let program = &page.states[0]["program"];
        message = program["message"].as_str().unwrap().to_owned();
    }
    assert!(
        message.contains("no contact") && message.contains("no move is cut"),
        "{message}"
    );
    device.type_line("free contact", "free");
    // A lost step is found by the next homing.
    page.done(json!({"do": "home"}));
    device.type_line("block x", "blocked");
    page.done(json!({"do": "steps", "steps": {"x": 100}}));
    device.type_line("unblock x", "free");
    page.done(json!({"do": "home"}));
    page.until("the loss", |page| {
        page.has_line("steps were lost").then_some(())
    });
    // Somebody resets the machine.
    device.type_line("reset", "reset");
    page.until("the reset", |page| {
        page.has_line("the device was reset").then_some(())
    });
    page.until("the loss", |page| {
        (factory(page)["is_homed"] != true).then_some(())
    });
    page.until("the link", |page| {
        (page.states[0]["link"] == "up").then_some(())
    });
    page.done(json!({"do": "steps", "steps": {"x": 5}}));
    // The power fails in a motion.
    page.done(json!({"do": "jog", "jog": 1, "axes": {"y": 1}}));
    drop(device);
    page.until("the loss", |page| {
        (page.states[0]["link"] == "lost").then_some(())
    });
    assert!(page.refused(json!({"do": "home"})).contains("lost"));
}

/// The STOP is older than whatever was asked for before it and still waits.
#[test]
fn a_stop_ends_what_waits_behind_a_lost_answer() {
    let device = Emulated::listening("microfactory", &[]);
    let relay = Relay::to(device.port());
    let served = served(&["--port", &relay.port]);
    let mut page = served.in_control();
    // The answer to the mode of counted steps is lost: the driver waits for it.
    relay.lose_next(b'N');
    let lost = page.begin(json!({"do": "steps", "steps": {"x": 5}}));
    page.until("the command", |page| page.has_line("x +5").then_some(()));
    let waits = page.begin(json!({"do": "steps", "steps": {"y": 200}}));
    page.done(json!({"do": "stop"}));
    let later = page.begin(json!({"do": "home"}));
    page.answer(lost).unwrap_err();
    for number in [waits, later] {
        let why = page.answer(number).unwrap_err();
        assert_eq!(why, "the machine is being stopped");
    }
    page.until("the stop", |page| {
        page.has_line("the machine has stopped").then_some(())
    });
    assert_eq!(stands(&mut page), [0; 4]);
    assert!(!page.has_line("y +200"), "{:?}", page.lines);
    page.done(json!({"do": "steps", "steps": {"y": 20}}));
    assert_eq!(stands(&mut page), [0, 20, 0, 0]);
}

#[test]
fn a_stop_at_rest_ends_what_was_asked_for_before_it() {
    let served = served(&[]);
    let mut page = served.in_control();
    for verb in ["stop", "emergency", "stop"] {
        let waits = page.begin(json!({"do": "home"}));
        page.done(json!({"do": verb}));
        page.answer(waits).unwrap_err();
        stands(&mut page);
        assert_eq!(factory(&page)["is_homed"], false, "{verb}");
        if verb == "emergency" {
            page.done(json!({"do": "reset"}));
            page.until_state("Idle");
        }
    }
}

#[test]
fn a_lost_byte_ends_a_jog_and_not_the_link() {
    let device = Emulated::listening("microfactory", &[]);
    let relay = Relay::to(device.port());
    let served = served(&["--port", &relay.port]);
    let mut page = served.in_control();
    page.done(json!({"do": "jog", "jog": 1, "axes": {"y": 1}}));
    page.until("motion", |page| {
        page.say(json!({"do": "renew", "jog": 1}));
        (steps(page)[1] > 40).then_some(())
    });
    page.until("the end", |page| {
        // The answer to its next repetition. A position may have the same byte.
        relay.lose_next(b'Y');
        page.say(json!({"do": "renew", "jog": 1}));
        page.has_line("jog 1 ends: ").then_some(())
    });
    stands(&mut page);
    assert_eq!(page.states[0]["link"], "up");
    let answers = page.lines.iter();
    let answers = answers.filter(|line| line["text"] == "the controller answers");
    assert_eq!(answers.count(), 1, "{:?}", page.lines);
    page.done(json!({"do": "jog", "jog": 2, "axes": {"y": -1}}));
    page.hold(2, Duration::from_millis(500));
    page.done(json!({"do": "release", "jog": 2}));
    stands(&mut page);
}

#[test]
fn an_emergency_stop_while_a_figure_is_stored_is_reported() {
    let device = Emulated::listening("microfactory", &[]);
    let relay = Relay::to(device.port());
    let served = served(&["--port", &relay.port]);
    let mut page = homed(&served);
    let many = "1 0\n-1 0\n".repeat(500);
    assert_eq!(served.load(page.client, "many.fig", &many).0, 200);
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("stored", |page| {
        (factory(page)["stored"].as_u64()? > 20).then_some(())
    });
    // A move that was begun takes four bytes at most.
    relay.say(b"!!!!!!");
    page.until_state("Alarm");
    page.until("the report", |page| {
        page.has_line("EMERGENCY STOP").then_some(())
    });
    page.until_phase("stopped");
    let message = page.states[0]["program"]["message"].to_string();
    assert!(message.contains("no move is cut"), "{message}");
    assert!(factory(&page)["stored"].is_null());
    assert!(page.refused(json!({"do": "home"})).contains("emergency"));
}

/// It was sent, and nothing has confirmed it. So it is sent again when the controller answers.
#[test]
fn an_emergency_stop_that_is_not_confirmed_is_asked_for_again() {
    let device = Emulated::listening("microfactory", &[]);
    let relay = Relay::to(device.port());
    let served = served(&["--port", &relay.port]);
    let (mut page, mut watcher) = (served.in_control(), served.page());
    relay.block(true);
    let why = watcher.refused(json!({"do": "emergency"}));
    assert!(why.contains("the button at the machine"), "{why}");
    page.until("the loss", |page| {
        (page.states[0]["link"] == "lost").then_some(())
    });
    assert_eq!(page.states[0]["emergency_waits"], true);
    relay.block(false);
    page.until_state("Alarm");
    assert_eq!(factory(&page)["is_latched"], true);
    assert!(page.states[0].get("emergency_waits").is_none());
}

#[test]
fn an_emergency_stop_without_a_link_acts_when_the_controller_answers() {
    let device = Emulated::listening("microfactory", &[]);
    let relay = Relay::to(device.port());
    let served = served(&["--port", &relay.port]);
    let mut page = served.in_control();
    relay.pull();
    page.until("the loss", |page| {
        (page.states[0]["link"] == "lost").then_some(())
    });
    assert!(page.states[0].get("emergency_waits").is_none());
    let why = page.refused(json!({"do": "emergency"}));
    assert!(
        why.contains("it acts when the controller answers again"),
        "{why}"
    );
    page.until("the request", |page| {
        (page.states[0]["emergency_waits"] == true).then_some(())
    });
    relay.plug();
    page.until_state("Alarm");
    page.until("the report", |page| {
        page.has_line("EMERGENCY STOP: ").then_some(())
    });
    assert_eq!(factory(&page)["is_latched"], true);
}
