//! Many pages at once.

use super::page::{Page, Served};
use serde_json::json;
use std::time::{Duration, Instant};

/// Twenty pages watch a machine that moves to and fro. All get its states, from first to last.
fn watched(time: Duration) {
    let served = Served::new(&[]);
    let mut operator = served.operator();
    let mut watchers: Vec<_> = (0..20).map(|_| served.page()).collect();
    operator.done(json!({"do": "line", "text": "G1 F1200"}));
    let begun = Instant::now();
    let mut turns = 0;
    while begun.elapsed() < time {
        turns += 1;
        let to = if turns % 2 == 1 { 2.0 } else { 0.0 };
        operator.done(json!({"do": "line", "text": format!("X{to}")}));
        operator.until_at("work_mm", 0, to);
        for watcher in &mut watchers {
            watcher.until_at("work_mm", 0, to);
        }
    }
    assert!(turns > 1);
    operator.until("all watch", |page| {
        (page.states[0]["clients"] == 21).then_some(())
    });
    let stops = watchers.last_mut().unwrap();
    stops.done(json!({"do": "stop"}));
    let is_told = |page: &mut Page| page.has_line("the machine has stopped").then_some(());
    watchers
        .iter_mut()
        .for_each(|page| page.until("the stop", is_told));
}

#[test]
fn twenty_pages_watch() {
    watched(Duration::from_secs(3));
}

#[test]
#[ignore = "takes five minutes"]
fn twenty_pages_watch_for_long() {
    watched(Duration::from_secs(300));
}

#[test]
#[ignore = "takes an hour"]
fn twenty_pages_watch_for_an_hour() {
    watched(Duration::from_secs(3600));
}

/// While 20,000 steps are made each second, each of twenty pages gets 60 positions a second.
#[test]
#[ignore = "measures this computer"]
fn a_motion_is_shown_sixty_times_a_second() {
    let served = Served::new(&[]);
    let mut operator = served.operator();
    let mut watchers: Vec<_> = (0..20).map(|_| served.page()).collect();
    operator.done(json!({"do": "line", "text": "G1 F3000 X200"}));
    operator.until_state("Run");
    operator.pass(Duration::from_millis(500));
    for watcher in &mut watchers {
        watcher.pass(Duration::from_millis(10));
    }
    let mut positions = 0;
    let begun = Instant::now();
    let mut last = watchers[0].at("work_mm", 0);
    while begun.elapsed() < Duration::from_secs(3) {
        watchers[0].receive();
        let now = watchers[0].at("work_mm", 0);
        positions += u32::from(now != last);
        last = now;
    }
    println!("{:.1} positions a second", f64::from(positions) / 3.0);
    assert!(positions > 3 * 55);
}

/// A page that only listens, and answers no request, is not taken for lost: its pongs count.
#[test]
#[ignore = "takes a minute and a half"]
fn a_page_that_only_listens_stays() {
    let served = Served::new(&[]);
    let mut page = served.page();
    page.pass(Duration::from_secs(90));
    page.done(json!({"do": "take"}));
}
