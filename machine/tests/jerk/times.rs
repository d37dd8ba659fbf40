//! How much longer a program takes with limited jerk.

use husillo_planner::Ramp;

use crate::machines::{Facts, facts, run};
use husillo_machine::SmoothRamp;

/// The acceleration that is left is 0.866 of the one without jerk, so both have the same.
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

#[test]
fn a_contour_takes_few_percent_more() {
    let ratio_10 = ratio(&contour(), 1000, 10);
    let ratio_50 = ratio(&contour(), 1000, 50);
    println!("10 ms: {ratio_10}, 50 ms: {ratio_50}");
    assert!((1.0..1.04).contains(&ratio_10), "{ratio_10}");
    assert!((1.0..1.3).contains(&ratio_50), "{ratio_50}");
}
