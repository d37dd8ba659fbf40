//! Properties of every Bezier curve.

use husillo_interp::{Bezier, BezierError, Interpolator, Line, Step};
use proptest::prelude::*;

/// The curve in floating point, in BLU.
fn at<const N: usize>(control: &[[f64; N]; 4], u: f64) -> [f64; N] {
    let v = 1.0 - u;
    let weights = [v * v * v, 3.0 * u * v * v, 3.0 * u * u * v, u * u * u];
    core::array::from_fn(|axis| {
        weights
            .iter()
            .zip(control)
            .map(|(weight, point)| weight * point[axis])
            .sum()
    })
}

/// Points close together along the curve (at most 1/50 BLU), each with its distance along the
/// curve.
fn trace<const N: usize>(control: &[[f64; N]; 4]) -> Vec<([f64; N], f64)> {
    let longest: f64 = control.windows(2).map(|leg| length(&leg[0], &leg[1])).sum();
    let pieces = (longest * 150.0) as u32 + 1000;
    let mut way = 0.0;
    let mut before = control[0];
    (0..=pieces)
        .map(|k| {
            let place = at(control, f64::from(k) / f64::from(pieces));
            way += length(&before, &place);
            before = place;
            (place, way)
        })
        .collect()
}

fn length<const N: usize>(from: &[f64; N], to: &[f64; N]) -> f64 {
    from.iter()
        .zip(to)
        .map(|(from, to)| (to - from).powi(2))
        .sum::<f64>()
        .sqrt()
}

fn farthest<const N: usize>(point: &[f64; N], other: &[f64; N]) -> f64 {
    point
        .iter()
        .zip(other)
        .map(|(one, other)| (one - other).abs())
        .fold(0.0, f64::max)
}

/// Checks the properties of any curve and returns its events.
fn check<const N: usize>(
    curve: &Bezier<N>,
    control: [[i64; N]; 4],
    bits: u8,
) -> Result<Vec<Step>, TestCaseError> {
    let steps: Vec<Step> = curve.clone().collect();
    // The counts and sums of the dry pass are those of the walk. Every event moves and takes time.
    prop_assert_eq!(steps.len(), curve.events() as usize);
    let sum = steps.iter().map(|step| u64::from(step.sweep)).sum::<u64>();
    prop_assert_eq!(sum, curve.total_sweep());
    let largest = steps.iter().map(|step| step.sweep).max().unwrap_or(0);
    prop_assert_eq!(largest, curve.largest_sweep());
    prop_assert!(
        steps
            .iter()
            .all(|step| step.axes != 0 && step.sweep >= curve.unit() / 16)
    );
    prop_assert!(steps.iter().all(|step| step.negative & !step.axes == 0));

    // The curve ends on the lattice point nearest to its end.
    let one = f64::from(1_u32 << bits);
    let round = |at: i64| (at as f64 / one + 0.5).floor();
    let mut place = control[0].map(round);
    let mut places = vec![place];
    for step in &steps {
        for (axis, place) in place.iter_mut().enumerate() {
            *place += f64::from(step.delta(axis));
        }
        places.push(place);
    }
    prop_assert_eq!(place, control[3].map(round));

    // Every point is within half a step per axis of the curve, in the order of the curve. The curve
    // is never farther than a stride and a half from the points.
    let control = control.map(|point| point.map(|at| at as f64 / one));
    let trace = trace(&control);
    let mut found = 0;
    let mut phase = 0.0_f64;
    let mut swept = 0.0;
    let mut turned = 0.0;
    for (place, step) in places.iter().skip(1).zip(&steps) {
        // The first point of the curve that rounds to the point.
        let Some(further) = trace[found..]
            .iter()
            .position(|(at, _)| farthest(at, place) <= 0.512)
        else {
            return Err(TestCaseError::fail(format!(
                "{place:?} is beside the curve"
            )));
        };
        found += further;
        swept += f64::from(step.sweep) / f64::from(curve.unit());
        phase = phase.max((swept - trace[found].1).abs());
        turned += 0.001;
    }
    let (_, length) = trace[trace.len() - 1];
    // Sweep is distance along the curve, except for rounding and turning.
    let bound = (N as f64).sqrt() / 2.0 * (2.0 + 9.5) + 0.001 * length * N as f64 + turned;
    prop_assert!(phase <= bound, "{phase} {bound}");
    Ok(steps)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Curves in a plane, of all sizes, with fractions.
    #[test]
    fn plane_curves(
        bits in 0_u8..=8,
        points in prop::array::uniform4(prop::array::uniform2(-200.0_f64..200.0)),
        size in 0.005_f64..1.0,
    ) {
        let scale = f64::from(1_u32 << bits);
        let control = points.map(|point| point.map(|at| (at * size * scale) as i64));
        let curve = Bezier::cubic(control, bits).unwrap();
        check(&curve, control, bits)?;
    }

    /// Curves in space.
    #[test]
    fn space_curves(points in prop::array::uniform4(prop::array::uniform3(-100_i64..100))) {
        check(&Bezier::cubic(points, 0).unwrap(), points, 0)?;
    }

    /// Curves on a coarse lattice: control points often coincide, lie on a line or fold back.
    #[test]
    fn degenerate_curves(
        points in prop::array::uniform4(prop::array::uniform2(-2_i64..=2)),
        scale in 1_i64..60,
    ) {
        let control = points.map(|point| point.map(|at| at * scale));
        check(&Bezier::cubic(control, 0).unwrap(), control, 0)?;
    }

    /// A quadratic curve is the cubic with control points at two thirds; exact here with multiples
    /// of three.
    #[test]
    fn a_quadratic_is_its_cubic(
        points in prop::array::uniform3(prop::array::uniform2(-60_i64..60)),
    ) {
        let [a, b, c] = points.map(|point| point.map(|at| at * 3));
        let third = |from: [i64; 2], to: [i64; 2]| {
            [0, 1].map(|axis| (from[axis] + 2 * to[axis]) / 3)
        };
        let control = [a, third(a, b), third(c, b), c];
        let quadratic = Bezier::quadratic([a, b, c], 0).unwrap();
        check(&quadratic, control, 0)?;
    }

    /// The control polygon bounds the events: at most 6 times its longest leg in an axis.
    #[test]
    fn events_are_bounded(points in prop::array::uniform4(prop::array::uniform2(-5000_i64..5000))) {
        let curve = Bezier::cubic(points, 0).unwrap();
        let leg = points.windows(2)
            .flat_map(|leg| [0, 1].map(|axis| (leg[1][axis] - leg[0][axis]).unsigned_abs()))
            .max().unwrap_or(0);
        prop_assert!(u64::from(curve.events()) <= 6 * leg + 1);
    }
}

