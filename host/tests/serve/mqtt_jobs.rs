//! Jobs of a broker: each runs once, whatever happens.

use super::broker::{Broker, Host, Value};
use super::page::{Page, Served};
use serde_json::json;
use std::time::{Duration, Instant};

/// A server with the name `mill` that takes jobs, and has the state of this broker.
fn served(broker: &Broker, options: &[&str]) -> Served {
    let url = broker.url();
    let own = ["--mqtt", &url, "--mqtt-node", "mill", "--mqtt-jobs"];
    Served::with(&[options, &own].concat(), &broker.state())
}

/// Unlocks machine 1 and leaves it to the broker, which has reached the server.
fn unlocked(served: &Served, host: &mut Host) -> Page {
    host.until("the machine", |one| one.kind == "DBIRTH");
    let mut page = served.operator();
    page.done(json!({"do": "give"}));
    // A move by hand would end first.
    page.pass(Duration::from_millis(500));
    page
}

/// How many runs of machine 1 have ended, and where it stands in X.
fn made(page: &mut Page) -> (u64, f64) {
    // What has happened meanwhile.
    page.pass(Duration::from_millis(300));
    page.until_state("Idle");
    let runs = page.states[0]["program"]["runs"].as_u64().unwrap_or(0);
    (runs, page.at("work_mm", 0))
}

/// A program that shows by the position how often it was made.
const STEP: &str = "G21 G91\nG1 X2 F1200\nG90\n";

#[test]
fn a_job_that_is_doubled_runs_once() {
    let Some(broker) = Broker::new("mqtt-double") else {
        return;
    };
    let mut host = Host::new(&broker);
    let served = served(&broker, &["--speed", "5"]);
    let mut page = unlocked(&served, &mut host);
    for _ in 0..5 {
        host.job("order-1", STEP);
    }
    host.until_job("order-1", "running");
    host.until_job("order-1", "done");
    // Twice more after its end.
    host.job("order-1", STEP);
    host.job("order-1", "G21 G91\nG1 X7 F1200\n");
    host.until_job("order-1", "done");
    host.until_job("order-1", "done");
    host.pass(Duration::from_secs(1));
    assert_eq!(made(&mut page), (1, 2.0));
    // Another job runs.
    host.job("order-2", STEP);
    host.until_job("order-2", "done");
    page.until_at("work_mm", 0, 4.0);
    assert_eq!(made(&mut page), (2, 4.0));
    // A message that the broker keeps, and one without a program, are no jobs.
    let topic = "spBv1.0/husillo/DCMD/mill/machine-1";
    let kept = [("Job/Id", "order-3"), ("Job/Program", STEP)];
    host.write(topic, &kept, true);
    host.until_job("order-3", "done");
    drop((served, page));
    let served = self::served(&broker, &["--speed", "5"]);
    let mut page = unlocked(&served, &mut host);
    host.write(topic, &[("Job/Id", "order-4")], false);
    assert!(
        host.until_job("order-4", "refused")
            .text("Job/Message")
            .contains("missing")
    );
    assert_eq!(made(&mut page), (0, 0.0));
}

#[test]
fn a_job_is_not_run_again_by_another_server() {
    let Some(broker) = Broker::new("mqtt-again") else {
        return;
    };
    let mut host = Host::new(&broker);
    let first = served(&broker, &["--speed", "5"]);
    drop(unlocked(&first, &mut host));
    host.job("order/1", STEP);
    host.until_job("order/1", "done");
    drop(first);
    let second = served(&broker, &["--speed", "5"]);
    let mut page = unlocked(&second, &mut host);
    host.job("order/1", STEP);
    let told = host.until_job("order/1", "done");
    assert_eq!(told.kind, "DDATA");
    host.pass(Duration::from_secs(1));
    assert_eq!(made(&mut page), (0, 0.0));
    assert!(page.states[0]["program"].is_null());
}

/// The next job comes as soon as the end of the last one is shown, and the operator may take its
/// program away.
#[test]
fn a_job_is_done_whatever_follows() {
    let Some(broker) = Broker::new("mqtt-follows") else {
        return;
    };
    let mut host = Host::new(&broker);
    let served = served(&broker, &["--speed", "5"]);
    let mut page = unlocked(&served, &mut host);
    host.job("first", STEP);
    host.until_job("first", "running");
    page.until("its end", |page| {
        (page.states[0]["program"]["phase"] == "done").then_some(())
    });
    host.job("second", STEP);
    host.until_job("first", "done");
    host.until_job("second", "running");
    page.until("the next end", |page| {
        let program = &page.states[0]["program"];
        (program["phase"] == "done" && program["runs"] == 2).then_some(())
    });
    page.done(json!({"do": "take"}));
    page.done(json!({"do": "unload"}));
    host.until_job("second", "done");
}

