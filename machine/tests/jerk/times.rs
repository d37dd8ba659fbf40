//! How much longer a program takes with limited jerk.

use husillo_planner::Ramp;

use crate::machines::{Facts, facts, run};
use husillo_machine::SmoothRamp;

fn ratio(lines: &[String], acceleration: u32, window_ms: u32) -> f64 {
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let smooth = facts(acceleration, acceleration * 866 / 1000 / window_ms);
    let plain = Facts {
        jerk: None,
        ..smooth
    };
    let [with, without] = [
        run::<64, SmoothRamp>([smooth; 3], &lines, &[]),
        run::<64, Ramp>([plain; 3], &lines, &[]),
    ];
    assert!(with.steps == without.steps);
    with.checker.seconds() / without.checker.seconds()
}

/// A contour of chords and arcs with corners every few millimetres.
fn contour() -> Vec<String> {
    let mut lines = vec!["G1 X0 Y0 F3000".to_owned()];
    for corner in 0..6 {
        let angle = |part: f64| (f64::from(corner) + part) * std::f64::consts::TAU / 6.0;
        for chord in 1..=40 {
            let part = f64::from(chord) / 40.0;
            let radius = 5.0 + (part * std::f64::consts::PI).sin();
            let (sin, cos) = angle(part).sin_cos();
            lines.push(format!("G1 X{:.4} Y{:.4}", radius * cos, radius * sin));
        }
    }
    lines
}

/// With jerk the path has 866 mm/s^2 in every direction. Without jerk it has 1000 to 1414.
#[test]
fn a_contour_takes_little_more() {
    let ratio_10 = ratio(&contour(), 1000, 10);
    let ratio_50 = ratio(&contour(), 1000, 50);
    println!("10 ms: {ratio_10}, 50 ms: {ratio_50}");
    assert!((1.0..1.11).contains(&ratio_10), "{ratio_10}");
    assert!((1.0..1.35).contains(&ratio_50), "{ratio_50}");
}

/// Moves between stops, as between the holes of a board, take the time of the seven phases of
/// limited jerk: 4 (L / 2 j)^(1/3), and up to two slices more.
#[test]
fn short_moves_between_stops_are_optimal() {
    let axes = [facts(1000, 17); 3]; // a window of 51 ms
    for length in [0.02, 0.1, 0.5, 2.0] {
        let mut lines = vec!["G61.1".to_owned(), "G0 X0".to_owned()];
        lines.extend((0..10).map(|number| format!("G0 X{}", f64::from(1 - number % 2) * length)));
        lines.push("G4 P0".to_owned());
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        let run = run::<16, SmoothRamp>(axes, &lines, &[]);
        run.checker.check(101e6);
        let best = 10.0 * 4.0 * (length / 2.0 / 17_000.0_f64).cbrt();
        let ratio = run.checker.seconds() / best;
        assert!((0.99..1.03).contains(&ratio), "{length}: {ratio}");
    }
}
