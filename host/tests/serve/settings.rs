//! The settings of the controller.

use super::page::Served;
use serde_json::{Value, json};

fn value(settings: &Value, number: u64) -> Value {
    let list = settings["settings"].as_array().unwrap();
    let found = list.iter().find(|one| one["number"] == number);
    found.unwrap_or_else(|| panic!("no ${number}"))["value"].clone()
}

#[test]
fn settings_are_shown_compared_and_saved() {
    let served = Served::new(&[]);
    let mut page = served.operator();
    let settings = page.done(json!({"do": "settings"}));
    assert_eq!(value(&settings, 110), "6000.000");
    let one = &settings["settings"][0];
    assert_eq!(
        (&one["name"], &one["unit"]),
        (&json!("Step pulse"), &json!("us"))
    );
    let values = json!({"110": "5000", "111": "6000", "0": "2", "999": "1"});
    let diff = page.done(json!({"do": "settings_diff", "values": values}));
    let changes = diff["changes"].as_array().unwrap();
    assert_eq!(changes.len(), 1);
    assert_eq!(changes[0]["from"], "6000.000");
    assert_eq!(changes[0]["to"], "5000");
    assert_eq!(diff["refused"].as_array().unwrap().len(), 2);
    // With a refused one nothing is written.
    page.refused(json!({"do": "settings_save", "values": values}));
    let settings = page.done(json!({"do": "settings"}));
    assert_eq!(value(&settings, 110), "6000.000");
    let values = json!({"110": "5000", "111": "6000"});
    let settings = page.done(json!({"do": "settings_save", "values": values}));
    assert_eq!(value(&settings, 110), "5000.000");
    page.until("the line", |page| page.has_line("$110=5000").then_some(()));
    let mut sent = page.lines.iter().filter(|line| line["from"] == "host");
    assert!(!sent.any(|line| line["text"] == "$111=6000"));
}
