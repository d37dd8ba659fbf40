//! The measured tables of the originals, as a user rebuilds them.

mod common;

use common::husillo;
use predicates::prelude::PredicateBooleanExt;
use predicates::str::contains;
use serde_json::Value;
use std::sync::LazyLock;

/// The tables that a command prints as JSON.
fn tables(args: &[&str]) -> Vec<Value> {
    let args = [&["reproduce"], args, &["--format", "json"]].concat();
    let output = husillo().args(args).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let rebuilt: Value = serde_json::from_slice(&output.stdout).unwrap();
    rebuilt["tables"].as_array().unwrap().clone()
}

/// A table of the micro mill or the microfactory. All of a machine are rebuilt once.
fn table(machine: &str, number: &str) -> &'static Value {
    static MICROMILL: LazyLock<Vec<Value>> = LazyLock::new(|| tables(&["micromill"]));
    static MICROFACTORY: LazyLock<Vec<Value>> = LazyLock::new(|| tables(&["microfactory"]));
    let tables = match machine {
        "micromill" => &*MICROMILL,
        _ => &*MICROFACTORY,
    };
    let found = tables.iter().find(|table| table["number"] == number);
    found.unwrap_or_else(|| panic!("no table {number}"))
}

fn rows(table: &Value) -> &[Value] {
    table["rows"].as_array().unwrap()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"))
}

/// Names of the rows whose rebuilt value is not within the spread.
fn outside(table: &Value) -> Vec<&str> {
    let is_outside = |row: &&Value| {
        row["rebuilt"].as_f64().is_some_and(|rebuilt| {
            (number(row, "measured") - rebuilt).abs() > number(row, "spread")
        })
    };
    let outside = rows(table).iter().filter(is_outside);
    outside.map(|row| row["name"].as_str().unwrap()).collect()
}

fn row<'a>(table: &'a Value, name: &str) -> &'a Value {
    let found = rows(table).iter().find(|row| row["name"] == name);
    found.unwrap_or_else(|| panic!("no row {name}"))
}

#[test]
fn lines_and_squares_of_the_mill_are_within_their_spread() {
    let [lines, squares] = ["13", "14"].map(|number| table("micromill", number));
    assert_eq!([rows(lines).len(), rows(squares).len()], [12, 12]);
    for table in [lines, squares] {
        assert_eq!(outside(table), [""; 0]);
        for row in rows(table) {
            // With the map of today and the true step.
            let most = if row["unit"] == "mm" { 0.001 } else { 1.0 };
            let off = number(row, "today") - number(row, "programmed");
            assert!(off.abs() < most, "{row}");
        }
    }
    let size = number(row(squares, "X: Dy"), "rebuilt");
    assert!(
        size > 2.5,
        "too much take-up makes the square larger: {size}"
    );
}

#[test]
fn circles_of_the_mill_are_within_their_spread_but_for_one_value() {
    let table = table("micromill", "15");
    assert_eq!(rows(table).len(), 45);
    assert_eq!(outside(table), ["c: sigma"]);
    for row in rows(table) {
        let name = row["name"].as_str().unwrap();
        let [measured, rebuilt] = ["measured", "rebuilt"].map(|key| number(row, key));
        if name.contains(": D") {
            assert!((measured - rebuilt).abs() < 0.020, "{row}");
        }
        // With the map no play is left, and with the true step no scale. The squareness remains.
        if ["Ei", "Ed", "Ps", "Pi"]
            .iter()
            .any(|end| name.contains(end))
        {
            assert!(number(row, "today").abs() < 1.5, "{row}");
        }
        if name.ends_with("mean") {
            let off = number(row, "today") - number(row, "programmed");
            assert!(off.abs() < 0.001, "{row}");
        }
    }
}

/// Head and logo: each size and each play within its spread, each width within 2 um of what its own
/// play makes of it.
#[test]
fn parts_of_the_mill_are_within_their_spread() {
    for table_number in ["16", "17", "18", "19", "20"] {
        let table = table("micromill", table_number);
        assert_eq!(outside(table), [""; 0], "table {table_number}");
        for row in rows(table) {
            let name = row["name"].as_str().unwrap();
            let off = number(row, "measured") - number(row, "rebuilt");
            if name.starts_with("width") {
                assert!(off.abs() < 2.0, "{row}");
            }
            if name.starts_with("size") {
                let today = number(row, "today") - number(row, "programmed");
                assert!(today.abs() < 0.002, "{row}");
            }
        }
    }
}

