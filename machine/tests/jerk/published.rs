//! Cases in which other controllers exceed their limits, as their users have published them.

use husillo_machine::{PathRamp, SmoothRamp};
use husillo_planner::Ramp;

use crate::machines::{Facts, Run, STEP, TIMER_HZ, facts, run};

/// Largest ratio of the acceleration of an axis to its limit (mm/s^2), of means over 2 ms, beyond
/// the error of the positions.
fn axis_acceleration(run: &Run, limit: f64) -> f64 {
    let span = 0.002;
    let samples = (run.checker.seconds() / span * 4.0) as usize;
    let mut largest = 0.0_f64;
    for sample in 0..samples {
        let time = sample as f64 * span / 4.0;
        let [a, b, c] = [0.0, 1.0, 2.0].map(|part| run.checker.axes_at(time + part * span));
        for axis in 0..3 {
            // Positions are a step off at most.
            let second = (c[axis] - 2.0 * b[axis] + a[axis]).abs() - 4.0 * STEP;
            largest = largest.max(second / (limit * 1e6 * span * span));
        }
    }
    largest
}

/// Short arcs of about 4 mm, each of which continues the direction of the one before it.
fn chain_of_arcs(tolerance: &str, feed: u32) -> Vec<String> {
    let mut lines = vec![format!("G64 P{tolerance}"), format!("G1 X1 F{feed}")];
    let (mut x, mut y, mut angle) = (1.0_f64, 0.0_f64, 0.0_f64);
    for number in 0..24 {
        let radius = 4.0 + 0.4 * f64::from(number % 5 - 2);
        let (sin, cos) = angle.sin_cos();
        let centre = [x - radius * sin, y + radius * cos];
        angle += 0.15 + 0.1 * f64::from(number % 3);
        let (sin, cos) = angle.sin_cos();
        let [i, j] = [centre[0] - x, centre[1] - y];
        [x, y] = [centre[0] + radius * sin, centre[1] - radius * cos];
        lines.push(format!("G3 X{x:.5} Y{y:.5} I{i:.5} J{j:.5}"));
    }
    lines
}

fn of<R: PathRamp>(facts: Facts, lines: &[String]) -> Run {
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    run::<128, R>([facts; 3], &lines, &[])
}

/// LinuxCNC 2.10, issue 3773: arcs of about 4 mm at 1750 mm/s^2. There the acceleration is 1.9
/// times the limit with G64 P0.01, and 8.1 times with P0.1. Its program is not in the report; this
/// one has arcs of the same size.
#[test]
fn small_arcs_keep_the_acceleration_of_the_axes() {
    for tolerance in ["0.01", "0.05", "0.1"] {
        for feed in [3_000, 6_000] {
            let lines = chain_of_arcs(tolerance, feed);
            let with_jerk = facts(1750, 100);
            let smooth = of::<SmoothRamp>(with_jerk, &lines);
            smooth.checker.check(f64::from(feed) / 60.0 * 1e6);
            let plain = of::<Ramp>(
                Facts {
                    jerk: None,
                    ..with_jerk
                },
                &lines,
            );
            let ratios = [&smooth, &plain].map(|run| axis_acceleration(run, 1750.0));
            println!("P{tolerance} F{feed}: {ratios:?}");
            assert!(ratios.iter().all(|ratio| *ratio <= 1.0), "{ratios:?}");
        }
    }
}

/// LinuxCNC, issue 4194: a smooth contour of short lines at 1000 mm/s^2 and 10 m/s^3. There the
/// speed oscillates, and a second run of the same program is rougher than the first.
#[test]
fn a_contour_of_short_lines_is_even_in_every_run() {
    let mut lines = vec!["G64 P0.02".to_owned(), "G1 X10 Y0 F3000".to_owned()];
    let circle = |lines: &mut Vec<String>| {
        for chord in 1..=600 {
            let (sin, cos) = (f64::from(chord) * std::f64::consts::TAU / 600.0).sin_cos();
            lines.push(format!("G1 X{:.4} Y{:.4}", 10.0 * cos, 10.0 * sin));
        }
        lines.push("G4 P0.1".to_owned());
    };
    circle(&mut lines);
    circle(&mut lines);
    let run = of::<SmoothRamp>(facts(1000, 10), &lines);
    run.checker.check(50e6);
    // Each circle is 62.83 mm long. A ramp takes v^2 / 2 a + v T / 2 = 3.6 mm.
    for circle in [0.0, 1.0] {
        let start = 10e6 + circle * 62.83e6;
        let [from, to] = [start + 5e6, start + 57e6].map(|place| run.checker.time_of(place));
        for sample in 0..100 {
            let time = from + (to - from - 0.01) * f64::from(sample) / 100.0;
            let way = run.checker.place_at(time + 0.01) - run.checker.place_at(time);
            assert!((way - 0.5e6).abs() < 200.0, "{circle} {time}: {way}");
        }
    }
}

/// grblHAL, issue 913: 1000 mm/s^2 to 5000 mm/min at 100 steps per mm. There the speed jumps by 10
/// mm/s every 10 ms.
#[test]
fn the_speed_changes_with_every_step() {
    let lines = ["G1 X60 F5000".to_owned()];
    for limits in [facts(1000, 50), facts(1000, 500)] {
        let run = of::<SmoothRamp>(limits, &lines);
        // 200 of the fine steps of this machine are one of the report.
        let times: Vec<f64> = run.checker.times().step_by(200).collect();
        let intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        for pair in intervals.windows(2) {
            let change = (10_000.0 / pair[1] - 10_000.0 / pair[0]).abs();
            let most = 1e9 * (pair[0] + pair[1]) / 2.0;
            // The time of a step is a tick off at most.
            let tick = 10_000.0 / pair[0].min(pair[1]).powi(2) * 2.0 / f64::from(TIMER_HZ);
            assert!(change <= most + tick, "{change} nm/s of {most}");
        }
    }
}

/// Marlin, issue 12491: an axis that turns round at 100 mm/s^2 jumps from -2700 to 250 steps/s
/// (80 per mm) there. Here it stops in between.
#[test]
fn a_reversal_is_a_stop() {
    let lines = ["G1 X-20 F6000", "G1 X20"].map(str::to_owned);
    let run = of::<SmoothRamp>(facts(100, 2), &lines);
    run.checker.check(100e6);
    let turn = run.checker.times().zip(&run.steps);
    let turn = turn.clone().zip(turn.skip(1));
    let around = turn.filter(|((_, (before, _)), (_, (after, _)))| before[0] != after[0]);
    let intervals: Vec<f64> = around
        .map(|((before, _), (after, _))| after - before)
        .collect();
    // From rest, the first 50 nm take (6 ds / j)^(1/3) = 5.3 ms.
    assert!(
        matches!(intervals[..], [interval] if interval > 0.005),
        "{intervals:?}"
    );
}
