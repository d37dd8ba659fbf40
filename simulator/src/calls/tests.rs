//! Calls as other languages make them.

use super::*;
use serde_json::Value;

fn options(json: &Value) -> Options {
    serde_json::from_value(json.clone()).unwrap()
}

fn value(answer: &Answer) -> Value {
    serde_json::from_slice(&answer.text).unwrap()
}

#[test]
fn a_check_has_findings_and_a_drill_file_is_known_by_its_name() {
    let wrong = check(&options(&json!({})), b"G1 X1 Q\n").unwrap();
    let wrong = value(&wrong);
    assert_eq!(wrong["findings"][0]["line"], 1);
    assert_eq!(
        wrong["errors"].as_u64().map(|errors| errors > 0),
        Some(true)
    );
    let board = b"M48\nMETRIC\nT1C0.8\n%\nT1\nX1.0Y1.0\nM30\n";
    let drill = check(&options(&json!({"name": "board.drl"})), board).unwrap();
    let drill = value(&drill);
    assert_eq!((&drill["errors"], drill.get("machine")), (&json!(0), None));
}

#[test]
fn what_a_user_may_do_wrong_is_a_reason() {
    for wrong in [
        json!({"machine": "nosuch"}),
        json!({"machine_text": "schema = 9"}),
        json!({"zero": "Q5"}),
        json!({"dialect": "klingon"}),
    ] {
        let failed = Ready::new(&options(&wrong), b"G0 X1\n").unwrap_err();
        assert!(!failed.why.is_empty(), "{wrong}");
    }
    let refused = Ready::new(&options(&json!({})), b"G2 X1 R0.1\n").unwrap_err();
    assert_eq!(refused.findings[0]["severity"], "error");
}

#[test]
fn a_run_answers_with_its_units() {
    let program = b"G21 G90 F1.2\nG1 X2\nG1 X0\nM2\n";
    let mut ready = Ready::new(&options(&json!({"machine": "micromill"})), program).unwrap();
    let simulated = ready.simulate(None).unwrap();
    let run = value(&ready.answer(&simulated, json!({"run": 7})).unwrap());
    assert_eq!((&run["axes"], &run["run"]), (&json!("XYZ"), &json!(7)));
    assert_eq!(run["nm_per_step"], json!([140.0, 140.0, 140.0]));
    assert_eq!(run["end_nm"][0], 0);
    assert_eq!(run["reversals"][0], 1);
}

#[test]
fn every_machine_has_a_text_that_is_the_same_machine() {
    let all = value(&machines().unwrap());
    for machine in all["machines"].as_array().unwrap() {
        let name = machine["name"].as_str().unwrap();
        let text = value(&machine_text(name).unwrap())["text"].clone();
        let own = value(&super::machine(&options(&json!({"machine_text": text}))).unwrap());
        assert_eq!((&own["axes"], &own["text"]), (&machine["axes"], &text));
    }
    assert!(machine_text("nosuch").is_err());
}