/// Evenly spaced control points on a straight line give the steps of a line, each with its length.
#[test]
fn a_straight_curve_is_a_line() {
    let curve = Bezier::cubic([[0, 0], [100, 0], [200, 0], [300, 0]], 0).unwrap();
    let unit = curve.unit();
    assert_eq!(curve.total_sweep(), 300 * u64::from(unit));
    let axes: Vec<(u8, u8)> = curve.map(|step| (step.axes, step.negative)).collect();
    let line: Vec<(u8, u8)> = Line::new([300, 0])
        .map(|step| (step.axes, step.negative))
        .collect();
    assert_eq!(axes, line);
}

/// The largest curve: four million steps across, within 64 bits.
#[test]
fn the_largest_curve_ends() {
    let far = (1_i64 << 22) - 1;
    let curve = Bezier::cubic([[0], [far], [0], [far]], 0).unwrap();
    let end: i64 = curve.map(|step| i64::from(step.delta(0))).sum();
    assert_eq!(end, far);
}

/// The S curve of the literature, on which even speed is difficult: time and distance never differ
/// by more than rounding.
#[test]
fn speed_is_constant_on_an_s() {
    let control = [[0, 0], [900, 0], [-600, 400], [300, 400]];
    let curve = Bezier::cubic(control, 0).unwrap();
    let trace = trace(&control.map(|point| point.map(|at| at as f64)));
    let (mut place, mut swept, mut found) = ([0.0; 2], 0.0, 0);
    for step in curve.clone() {
        for (axis, place) in place.iter_mut().enumerate() {
            *place += f64::from(step.delta(axis));
        }
        swept += f64::from(step.sweep) / f64::from(curve.unit());
        found += trace[found..]
            .iter()
            .position(|(at, _)| farthest(at, &place) <= 0.51)
            .unwrap();
        assert!(
            (swept - trace[found].1).abs() < 2.0,
            "{swept} {:?}",
            trace[found]
        );
    }
    let (_, length) = trace[trace.len() - 1];
    assert!((swept / length - 1.0).abs() < 0.002, "{swept} {length}");
}

/// A curve without motion has no event; a curve that does not fit is refused.
#[test]
fn points_and_giants() {
    assert_eq!(Bezier::cubic([[5, -7]; 4], 3).unwrap().count(), 0);
    let refused = |control, bits| Bezier::<2>::cubic(control, bits).err();
    let far = [1 << 22, 0];
    assert_eq!(
        refused([[0; 2], far, [0; 2], [0; 2]], 0),
        Some(BezierError::TooLarge)
    );
    assert_eq!(
        refused([[i64::MAX, 0], [0; 2], [0; 2], [0; 2]], 0),
        Some(BezierError::TooLarge)
    );
    assert_eq!(refused([[0; 2]; 4], 21), Some(BezierError::FractionBits));
    assert_eq!(Bezier::cubic([[0; 9]; 4], 0).err(), Some(BezierError::Axes));
}