/// The interpolators, walked here, get the marks of the original; its misprints are outside.
#[test]
fn choices_of_the_mill_follow_its_rules() {
    let [counts, marks, sequences, chips] = ["7", "9", "10", "12"].map(|it| table("micromill", it));
    assert_eq!(outside(counts), [""; 0]);
    assert_eq!(outside(marks), [""; 0]);
    assert_eq!(outside(sequences), ["quarter step"]);
    assert_eq!(outside(chips), ["PBL3717A"]);
    assert_eq!(outside(table("micromill", "supply")), [""; 0]);
    assert_eq!(number(row(sequences, "quarter step"), "rebuilt"), 6.0);
    assert_eq!(number(row(chips, "PBL3717A"), "rebuilt"), 98.0);
    let points =
        ["staircase", "DDA", "direct search"].map(|name| number(row(marks, name), "rebuilt"));
    assert!(points.is_sorted(), "{points:?}");
}

/// The currents of the microfactory: 3 % of all and 8 % of each; the outliers are named.
#[test]
fn currents_of_the_microfactory_are_within_three_percent() {
    let table = table("microfactory", "4.3");
    assert_eq!(rows(table).len(), 30);
    let off = rows(table).iter();
    let off = off.map(|row| number(row, "rebuilt") / number(row, "measured") - 1.0);
    let off: Vec<f64> = off.collect();
    let squares: f64 = off.iter().map(|off| off * off).sum();
    assert!((squares / 30.0).sqrt() < 0.03);
    assert!(off.iter().all(|off| off.abs() < 0.08), "{off:?}");
    let notes = table["notes"][0].as_str().unwrap();
    assert!(notes.contains("CLOCK 42.8 Hz +6.5 %"), "{notes}");
}

/// Every slope is exact today; the original's rates for the ratio 4 contradict its own rule.
#[test]
fn ratios_of_the_microfactory_are_exact_today() {
    let table = table("microfactory", "4.1");
    assert_eq!(outside(table), ["ratio 4: X per Z"]);
    for ratio in 2..=4 {
        let row = row(table, &format!("ratio {ratio}: X per Z"));
        assert!(
            (number(row, "today") - f64::from(ratio)).abs() < 1e-9,
            "{row}"
        );
    }
}

/// Temperatures and consumption follow as far as there is a model; the rest is data.
#[test]
fn what_has_no_model_is_data() {
    let [heat, systems, consumption] =
        ["4.2", "4.4", "4.5"].map(|number| table("microfactory", number));
    assert_eq!(
        outside(heat),
        ["shaft at 5 min", "shaft at 10 min", "shaft at 40 min"]
    );
    assert_eq!(outside(systems), [""; 0]);
    assert_eq!(outside(consumption), [""; 0]);
    let data = |table: &Value| {
        let data = rows(table).iter().filter(|row| row["rebuilt"].is_null());
        data.count()
    };
    assert_eq!([heat, systems, consumption].map(data), [4, 8, 5]);
}

#[test]
fn the_measuring_machine_repeats_within_a_count() {
    let tables = tables(&["cmm"]);
    assert_eq!(outside(&tables[0]), [""; 0]);
    for row in rows(&tables[0]) {
        assert!(number(row, "today") <= 1.0, "{row}");
    }
}

#[test]
fn holes_of_the_drill_are_within_a_thousandth_of_an_inch() {
    let tables = tables(&["drill", "holes"]);
    let holes = rows(&tables[0]).iter().filter(|row| row["unit"] == "um");
    assert_eq!(holes.count(), 32);
    assert_eq!(
        outside(&tables[0]),
        ["off a closed switch, 42E hex steps", "Z down and up, 35 mm"]
    );
}

/// A page is one file with pictures; the listing says what it is about.
#[test]
fn a_page_has_pictures_and_needs_nothing_else() {
    let folder = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let page = folder.join("circles.html");
    husillo()
        .args(["reproduce", "micromill", "15", "-o", page.to_str().unwrap()])
        .assert()
        .success()
        .stderr(contains("1 table, 44 of 45"));
    let page = std::fs::read_to_string(page).unwrap();
    // The three circles, and what the rows leave.
    assert_eq!(page.matches("<svg").count(), 4);
    assert_eq!(page.matches("class=\"measured\"").count(), 3 * 16 + 45);
    assert!(!page.contains("http") && !page.contains("NaN"));
    husillo()
        .args(["reproduce", "micromill", "15"])
        .assert()
        .success()
        .stdout(contains("true step: 139.51 nm").and(contains("Outside (*): c: sigma")));
}

#[test]
fn an_unknown_table_is_refused() {
    husillo()
        .args(["reproduce", "micromill", "99"])
        .assert()
        .code(2)
        .stderr(contains("no table `99`: there are 7, 9"));
}
