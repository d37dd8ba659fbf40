//! The report of a run.

use super::page::{Page, Served};
use serde_json::json;

const PART: &str = "G21 G90\nG1 X5 F600\nY5\nX0\nY0\n";

fn until_runs(page: &mut Page, runs: u64) {
    page.until("an end", |page| {
        (page.states[0]["program"]["runs"] == runs).then_some(())
    });
    page.until_state("Idle");
}

#[test]
fn a_run_has_a_report() {
    let served = Served::new(&["--speed", "5"]);
    let mut page = served.operator();
    let path = format!("/machines/1/report?token={}", served.token);
    assert!(
        served
            .get("/machines/1/report", "")
            .starts_with("HTTP/1.1 403")
    );
    assert!(served.get(&path, "").starts_with("HTTP/1.1 404"));
    served.load(page.client, "a%20%3Cpart%3E.nc", PART);
    page.done(json!({"do": "breakpoints", "lines": [4]}));
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("a wait", |page| {
        (page.states[0]["program"]["phase"] == "waiting").then_some(())
    });
    // There is none before the end.
    assert!(served.get(&path, "").starts_with("HTTP/1.1 404"));
    page.done(json!({"do": "override", "what": "feed", "percent": 50}));
    page.done(json!({"do": "resume"}));
    until_runs(&mut page, 1);
    let answer = served.get(&path, "");
    let (head, report) = answer.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200"), "{head}");
    assert!(head.contains("filename=\"a--part--20"), "{head}");
    // Its scripts reach no server.
    let policies = head
        .lines()
        .filter(|line| line.starts_with("content-security-policy"));
    let policies: Vec<_> = policies.collect();
    assert!(
        policies.len() == 1 && policies[0].contains("default-src 'none'"),
        "{head}"
    );
    // The report of `husillo run`, with the viewer.
    assert!(report.contains("id=\"scene\"") && report.contains("Tool path in X and Y"));
    for what in [
        "a &lt;part&gt;.nc",
        "<dt>lines accepted</dt><dd>5 of 5</dd>",
        "<dt>alarms</dt><dd>0</dd>",
        "<td>waits before line 4</td>",
        "<td>goes on</td>",
        "feed 50 %",
        "5 lines made; work X 0.000 Y 0.000 Z 0.000 mm",
    ] {
        assert!(report.contains(what), "{what}");
    }
    // It stays when another program is loaded, until that one has run.
    served.load(page.client, "other.nc", "G1 X30 F600\n");
    assert!(served.get(&path, "").contains("a &lt;part&gt;.nc"));
    page.done(json!({"do": "override", "what": "feed", "percent": 100}));
    page.done(json!({"do": "run", "confirmed": true}));
    page.until("motion", |page| (page.at("work_mm", 0) > 1.0).then_some(()));
    page.done(json!({"do": "stop"}));
    until_runs(&mut page, 2);
    let report = served.get(&path, "");
    for what in [
        "other.nc",
        "<dt>stops</dt><dd>1</dd>",
        "STOP at line 1",
        "all lines before line 1 are made",
    ] {
        assert!(report.contains(what), "{what}");
    }
}
