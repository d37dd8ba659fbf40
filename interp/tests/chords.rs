//! Curves as chords, against the curve in floating point.

use husillo_interp::{Chords, Nurbs, TooManyPoints};
use proptest::prelude::*;

type Point = [f64; 2];

fn mix(a: Point, b: Point, u: f64) -> Point {
    [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * u)
}

/// The point of a Bezier curve of any degree.
fn bezier(points: &[Point], u: f64) -> Point {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points.windows(2).map(|ab| mix(ab[0], ab[1], u)).collect();
    }
    points[0]
}

/// The point of a NURBS with whole knots, the first and the last one as often as the order: the
/// basis functions of Cox and de Boor, by their definition.
fn nurbs(points: &[(Point, f64)], order: usize, u: f64) -> Point {
    let spans = points.len() + 1 - order;
    let knot = |number: usize| (number.saturating_sub(order - 1)).min(spans) as f64;
    fn basis(knot: &dyn Fn(usize) -> f64, number: usize, order: usize, u: f64) -> f64 {
        if order == 1 {
            return f64::from(u8::from(knot(number) <= u && u < knot(number + 1)));
        }
        let share = |part: f64, whole: f64| if whole == 0.0 { 0.0 } else { part / whole };
        let (first, last) = (knot(number), knot(number + order));
        share(u - first, knot(number + order - 1) - first) * basis(knot, number, order - 1, u)
            + share(last - u, last - knot(number + 1)) * basis(knot, number + 1, order - 1, u)
    }
    let (mut sum, mut at) = (0.0, [0.0; 2]);
    for (number, (point, weight)) in points.iter().enumerate() {
        let part = basis(&knot, number, order, u) * weight;
        sum += part;
        at = [0, 1].map(|axis| at[axis] + part * point[axis]);
    }
    at.map(|at| at / sum)
}

fn off(a: Point, b: Point) -> Point {
    [0, 1].map(|axis| (a[axis] - b[axis]).abs())
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Distance of a point from the line between two points.
fn from_line(point: Point, [a, b]: [Point; 2]) -> f64 {
    let (way, off) = (mix(b, a, -1.0), [point[0] - a[0], point[1] - a[1]]);
    let way = [way[0] - b[0], way[1] - b[1]];
    let square = way[0] * way[0] + way[1] * way[1];
    let part = (off[0] * way[0] + off[1] * way[1]) / square.max(1e-9);
    distance(point, mix(a, b, part.clamp(0.0, 1.0)))
}

fn floats(point: [i64; 2]) -> Point {
    point.map(|at| at as f64)
}

fn coordinate() -> impl Strategy<Value = i64> {
    -100_000_000_i64..100_000_000
}

fn point() -> impl Strategy<Value = [i64; 2]> {
    [coordinate(), coordinate()]
}

proptest! {
    /// The ends of the chords are points of the curve in equal parts of its parameter, and the
    /// curve between two of them is within the tolerance of the chord.
    #[test]
    fn a_cubic_curve_is_within_the_tolerance(
        points in [point(), point(), point(), point()],
        tolerance in 100_u64..100_000,
    ) {
        let chords = Chords::of_cubic(points, tolerance);
        let (total, curve) = (chords.total(), points.map(floats));
        let mut before = curve[0];
        for (number, at) in (1..).zip(chords) {
            let u = |part: f64| (f64::from(number) - part) / f64::from(total);
            let [x, y] = off(floats(at), bezier(&curve, u(0.0)));
            // 3 for the three levels of de Casteljau, the rest for the parameter in 2^-32.
            prop_assert!(x.max(y) < 3.3);
            let chord = [before, floats(at)];
            for part in [0.25, 0.5, 0.75] {
                let off = from_line(bezier(&curve, u(part)), chord);
                prop_assert!(off < tolerance as f64 + 5.0, "{off}");
            }
            before = floats(at);
        }
        prop_assert_eq!(before, curve[3]);
    }

    /// The ends of the chords of a NURBS are points of it, and it ends at its last control point.
    #[test]
    fn a_nurbs_is_its_definition(
        points in prop::collection::vec((point(), 1_u64..1_000_000), 2..12),
        order in 2_u8..6,
    ) {
        prop_assume!(points.len() >= usize::from(order));
        let mut made = Nurbs::new(order);
        for &(at, weight) in &points {
            made.push(at, weight).unwrap();
        }
        let exact: Vec<_> = points
            .iter()
            .map(|&(at, weight)| (floats(at), weight as f64))
            .collect();
        let spans = points.len() + 1 - usize::from(order);
        let chords = Chords::of_nurbs(&made, 50_000);
        let in_span = f64::from(chords.total()) / spans as f64;
        let mut end = [0; 2];
        for (number, at) in (1..chords.total()).zip(chords.clone()) {
            let ideal = nurbs(&exact, order.into(), f64::from(number) / in_span);
            // Weights are rounded to 2^-30 of the largest one.
            prop_assert!(distance(floats(at), ideal) < 2_000.0, "{number}: {at:?} {ideal:?}");
        }
        for at in chords {
            end = at;
        }
        prop_assert_eq!(end, points[points.len() - 1].0);
    }

    /// No input panics, and the number of chords is bounded.
    #[test]
    fn any_input_has_an_end(
        points: [[i64; 2]; 4],
        tolerance: u64,
        order: u8,
        weights in prop::collection::vec(any::<u64>(), 0..4),
    ) {
        let chords = Chords::of_cubic(points, tolerance);
        prop_assert!(chords.total() <= 1 << 20);
        let mut made = Nurbs::new(order);
        for (at, weight) in points.into_iter().zip(weights) {
            made.push(at, weight).unwrap();
        }
        let chords = Chords::of_nurbs(&made, tolerance);
        prop_assert!(chords.total() <= 4 << 12);
        prop_assert_eq!(chords.total() as usize, chords.count());
    }
}

/// A NURBS of order 4 with four equal weights is the cubic curve of its points.
#[test]
fn four_points_of_order_four_are_a_cubic_curve() {
    let points = [
        [0, 0],
        [20_000, 40_000],
        [30_000, -10_000],
        [50_000, 10_000],
    ];
    let mut made = Nurbs::new(4);
    for at in points {
        made.push(at, 7).unwrap();
    }
    let chords = Chords::of_nurbs(&made, 10);
    let total = f64::from(chords.total());
    for (number, at) in (1..).zip(chords) {
        let ideal = bezier(&points.map(floats), f64::from(number) / total);
        assert!(distance(floats(at), ideal) < 5.0, "{at:?} {ideal:?}");
    }
}

#[test]
fn a_full_curve_takes_no_point() {
    let mut made = Nurbs::new(3);
    for number in 0..64 {
        made.push([number, 0], 1).unwrap();
    }
    assert_eq!(made.push([0, 99], 1), Err(TooManyPoints));
    assert_eq!(Chords::of_nurbs(&made, 1).last(), Some([63, 0]));
}

/// A curve of fewer points than its order has the order of their number.
#[test]
fn two_points_are_a_line() {
    let mut made = Nurbs::new(5);
    made.push([0, 0], 1).unwrap();
    made.push([800, 400], 1).unwrap();
    let chords: Vec<_> = Chords::of_nurbs(&made, 1).collect();
    assert_eq!(chords, [[200, 100], [400, 200], [600, 300], [800, 400]]);
}
