//! Machines with ramps, and one whose axes follow its spindle.

mod common;

use common::{husillo, json, scratch, written};

fn trace(program: &str, machine: &str) -> Vec<(f64, [f64; 3], String)> {
    let file = scratch(&format!("{machine}.csv"));
    husillo()
        .args(["run", program, "-m", machine, "--format", "json", "--trace"])
        .arg(&file)
        .assert()
        .success();
    let text = std::fs::read_to_string(file).unwrap();
    let rows = text.lines().skip(1).map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |index: usize| fields[index].parse::<f64>().unwrap();
        let at = [number(2), number(3), number(4)];
        (number(1) / 1e6, at, fields[5].to_owned())
    });
    rows.collect()
}

#[test]
fn short_segments_run_without_a_stop() {
    let feed: Vec<_> = trace("../examples/spirograph.nc", "router")
        .into_iter()
        .filter(|(.., kind)| kind == "feed")
        .collect();
    // From half a second after the plunge on: never slower than 1500 mm/min over 20 ms, with 2400
    // programmed.
    let first = feed
        .iter()
        .position(|(_, at, _)| at[2] < -499_000.0)
        .unwrap();
    let (begin, end) = (feed[first].0 + 0.5, feed[feed.len() - 1].0 - 0.5);
    let mut back = 0;
    for (time, at, _) in &feed {
        if *time < begin || *time > end {
            continue;
        }
        while feed[back].0 < time - 0.02 {
            back += 1;
        }
        let way = (at[0] - feed[back].1[0]).hypot(at[1] - feed[back].1[1]);
        let speed = way / (time - feed[back].0) * 60e-6;
        assert!(
            (1500.0..2600.0).contains(&speed),
            "{speed} mm/min at {time} s"
        );
    }
}

#[test]
fn threads_are_where_they_were() {
    let rows = trace("../examples/thread.nc", "lathe");
    // 600 turns per minute of 1.5 mm: Z makes 15 mm/s in every pass, and all passes begin at the
    // same angle.
    let mut starts = Vec::new();
    let mut last_z = 0.0;
    for (time, at, kind) in &rows {
        let is_cut = kind == "feed" && at[2] < 4_999_500.0;
        if is_cut && last_z >= 4_999_500.0 {
            starts.push(*time);
        }
        last_z = at[2];
    }
    assert_eq!(starts.len(), 3);
    for pair in starts.windows(2) {
        let turns = (pair[1] - pair[0]) * 10.0;
        assert!((turns - turns.round()).abs() < 1e-3, "{turns} turns apart");
    }
}

#[test]
fn what_follows_the_end_of_a_program_is_no_part_of_it() {
    let file = written("behind.nc", "G0 X1\nM30\nG0 X5\nthis is text\n");
    let machine = ["run", "-m", "free", "--format", "json"];
    let run = json(&[&machine[..], &[file.to_str().unwrap()]].concat());
    assert_eq!(run["events"], 1000);
}

/// The router has finer steps in Z. Lead-ins in XZ and YZ run as any arc, within half of the longer
/// step of 2.5 um.
#[test]
fn arcs_across_axes_of_different_steps_run() {
    let program = "G21 G90 G17\nG0 X10 Y10 Z5\nG18 G2 X12 Z3 I0 K-2 F600\nG1 X60\n\
                   G3 X62 Z5 I0 K2\nG19 G2 Y12 Z3 J0 K-2 F600\nG3 Y10 Z1 J0 K-2\nG0 Z5\nM2\n";
    let file = written("lead-ins.nc", program);
    let results = json(&[
        "run",
        file.to_str().unwrap(),
        "-m",
        "router",
        "--format",
        "json",
    ]);
    assert_eq!(results["errors"], 0);
    assert!(
        results["max_deviation_nm"].as_f64().unwrap() <= 1250.0,
        "{results}"
    );
    assert_eq!(
        results["end_nm"],
        serde_json::json!([62_000_000, 10_000_000, 5_000_000])
    );
}
