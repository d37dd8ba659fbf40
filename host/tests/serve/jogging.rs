//! A jog lasts while a page holds it.

use super::page::{Page, Served};
use serde_json::json;
use std::time::{Duration, Instant};

/// Speed of the jogs, mm/s. The axes of the simulated machine brake with 500 mm/s^2.
const SPEED: f64 = 10.0;
const BRAKING_MM: f64 = SPEED * SPEED / 2.0 / 500.0;
/// A report is this old at most, s: the interval of the reports and that of the states.
const AGE_S: f64 = 0.1;
/// After its end, a jog has this time to stop, s.
const STOP_S: f64 = 0.3;

fn begin(page: &mut Page, jog: u64) {
    page.done(json!({"do": "jog", "jog": jog, "axes": {"x": 1}, "feed": SPEED * 60.0}));
}

/// Renews a jog for a time, and returns where the machine is then.
fn hold(page: &mut Page, jog: u64, time: Duration) -> f64 {
    page.hold(jog, time);
    page.at("machine_mm", 0)
}

/// Waits until the machine stands. It has gone on for at most this time, in its own measure: the
/// way at the speed of the jog.
fn stands(page: &mut Page, from: f64, most_s: f64) {
    page.until_state("Idle");
    page.pass(Duration::from_millis(400));
    assert_eq!(page.states[0]["state"], "Idle");
    let way = page.at("machine_mm", 0) - from;
    let most = SPEED * (most_s + AGE_S) + BRAKING_MM;
    assert!(
        way <= most,
        "{way} mm after the end of the jog, more than {most} mm"
    );
}

#[test]
fn a_jog_reaches_its_speed_and_stops_when_it_is_released() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    begin(&mut page, 1);
    let first = hold(&mut page, 1, Duration::from_millis(600));
    assert!(page.states[0]["jog"]["jog"] == 1);
    let begun = Instant::now();
    let from = hold(&mut page, 1, Duration::from_secs(1));
    let speed = (from - first) / begun.elapsed().as_secs_f64();
    assert!((0.5 * SPEED..1.3 * SPEED).contains(&speed), "{speed} mm/s");
    page.say(json!({"do": "release", "jog": 1}));
    stands(&mut page, from, STOP_S);
    assert!(page.states[0]["jog"].is_null());
}

#[test]
fn a_jog_that_is_not_renewed_stops() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    begin(&mut page, 7);
    let from = hold(&mut page, 7, Duration::from_millis(700));
    // The lease of 250 ms goes on from the last renewal.
    stands(&mut page, from, 0.25 + STOP_S);
    assert!(page.has_line("jog 7 ends: the page did not renew it"));
    // A late renewal does not bring it back.
    page.say(json!({"do": "renew", "jog": 7}));
    page.pass(Duration::from_millis(300));
    assert_eq!(page.states[0]["state"], "Idle");
}

#[test]
fn a_jog_stops_when_its_page_is_closed() {
    let served = Served::new(&[]);
    let (mut page, mut watcher) = (served.operator(), served.page());
    begin(&mut page, 1);
    hold(&mut page, 1, Duration::from_millis(700));
    watcher.pass(Duration::from_millis(30));
    let from = watcher.until("the newest state", |page| Some(page.at("machine_mm", 0)));
    drop(page);
    stands(&mut watcher, from, STOP_S);
}

#[test]
fn a_jog_stops_when_another_takes_control() {
    let served = Served::new(&[]);
    let (mut page, mut other) = (served.operator(), served.page());
    begin(&mut page, 1);
    let from = hold(&mut page, 1, Duration::from_millis(700));
    other.done(json!({"do": "take", "force": true}));
    page.say(json!({"do": "renew", "jog": 1}));
    stands(&mut page, from, STOP_S);
    assert!(
        page.refused(json!({"do": "release", "jog": 1}))
            .contains("take control")
    );
}

#[test]
fn a_jog_changes_its_direction() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    begin(&mut page, 1);
    hold(&mut page, 1, Duration::from_millis(400));
    page.done(json!({"do": "jog", "jog": 2, "axes": {"x": -1, "y": -1}, "feed": 600}));
    hold(&mut page, 2, Duration::from_millis(1200));
    page.say(json!({"do": "release", "jog": 2}));
    page.until_state("Idle");
    assert!(page.at("machine_mm", 1) < -1.0, "{:?}", page.states);
}

#[test]
fn a_jog_without_a_direction_or_while_locked_is_refused() {
    let served = Served::new(&[]);
    let mut page = served.in_control();
    let jog = |axes| json!({"do": "jog", "jog": 1, "axes": axes, "feed": 600});
    assert!(page.refused(jog(json!({"x": 1}))).contains("locked"));
    page.done(json!({"do": "unlock"}));
    page.until_state("Idle");
    for axes in [
        json!({}),
        json!({"x": 0}),
        json!({"q": 1}),
        json!({"x": 1e300}),
    ] {
        page.refused(jog(axes));
    }
    page.pass(Duration::from_millis(200));
    assert_eq!(page.at("machine_mm", 0), 0.0);
}
