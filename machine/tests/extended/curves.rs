//! G5 and G5.1.

use husillo_machine::gcode::{Command, Nm};
use husillo_machine::{Event, MoveError, Origin, Refused, Scale};
use proptest::prelude::*;

use crate::{ExtendedMachine, config, run};

type Point = [f64; 2];

/// A chord is a quarter of a step off, its ends are rounded, and a line is half a step off.
const BOUND: f64 = 0.25 + 0.708 + 0.5;

fn at(points: [Point; 4], u: f64) -> Point {
    [0, 1].map(|axis| {
        let [a, b, c, d] = points.map(|point| point[axis]);
        let v = 1.0 - u;
        v * v * v * a + 3.0 * v * v * u * b + 3.0 * v * u * u * c + u * u * u * d
    })
}

/// Distance of a point from the curve, by brute force near `u`.
fn distance(points: [Point; 4], point: Point, u: &mut f64) -> f64 {
    let off = |u: f64| {
        let [x, y] = at(points, u);
        (x - point[0]).hypot(y - point[1])
    };
    let mut step = 0.02;
    while step > 1e-8 {
        let mut best = (off(*u), *u);
        for place in -4_i32..=4 {
            let v = (*u + f64::from(place) * step).clamp(0.0, 1.0);
            if off(v) < best.0 {
                best = (off(v), v);
            }
        }
        if best.1 == *u {
            step /= 2.0;
        }
        *u = best.1;
    }
    off(*u)
}

/// The same, from everywhere where the search along the curve has failed.
fn nearest(points: [Point; 4], point: Point, u: &mut f64) -> f64 {
    let found = distance(points, point, u);
    if found < 2e-3 {
        return found;
    }
    let far = |part: i32| distance(points, point, &mut (f64::from(part) / 200.0));
    (0..=200).map(far).fold(found, f64::min)
}

/// Runs a curve; returns its time in seconds, its largest distance in steps of the coarser axis,
/// and the fastest change of speed of an axis in steps/s.
fn curve(mill: &mut ExtendedMachine, line: &str, points: [Point; 4]) -> (f64, f64) {
    let scales = [0, 1].map(|axis: usize| {
        let scale = mill.config().axes[axis].scale;
        f64::from(scale.nm()) / f64::from(scale.steps()) * 1e-6
    });
    let (mut ticks, mut most, mut u) = (0, 0.0_f64, 0.0);
    run(mill, &[line], |mill, event| {
        let Event::Step(step) = event else { return };
        ticks += u64::from(step.wait_ticks);
        let [x, y, _] = mill.position_steps().map(f64::from);
        most = most.max(nearest(points, [x * scales[0], y * scales[1]], &mut u));
        assert!(matches!(
            mill.executing().map(|segment| segment.command),
            Some(Command::Spline { .. })
        ));
    });
    (ticks as f64 / 8e6, most / scales[0].max(scales[1]))
}

#[test]
fn a_curve_is_followed_within_a_step_at_its_feed() {
    let points = [[10.0, 10.0], [30.0, 50.0], [40.0, 0.0], [60.0, 20.0]];
    for (has_ramps, ratio) in [(false, 1), (true, 1), (false, 3)] {
        let mut config = config(has_ramps);
        config.axes[1].scale = Scale::new(2500, ratio).unwrap();
        config.axes[1].max_rate_hz *= ratio;
        let mut mill = ExtendedMachine::new(config);
        run(&mut mill, &["G0 X10 Y10"], |_, _| ());
        let (seconds, off) = curve(&mut mill, "G5 X60 Y20 I20 J40 P-20 Q-20 F600", points);
        assert!(off < BOUND, "{off} steps");
        let end = [0, 1].map(|axis: usize| mill.position_steps()[axis]);
        assert_eq!(end, [24_000, 8_000 * ratio as i32]);
        let mut length = 0.0;
        for place in 0..10_000 {
            let [a, b] = [place, place + 1].map(|n| at(points, f64::from(n) / 1e4));
            length += (a[0] - b[0]).hypot(a[1] - b[1]);
        }
        let ideal = length / 10.0;
        let most = if has_ramps { 1.03 } else { 1.0005 };
        assert!(
            (0.9995 * ideal..most * ideal).contains(&seconds),
            "{seconds} for {ideal}"
        );
    }
}

#[test]
fn a_quadratic_curve_and_a_smooth_join() {
    let mut mill = ExtendedMachine::new(config(true));
    let quadratic = [
        [0.0, 0.0],
        [20.0 / 3.0, 0.0],
        [10.0, 20.0 / 6.0],
        [10.0, 10.0],
    ];
    let (_, off) = curve(&mut mill, "G5.1 X10 Y10 I10 J0 F1200", quadratic);
    assert!(off < BOUND, "{off} steps");
    // The second curve goes on in the direction of the first one.
    run(
        &mut mill,
        &[
            "G0 X0 Y50",
            "G5 X20 Y50 I5 J10 P-5 Q-10 F1200",
            "G5 X40 Y50 P-5 Q10",
        ],
        |_, _| (),
    );
    assert_eq!(mill.position_steps(), [16_000, 20_000, 0]);
}

/// The time of G93 is that of the whole curve, not of each of its chords.
#[test]
fn inverse_time_counts_once() {
    let points = [[0.0, 0.0], [10.0, 20.0], [20.0, 20.0], [30.0, 0.0]];
    let mut mill = ExtendedMachine::new(config(false));
    let (seconds, _) = curve(&mut mill, "G93 G5 X30 Y0 I10 J20 P-10 Q20 F6", points);
    assert!((seconds - 10.0).abs() < 0.01, "{seconds}");
}

