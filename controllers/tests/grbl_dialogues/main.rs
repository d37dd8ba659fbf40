//! Recorded dialogues of Grbl 1.1h, played against the controller in simulated time.
//!
//! `HUSILLO_GRBL_DIALOGUE=door` plays the dialogues whose name begins so, and prints what the
//! controller did.

mod compare;
mod hal;
mod player;

use player::Player;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn records(path: &Path) -> Vec<Value> {
    let text = fs::read_to_string(path).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

/// Plays all dialogues of a class. Returns the names of those that differ.
fn play(class: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/grbl");
    let only = std::env::var("HUSILLO_GRBL_DIALOGUE").ok();
    let mut paths: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    let (mut count, mut failed) = (0, Vec::new());
    for path in paths {
        let records = records(&path);
        let name = records[0]["dialogue"].as_str().unwrap().to_owned();
        let is_asked = only.as_ref().is_none_or(|only| name.starts_with(only));
        if records[0]["class"] != class || !is_asked {
            continue;
        }
        count += 1;
        let played = Player::play(&records);
        if only.is_some() {
            for (at, deed) in &played.deeds {
                println!("{:10.3} {deed:?}", *at as f64 / 1000.0);
            }
        }
        let differences = match class {
            "grblHAL" => hal::differences(&records, &played),
            _ => compare::differences(&records, &played),
        };
        let verdict = if differences.is_empty() {
            "pass"
        } else {
            "FAIL"
        };
        println!("{class} {name}: {verdict}");
        for difference in &differences {
            println!("    {difference}");
        }
        if !differences.is_empty() {
            failed.push(name);
        }
    }
    println!("{class}: {} of {count} pass", count - failed.len());
    failed
}

/// `docs/grbl.md` has the reason of each difference.
#[test]
fn core_dialogues_agree() {
    assert_eq!(play("core"), ["probe_ok", "probe_units", "settings_valid"]);
}

#[test]
fn timing_dialogues_agree() {
    let different = [
        "timing_arc",
        "timing_junction_dev",
        "timing_reverse",
        "timing_slow",
        "timing_square",
        "timing_triangle",
    ];
    assert_eq!(play("timing"), different);
}

#[test]
fn quirks_are_those_of_the_list() {
    let different = [
        "quirk_early_reset",
        "quirk_home_suffix",
        "quirk_reset_after_stop",
        "startup_line_number",
    ];
    assert_eq!(play("quirk"), different);
}

#[test]
fn accidents_of_the_chip_are_those_of_the_list() {
    assert_eq!(play("hardware"), ["eeprom_rx_loss", "rx_overflow"]);
}

/// The protocol of grblHAL.
#[test]
fn dialogues_of_grblhal_agree() {
    assert_eq!(play("grblHAL"), [""; 0]);
}
