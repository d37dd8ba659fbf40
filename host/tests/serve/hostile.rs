//! Frames of a page that means harm, or is broken.

use super::page::Served;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use serde_json::{Value, json};
use std::cell::RefCell;
use std::time::Duration;
use tungstenite::Message;

/// Any JSON.
fn any_json() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        "[a-z_]{0,8}|.{0,8}".prop_map(Value::from),
    ];
    leaf.prop_recursive(3, 16, 4, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
            prop::collection::vec(("[a-z_]{0,8}", inner), 0..4)
                .prop_map(|pairs| Value::Object(pairs.into_iter().collect())),
        ]
    })
}

/// Something like a request.
fn almost() -> impl Strategy<Value = Value> {
    let verbs = prop::sample::select(vec![
        "take",
        "give",
        "resume",
        "reset",
        "unlock",
        "home",
        "jog",
        "renew",
        "release",
        "step",
        "goto",
        "zero",
        "undo_zero",
        "line",
        "override",
        "toggle",
    ]);
    let keys = prop::sample::select(vec![
        "id", "machine", "jog", "axes", "feed", "move_mm", "to_mm", "at_mm", "text", "what",
        "percent", "frame", "axis",
    ]);
    let fields = prop::collection::vec((keys, any_json()), 0..5);
    (verbs, fields).prop_map(|(verb, fields)| {
        let mut request = json!({"do": verb, "machine": 1});
        for (key, value) in fields {
            request[key] = value;
        }
        request
    })
}

/// Any frame. None of them takes control.
fn frame() -> impl Strategy<Value = Message> {
    prop_oneof![
        any_json().prop_map(|json| Message::text(json.to_string())),
        almost()
            .prop_filter("control", |request| request["do"] != "take")
            .prop_map(|json| Message::text(json.to_string())),
        ".{0,40}".prop_map(Message::text),
        prop::collection::vec(any::<u8>(), 0..60).prop_map(Message::binary),
        prop::collection::vec(any::<u8>(), 0..60).prop_map(|bytes| Message::Ping(bytes.into())),
    ]
}

#[test]
fn frames_of_a_watcher_change_nothing() {
    let served = Served::new(&[]);
    let (mut operator, hostile) = (served.operator(), RefCell::new(served.page()));
    operator.done(json!({"do": "zero", "at_mm": {"x": 3}}));
    operator.until_at("work_mm", 0, 3.0);
    operator.until("the modes", |page| {
        page.states[0]["modal"].is_array().then_some(())
    });
    let mut runner = TestRunner::new(Config {
        cases: 400,
        failure_persistence: None,
        ..Config::default()
    });
    runner
        .run(&frame(), |frame| {
            // A hostile page may be thrown out. Another one comes.
            let mut hostile = hostile.borrow_mut();
            if hostile_send(&mut hostile, frame).is_err() {
                *hostile = served.page();
            }
            Ok(())
        })
        .unwrap();
    operator.pass(Duration::from_millis(200));
    assert_eq!(operator.states[0]["state"], "Idle");
    assert_eq!(operator.at("work_mm", 0), 3.0);
    assert_eq!(operator.states[0]["operator"], operator.client);
    operator.done(json!({"do": "step", "move_mm": {"x": 0.1}, "feed": 600}));
}

fn hostile_send(page: &mut super::page::Page, frame: Message) -> Result<(), ()> {
    page.socket.send(frame).map_err(|_| ())?;
    // Answers do not pile up.
    page.receive().then_some(()).ok_or(())
}

/// The operator may do much, but the server lives and STOP works.
#[test]
fn frames_of_the_operator_do_not_end_the_server() {
    let served = Served::new(&[]);
    let (operator, mut watcher) = (RefCell::new(served.operator()), served.page());
    let mut runner = TestRunner::new(Config {
        cases: 300,
        failure_persistence: None,
        ..Config::default()
    });
    runner
        .run(&almost(), |request| {
            let mut operator = operator.borrow_mut();
            if hostile_send(&mut operator, Message::text(request.to_string())).is_err() {
                *operator = served.page();
                operator.say(json!({"do": "take"}));
            }
            Ok(())
        })
        .unwrap();
    watcher.done(json!({"do": "stop"}));
    watcher.until("the stop", |page| {
        page.has_line("the machine has stopped").then_some(())
    });
}

#[test]
fn a_frame_that_is_too_long_closes_its_socket() {
    let served = Served::new(&[]);
    let (mut page, mut other) = (served.page(), served.page());
    let _ = page.socket.send(Message::text("x".repeat(70_000)));
    while page.receive() {}
    other.done(json!({"do": "take"}));
}

/// A page that asks and never reads is thrown out, and holds nobody up.
#[test]
fn a_page_that_does_not_read_is_closed() {
    let served = Served::new(&[]);
    let (mut slow, mut other) = (served.page(), served.operator());
    let request = format!(r#"{{"do": "{}", "machine": 1, "id": 1}}"#, "q".repeat(2000));
    let flood = std::thread::spawn(move || {
        let far = Some(Duration::from_secs(90));
        slow.socket.get_ref().set_write_timeout(far).unwrap();
        let sent = (0..200_000).try_for_each(|_| slow.socket.send(Message::text(&*request)));
        assert!(sent.is_err(), "all requests were taken");
    });
    for step in 1..=10 {
        other.done(json!({"do": "step", "move_mm": {"y": -0.1}, "feed": 1200}));
        other.until_at("machine_mm", 1, -0.1 * f64::from(step));
        other.until_state("Idle");
    }
    flood.join().unwrap();
    other.done(json!({"do": "stop"}));
}