#[test]
fn the_whole_curve_is_within_the_travel() {
    let mut mill = ExtendedMachine::new(config(false));
    run(&mut mill, &["G0 X10 Y0"], |_, _| ());
    // Both ends are inside, and so is the rest at first; the second one dips below Y0.
    mill.line(b"G5 X40 Y0 I10 J20 P-10 Q20 F600").unwrap();
    while mill.next_event().is_some() {}
    let refused = mill.line(b"G5 X10 Y0 I-10 J20 P10 Q-20 F600");
    let Err(Refused::Move(MoveError::Travel { axis: 1, limit, .. })) = refused else {
        panic!("{refused:?}")
    };
    assert_eq!(limit, Nm(0));
    assert_eq!(mill.next_event(), None);
}

/// A quarter circle is a NURBS of order 3 with the weight sqrt(1/2) in its corner.
#[test]
fn a_rational_curve_is_a_circle() {
    let mut mill = ExtendedMachine::new(config(true));
    run(&mut mill, &["G0 X40 Y10"], |_, _| ());
    let lines = ["G5.2 X40 Y40 P0.70710678 L3 F1200", "X10 Y40 P1", "G5.3"];
    let mut most = 0.0_f64;
    run(&mut mill, &lines, |mill, _| {
        let [x, y, _] = mill.position_steps().map(|steps| f64::from(steps) * 2.5e-3);
        most = most.max(((x - 10.0).hypot(y - 10.0) - 30.0).abs() / 2.5e-3);
    });
    assert!(most < BOUND, "{most} steps");
    assert_eq!(mill.position_steps(), [4_000, 16_000, 0]);
}

/// A NURBS of order 4 with equal weights and four points is the cubic curve of G5.
#[test]
fn a_curve_of_four_points_is_that_of_g5() {
    let points = [[10.0, 10.0], [30.0, 50.0], [40.0, 0.0], [60.0, 20.0]];
    let mut mill = ExtendedMachine::new(config(false));
    let lines = [
        "G0 X10 Y10",
        "G5.2 X30 Y50 L4 F600",
        "X40 Y0",
        "X60 Y20",
        "G5.3",
    ];
    let (mut most, mut u) = (0.0_f64, 0.0);
    run(&mut mill, &lines, |mill, event| {
        if matches!(event, Event::Step(_)) && mill.origin() == Origin::Feed {
            let [x, y, _] = mill.position_steps().map(|steps| f64::from(steps) * 2.5e-3);
            most = most.max(nearest(points, [x, y], &mut u) / 2.5e-3);
        }
    });
    assert!(most < BOUND, "{most} steps");
    assert_eq!(mill.position_steps(), [24_000, 8_000, 0]);
}

/// A curve of several spans goes on smoothly, and is checked as a whole before it moves.
#[test]
fn a_curve_of_many_points_is_checked_before_it_moves() {
    let mut mill = ExtendedMachine::new(config(true));
    run(&mut mill, &["G0 X10 Y10"], |_, _| ());
    let mut lines = vec!["G5.2 X20 Y30 L3 F1200".to_string()];
    lines.extend((1..40).map(|n| format!("X{} Y{}", 20 + n, 20 + 10 * (n % 2))));
    lines.push("G5.3".into());
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    run(&mut mill, &lines, |_, _| ());
    assert_eq!(mill.position_steps(), [59 * 400, 30 * 400, 0]);
    // The points below Y0 pull the curve out of the travel: its end is refused, and nothing moves.
    for line in ["G5.2 X70 Y-90 L3 F1200", "X80 Y20"] {
        mill.line(line.as_bytes()).unwrap();
    }
    let refused = mill.line(b"G5.3");
    let Err(Refused::Move(MoveError::Travel { axis: 1, .. })) = refused else {
        panic!("{refused:?}")
    };
    assert_eq!(mill.next_event(), None);
    let mut mill = ExtendedMachine::new(config(true));
    let mut refused = None;
    for line in core::iter::once("G5.2 X60 Y20 L3 F1200").chain(core::iter::repeat_n("X70 Y20", 70))
    {
        refused = mill.line(line.as_bytes()).err();
        if refused.is_some() {
            break;
        }
    }
    assert_eq!(refused, Some(Refused::Move(MoveError::TooManyPoints)));
}

proptest! {
    // Each case searches the nearest point of the curve for thousands of steps.
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Any curve ends exactly, within a step, whatever the modes of the path.
    #[test]
    fn any_curve_is_followed(
        control in prop::collection::vec((100_i32..2000, 100_i32..2000), 4),
        mode in 0_usize..4,
        has_ramps: bool,
    ) {
        let point = |n: usize| [f64::from(control[n].0) / 100.0, f64::from(control[n].1) / 100.0];
        let points = [0, 1, 2, 3].map(point);
        prop_assume!(points[0] != points[1]);
        let mut mill = ExtendedMachine::new(config(has_ramps));
        let [x, y] = points[0];
        let start = format!("G0 X{x} Y{y}");
        let mode = ["G61", "G61.1", "G64", "G64 P0.01"][mode];
        run(&mut mill, &[mode, &start], |_, _| ());
        let (end, word) = (points[3], |a: f64, b: f64| format!("{:.2}", a - b));
        let line = format!(
            "G5 X{} Y{} I{} J{} P{} Q{} F600", end[0], end[1],
            word(points[1][0], x), word(points[1][1], y),
            word(points[2][0], end[0]), word(points[2][1], end[1]),
        );
        let (_, off) = curve(&mut mill, &line, points);
        prop_assert!(off < BOUND, "{} steps", off);
        let [x, y, _] = mill.position_steps();
        prop_assert_eq!([x, y], points[3].map(|mm| (mm * 400.0).round() as i32));
    }
}