/// A job that is refused is not run later.
#[test]
fn a_refused_job_stays_refused() {
    let Some(broker) = Broker::new("mqtt-refused") else {
        return;
    };
    let mut host = Host::new(&broker);
    let served = served(&broker, &["--speed", "5"]);
    let mut page = served.page();
    host.until("the machine", |one| one.kind == "DBIRTH");
    host.job("locked", STEP);
    assert!(
        host.until_job("locked", "refused")
            .text("Job/Message")
            .contains("home or unlock")
    );
    page.done(json!({"do": "take"}));
    page.done(json!({"do": "unlock"}));
    page.until_state("Idle");
    host.job("operated", STEP);
    let why = host.until_job("operated", "refused");
    assert!(
        why.text("Job/Message")
            .contains("another client is in control")
    );
    page.done(json!({"do": "give"}));
    page.pass(Duration::from_millis(500));
    host.job("wrong", "G21 G90\nG2 X1 Y1 F100\n");
    assert!(
        host.until_job("wrong", "refused")
            .text("Job/Message")
            .starts_with("line 2: ")
    );
    for id in ["locked", "operated", "wrong"] {
        host.job(id, STEP);
        host.until_job(id, "refused");
    }
    host.job(&"x".repeat(65), STEP);
    host.until_job(&"x".repeat(65), "refused");
    host.pass(Duration::from_millis(500));
    assert_eq!(made(&mut page), (0, 0.0));
    // While one is made there is no other, and the page can stop it.
    let long: String = (1..=60).map(|x| format!("G1 X{x} F600\n")).collect();
    host.job("long", &long);
    page.until("motion", |page| (page.at("work_mm", 0) > 2.0).then_some(()));
    host.job("other", STEP);
    assert!(
        host.until_job("other", "refused")
            .text("Job/Message")
            .contains("runs")
    );
    page.done(json!({"do": "stop"}));
    let stopped = host.until_job("long", "stopped");
    assert!(stopped.number("Job/Line") > 1.0, "{stopped:?}");
}

#[test]
fn a_job_in_which_the_server_was_lost_is_offered_and_not_run() {
    let Some(broker) = Broker::new("mqtt-killed") else {
        return;
    };
    let mut host = Host::new(&broker);
    let mut first = served(&broker, &[]);
    let mut page = unlocked(&first, &mut host);
    let long: String = (1..=40).map(|x| format!("G1 X{x} F900\n")).collect();
    host.job("long", &long);
    page.until("motion", |page| (page.at("work_mm", 0) > 8.0).then_some(()));
    host.pass(Duration::from_millis(1500));
    first.process.kill().unwrap();
    let killed = Instant::now();
    // The broker itself tells that the server is gone.
    let death = host.until("the will", |one| one.kind == "NDEATH");
    let took = death.at.saturating_duration_since(killed);
    assert!(took < Duration::from_secs(5), "{took:?}");
    drop((first, page));
    let second = served(&broker, &[]);
    let mut page = unlocked(&second, &mut host);
    host.job("long", &long);
    let offered = host.until_job("long", "interrupted");
    let line = offered.number("Job/Line");
    assert!((5.0..40.0).contains(&line), "{offered:?}");
    page.until("the offer", |page| {
        (page.states[0]["program"]["resume_line"] == line).then_some(())
    });
    // The job is sent again: it is not run.
    host.job("long", &long);
    host.until_job("long", "interrupted");
    host.pass(Duration::from_secs(1));
    assert_eq!(made(&mut page), (0, 0.0));
    // The operator goes on with it. The simulated machine stands at its zero again.
    page.done(json!({"do": "take"}));
    let from = line as u64;
    page.until("modes", |page| {
        let shown = page.ask(json!({"do": "run", "from": from}));
        shown.ok()
    });
    page.done(json!({"do": "run", "from": from, "confirmed": true}));
    page.until_at("work_mm", 0, 40.0);
    assert_eq!(made(&mut page).0, 1);
    // It is not offered again.
    drop((second, page));
    let third = served(&broker, &[]);
    let mut page = unlocked(&third, &mut host);
    host.job("long", &long);
    host.until_job("long", "interrupted");
    assert_eq!(made(&mut page), (0, 0.0));
    assert!(page.states[0]["program"].is_null());
}

/// Fifty machines of five servers, each with two jobs that are sent twice.
#[test]
#[ignore = "takes half a minute"]
fn fifty_machines() {
    let Some(broker) = Broker::new("mqtt-fifty") else {
        return;
    };
    let mut host = Host::new(&broker);
    let url = broker.url();
    let mut ports = Vec::new();
    for _ in 0..10 {
        ports.extend(["--port", "sim"]);
    }
    let servers: Vec<_> = (1..=5)
        .map(|number| {
            let node = format!("mill-{number}");
            let own = [
                "--mqtt",
                &url,
                "--mqtt-node",
                &node,
                "--mqtt-jobs",
                "--speed",
                "5",
            ];
            Served::with(&[&ports[..], &own].concat(), &broker.state())
        })
        .collect();
    for served in &servers {
        let mut page = served.page();
        for machine in 1..=10 {
            page.done(json!({"do": "take", "machine": machine}));
            page.done(json!({"do": "unlock", "machine": machine}));
            page.done(json!({"do": "give", "machine": machine}));
        }
    }
    for _ in 0..50 {
        host.until("a machine without an alarm", |one| {
            one.value("Alarm/Active") == Some(&Value::Is(false))
        });
    }
    for round in 1..=2 {
        let begun = Instant::now();
        for _ in 0..2 {
            for (server, machine) in (1..=5).flat_map(|s| (1..=10).map(move |m| (s, m))) {
                let id = format!("job-{round}-{server}-{machine}");
                let topic = format!("spBv1.0/husillo/DCMD/mill-{server}/machine-{machine}");
                host.write(&topic, &[("Job/Id", &id), ("Job/Program", STEP)], false);
            }
        }
        let mut done = std::collections::BTreeSet::new();
        while done.len() < 50 {
            let told = host.until("fifty jobs", |one| one.text("Job/State") == "done");
            done.insert(told.text("Job/Id").to_owned());
        }
        eprintln!(
            "round {round}: fifty jobs in {:.1} s",
            begun.elapsed().as_secs_f64()
        );
    }
    host.pass(Duration::from_secs(2));
    for served in &servers {
        let mut page = served.page();
        page.until("all stand", |page| {
            let is_made = |state: &serde_json::Value| state["work_mm"][0] == 4.0;
            page.states.iter().all(is_made).then_some(())
        });
        assert!(
            page.states
                .iter()
                .all(|state| state["program"]["runs"] == 2)
        );
    }
}
