//! Compares drill files of real layout programs with the holes that independent readers agree on.
//!
//! The files are not part of this repository. `HUSILLO_EXCELLON` names their folder (with
//! `expected/`). Without it the test tries `../shared/excellon` next to the workspace. Without that
//! folder the test passes with a message.

use husillo_excellon::{Feature, Inference, Overrides, Reader, lines};
use std::fs;
use std::path::{Path, PathBuf};

/// Agreement of the readers in nm. They print micrometres.
const TOLERANCE_NM: f64 = 4_000.0;

fn corpus() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/excellon");
    let folder = std::env::var_os("HUSILLO_EXCELLON").map_or(beside, PathBuf::from);
    let found = folder.join("expected").is_dir();
    if !found {
        println!(
            "no drill files in {}: set HUSILLO_EXCELLON to run this test",
            folder.display()
        );
    }
    found.then_some(folder)
}

/// Holes as x, y, diameter in nm, and the number of slots.
fn read(text: &[u8]) -> (Vec<[f64; 3]>, usize) {
    let mut inference = Inference::new();
    for (_, line) in lines(text) {
        inference.observe(line);
    }
    let settings = inference.settle(&Overrides::default());
    let mut reader = Reader::<64>::new(&settings);
    let (mut holes, mut slots) = (Vec::new(), 0);
    for (number, line) in lines(text) {
        let features = reader
            .read(line)
            .unwrap_or_else(|error| panic!("line {number}: {error}, {settings:?}"));
        if let Some(warning) = reader.warning() {
            println!("line {number}: {warning}");
        }
        for feature in features {
            match feature {
                Feature::Hole(hole) => {
                    let diameter = hole.tool.diameter_nm.expect("a diameter");
                    holes.push([hole.at_nm[0], hole.at_nm[1], diameter].map(|nm| nm as f64));
                }
                Feature::Slot(_) => slots += 1,
            }
        }
    }
    (holes, slots)
}

/// Parses `"holes": [[x, y, diameter], ...]` from mm to nm, and the number after `"slots": `.
fn expected(json: &str) -> (Vec<[f64; 3]>, usize) {
    let (_, behind) = json.split_once("\"holes\": [").expect("holes");
    let (list, rest) = behind.split_once("]]").unwrap_or(("", behind));
    let holes = list
        .split('[')
        .filter(|triple| !triple.is_empty())
        .map(|triple| {
            let mut numbers = triple.split([',', ']', ' ']).filter(|n| !n.is_empty());
            [0; 3].map(|_| {
                let number = numbers.next().expect("three numbers");
                number.parse::<f64>().expect("a number") * 1e6
            })
        })
        .collect();
    let (_, slots) = rest.split_once("\"slots\": ").expect("slots");
    let slots = slots.trim_end_matches(|c: char| !c.is_ascii_digit());
    (holes, slots.parse().expect("a number of slots"))
}

#[test]
fn every_hole_is_where_other_readers_see_it() {
    let Some(folder) = corpus() else { return };
    let (mut files, mut count, mut worst) = (0, 0, 0.0_f64);
    let mut entries: Vec<_> = fs::read_dir(folder.join("expected"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    entries.sort();
    for path in entries {
        let name = path.file_stem().expect("a name").to_string_lossy();
        println!("{name}");
        let text = fs::read(folder.join(&*name)).expect("the drill file");
        let (holes, slots) = read(&text);
        let (expected, expected_slots) = expected(&fs::read_to_string(&path).expect("its holes"));
        assert_eq!(holes.len(), expected.len(), "{name}");
        assert_eq!(slots, expected_slots, "{name}");
        for (hole, expected) in holes.iter().zip(&expected) {
            for (found, wanted) in hole.iter().zip(expected) {
                worst = worst.max((found - wanted).abs());
                assert!(
                    (found - wanted).abs() <= TOLERANCE_NM,
                    "{name}: {hole:?} for {expected:?}"
                );
            }
        }
        files += 1;
        count += holes.len();
    }
    println!("{files} files, {count} holes, worst difference {worst:.0} nm");
    assert!(files >= 21 && count >= 5932, "{files} files, {count} holes");
}
