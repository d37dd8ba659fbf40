//! Properties of every arc of an ellipse, a parabola or a hyperbola.

use husillo_interp::{
    Arc, ArcMove, Conic, ConicError, ConicMove, Direction, EllipseMove, Interpolator, Rim, Step,
};
use proptest::prelude::*;

fn points(from: [i32; 2], steps: &[Step]) -> Vec<[i32; 2]> {
    let mut at = from;
    let mut points = vec![at];
    for step in steps {
        for (axis, at) in at.iter_mut().enumerate() {
            *at += i32::from(step.delta(axis));
        }
        points.push(at);
    }
    points
}

/// Distance from an ellipse about the origin with half width `a` and half height `b`: bisection for
/// the foot of the perpendicular (Eberly).
fn distance_from_ellipse(at: [f64; 2], a: f64, b: f64) -> f64 {
    if a < b {
        return distance_from_ellipse([at[1], at[0]], b, a);
    }
    let [x, y] = at.map(f64::abs);
    if y == 0.0 {
        let focus = (a * a - b * b) / a;
        if x < focus {
            let foot = a * x / (a * a - b * b) * a;
            let height = b * (1.0 - (foot / a).powi(2)).max(0.0).sqrt();
            return (foot - x).hypot(height);
        }
        return (x - a).abs();
    }
    if x == 0.0 {
        return (y - b).abs();
    }
    let ratio = (a / b).powi(2);
    let (z0, z1) = (x / a, y / b);
    let g = |s: f64| (ratio * z0 / (s + ratio)).powi(2) + (z1 / (s + 1.0)).powi(2) - 1.0;
    let (mut low, mut high) = (z1 - 1.0, (ratio * z0).hypot(z1) - 1.0);
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if g(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let s = (low + high) / 2.0;
    (ratio * x / (s + ratio) - x).hypot(y / (s + 1.0) - y)
}

/// Length of a piece of the perimeter between two angles of the parameter, by many chords.
fn length_of_ellipse(a: f64, b: f64, from: f64, to: f64) -> f64 {
    let pieces = 20_000;
    let at = |k: i32| {
        let angle = from + (to - from) * f64::from(k) / f64::from(pieces);
        [a * angle.cos(), b * angle.sin()]
    };
    (0..pieces)
        .map(|k| (at(k + 1)[0] - at(k)[0]).hypot(at(k + 1)[1] - at(k)[1]))
        .sum()
}

/// Checks any arc: counts and sums of the dry pass are those of the walk, every event moves and
/// takes time, the end is met exactly.
fn check(conic: &Conic, from: [i32; 2], to: [i32; 2]) -> Result<Vec<Step>, TestCaseError> {
    let steps: Vec<Step> = conic.clone().collect();
    prop_assert_eq!(steps.len(), conic.events() as usize);
    prop_assert_eq!(
        steps.iter().map(|step| u64::from(step.sweep)).sum::<u64>(),
        conic.total_sweep()
    );
    prop_assert_eq!(
        steps.iter().map(|step| step.sweep).max().unwrap_or(0),
        conic.largest_sweep()
    );
    let is_move = |step: &Step| step.axes & 3 != 0 && step.negative & !step.axes == 0;
    prop_assert!(steps.iter().all(is_move));
    let least = conic.unit() / 2;
    prop_assert!(
        steps
            .iter()
            .all(|step| step.sweep > 0 && step.sweep >= least)
    );
    prop_assert_eq!(points(from, &steps).last().copied(), Some(to));
    Ok(steps)
}

fn direction() -> impl Strategy<Value = Direction> {
    prop_oneof![
        Just(Direction::Clockwise),
        Just(Direction::CounterClockwise)
    ]
}

prop_compose! {
    /// Semi-axes of all magnitudes and ratios from 1 to 1000 BLU, any centre, any ends.
    fn upright()(
        bits in 0_u8..=8,
        centre in [-100_000_i64..100_000, -100_000_i64..100_000],
        magnitudes in [0.0_f64..6.9, 0.0_f64..6.9],
        angles in [0.0_f64..6.3, 0.0_f64..6.3],
        direction in direction(),
        turns in 0_u32..3,
    ) -> EllipseMove {
        let one = f64::from(1_u32 << bits);
        let semi_axes = magnitudes.map(|magnitude| (magnitude.exp() * one).ceil() as u32);
        let at = |angle: f64| {
            let x = f64::from(semi_axes[0]) * angle.cos();
            let y = f64::from(semi_axes[1]) * angle.sin();
            [
                ((centre[0] as f64 + x) / one).round() as i32,
                ((centre[1] as f64 + y) / one).round() as i32,
            ]
        };
        EllipseMove {
            from: at(angles[0]),
            to: at(angles[1]),
            centre,
            semi_axes,
            fraction_bits: bits,
            direction,
            turns,
        }
    }
}

/// Largest distance of the points from the ellipse, without the first and the last ones, which are
/// rounded.
fn largest_error(ellipse: &EllipseMove, points: &[[i32; 2]]) -> f64 {
    let one = f64::from(1_u32 << ellipse.fraction_bits);
    let [a, b] = ellipse.semi_axes.map(|semi| f64::from(semi) / one);
    let inner = points.get(2..points.len().saturating_sub(2)).unwrap_or(&[]);
    inner
        .iter()
        .map(|&[x, y]| {
            let [centre_x, centre_y] = ellipse.centre.map(|centre| centre as f64 / one);
            distance_from_ellipse([f64::from(x) - centre_x, f64::from(y) - centre_y], a, b)
        })
        .fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Any ellipse with semi-axes of at least one BLU is walked, stays on its curve and ends
    /// exactly.
    #[test]
    fn upright_ellipses_keep_to_their_curve(ellipse in upright()) {
        let conic = Conic::ellipse(&ellipse);
        prop_assume!(conic.as_ref().err() != Some(&ConicError::Degenerate));
        let conic = conic.map_err(|error| TestCaseError::fail(error.to_string()))?;
        let steps = check(&conic, ellipse.from, ellipse.to)?;
        let points = points(ellipse.from, &steps);
        let error = largest_error(&ellipse, &points);
        let one = f64::from(1_u32 << ellipse.fraction_bits);
        let [a, b] = ellipse.semi_axes.map(|semi| f64::from(semi) / one);
        let bound = 0.5 + 0.1 / a.min(b);
        prop_assert!(error <= bound, "{error} {bound}");
    }

    /// The sweeps add up to the length of the ellipse, and each is the distance of its step along
    /// the curve. Constant time per sweep is therefore constant path speed.
    #[test]
    fn sweep_is_length(semi_axes in [30_u32..1000, 30_u32..1000], direction in direction()) {
        let [a, b] = semi_axes.map(f64::from);
        let sharpest = (a * a / b).min(b * b / a);
        prop_assume!(sharpest > 10.0);
        let from = [semi_axes[0] as i32, 0];
        let conic = Conic::ellipse(&EllipseMove {
            from,
            to: from,
            centre: [0, 0],
            semi_axes,
            fraction_bits: 0,
            direction,
            turns: 0,
        }).unwrap();
        let steps = check(&conic, from, from)?;
        let unit = f64::from(conic.unit());
        let length = conic.total_sweep() as f64 / unit;
        let true_length = length_of_ellipse(a, b, 0.0, std::f64::consts::TAU);
        prop_assert!((length / true_length - 1.0).abs() < 0.5 / sharpest, "{length} {true_length}");
        let mut before = points(from, &steps).into_iter();
        let worst = steps.iter().map(|step| {
            let [x, y] = before.next().unwrap().map(f64::from);
            let [to_x, to_y] = [x + f64::from(step.delta(0)), y + f64::from(step.delta(1))];
            // The distance that the nearest point of the ellipse moves: the angle of the parameter,
            // refined at the middle.
            let (middle_x, middle_y) = ((x + to_x) / 2.0 / a, (y + to_y) / 2.0 / b);
            let tangent = [-middle_y * a, middle_x * b];
            let dot = (to_x - x) * tangent[0] + (to_y - y) * tangent[1];
            let way = dot / tangent[0].hypot(tangent[1]);
            (way.abs() * unit / f64::from(step.sweep) - 1.0).abs()
        }).fold(0.0, f64::max);
        prop_assert!(worst < 1.0 / sharpest + 0.0005, "{worst} {sharpest}");
    }
}

/// A curve of the second degree from its principal frame: p (x')^2 + q (y')^2 + r x' + s, rotated
/// by `angle` about `centre`, as integer coefficients.
fn turned(form: [f64; 4], angle: f64, centre: [f64; 2]) -> [i64; 6] {
    let [p, q, r, s] = form;
    let (sin, cos) = angle.sin_cos();
    let [x, y] = centre;
    let a = p * cos * cos + q * sin * sin;
    let b = 2.0 * (p - q) * sin * cos;
    let c = p * sin * sin + q * cos * cos;
    let (d, e) = (r * cos, r * sin);
    [
        a,
        b,
        c,
        d - 2.0 * a * x - b * y,
        e - 2.0 * c * y - b * x,
        s + a * x * x + b * x * y + c * y * y - d * x - e * y,
    ]
    .map(|coefficient| coefficient.round() as i64)
}

fn place(at: [f64; 2], angle: f64, centre: [f64; 2]) -> [i32; 2] {
    let (sin, cos) = angle.sin_cos();
    [
        (centre[0] + at[0] * cos - at[1] * sin).round() as i32,
        (centre[1] + at[0] * sin + at[1] * cos).round() as i32,
    ]
}

/// Distance from F = 0 by Newton steps along the gradient; accurate where the curve is not sharp.
fn distance_from_conic(coefficients: [i64; 6], at: [i32; 2]) -> f64 {
    let [a, b, c, d, e, g] = coefficients.map(|coefficient| coefficient as f64);
    let start = at.map(f64::from);
    let [mut x, mut y] = start;
    for _ in 0..8 {
        let value = a * x * x + b * x * y + c * y * y + d * x + e * y + g;
        let (along_x, along_y) = (2.0 * a * x + b * y + d, 2.0 * c * y + b * x + e);
        let square = along_x * along_x + along_y * along_y;
        // Projects onto the tangent line of the level set, then moves along it to the foot of the
        // perpendicular.
        let tangent = ((start[0] - x) * -along_y + (start[1] - y) * along_x) / square;
        x += -value * along_x / square + tangent * -along_y * 0.5;
        y += -value * along_y / square + tangent * along_x * 0.5;
    }
    (x - start[0]).hypot(y - start[1])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Rotated ellipses whose sharpest radius b^2 / a is at least 2 BLU are walked and stay on the
    /// curve.
    #[test]
    fn turned_ellipses_keep_to_their_curve(
        a in 3.0_f64..600.0,
        ratio in 0.0_f64..1.0,
        angle in 0.0_f64..6.3,
        centre in [-50.0_f64..50.0, -50.0_f64..50.0],
        ends in [0.0_f64..6.3, 0.0_f64..6.3],
        direction in direction(),
        turns in 0_u32..2,
    ) {
        let least = (2.0 * a).sqrt();
        let b = least + (a - least).max(0.0) * ratio * ratio;
        let scale = 2_f64.powi(42);
        let coefficients = turned([scale / (a * a), scale / (b * b), 0.0, -scale], angle, centre);
        let [from, to] = ends.map(|end| place([a * end.cos(), b * end.sin()], angle, centre));
        let conic = Conic::new(&ConicMove { from, to, coefficients, direction, turns })
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        let steps = check(&conic, from, to)?;
        let points = points(from, &steps);
        let inner = points.get(2..points.len().saturating_sub(2)).unwrap_or(&[]);
        let (sin, cos) = angle.sin_cos();
        let error = inner.iter().map(|&[x, y]| {
            let (x, y) = (f64::from(x) - centre[0], f64::from(y) - centre[1]);
            distance_from_ellipse([x * cos + y * sin, y * cos - x * sin], a, b)
        }).fold(0.0, f64::max);
        prop_assert!(error <= 0.5 + 0.25 * a / (b * b), "{error}");
    }

    /// Parabolas (m y - n x)^2 = q (m x + n y): an axis in any whole-number direction, so that B^2
    /// = 4 A C exactly.
    #[test]
    fn parabolas_keep_to_their_curve(
        [m, n] in [-9_i32..=9, -9_i32..=9],
        p in 2.0_f64..300.0,
        ends in [-300.0_f64..300.0, -300.0_f64..300.0],
    ) {
        let length = f64::from(m).hypot(f64::from(n));
        prop_assume!(length > 0.0 && (ends[0] - ends[1]).abs() > 3.0);
        let q = (2.0 * p * length).round();
        let k = q as i32;
        let coefficients = [n * n, -2 * m * n, m * m, -k * m, -k * n, 0].map(i64::from);
        let angle = f64::from(n).atan2(f64::from(m));
        let [from, to] = ends.map(|y| place([y * y * length / q, y], angle, [0.0; 2]));
        // The inside is +x': the path turns left when it runs downwards.
        let (onwards, backwards) = if ends[1] < ends[0] {
            (Direction::CounterClockwise, Direction::Clockwise)
        } else {
            (Direction::Clockwise, Direction::CounterClockwise)
        };
        let arc = |direction| ConicMove { from, to, coefficients, direction, turns: 0 };
        let conic = Conic::new(&arc(onwards))
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        let steps = check(&conic, from, to)?;
        let points = points(from, &steps);
        let inner = points.get(2..points.len().saturating_sub(2)).unwrap_or(&[]);
        let error = inner
            .iter()
            .map(|&at| distance_from_conic(coefficients, at))
            .fold(0.0, f64::max);
        prop_assert!(error <= 0.5 + 0.25 / p, "{error}");
        prop_assert_eq!(Conic::new(&arc(backwards)).err(), Some(ConicError::Astray));
    }

    /// Hyperbolas: (x'/a)^2 - (y'/b)^2 = 1, the right branch, rotated.
    #[test]
    fn hyperbolas_keep_to_their_curve(
        a in 2.0_f64..200.0,
        sharpness in 2.0_f64..200.0,
        angle in 0.0_f64..6.3,
        centre in [-50.0_f64..50.0, -50.0_f64..50.0],
        ends in [-1.5_f64..1.5, -1.5_f64..1.5],
    ) {
        let b = (sharpness * a).sqrt();
        let scale = 2_f64.powi(40);
        let coefficients = turned([scale / (a * a), -scale / (b * b), 0.0, -scale], angle, centre);
        let [from, to] = ends.map(|t| place([a * t.cosh(), b * t.sinh()], angle, centre));
        prop_assume!(b * (ends[0] - ends[1]).abs() > 3.0);
        let (onwards, backwards) = if ends[1] < ends[0] {
            (Direction::CounterClockwise, Direction::Clockwise)
        } else {
            (Direction::Clockwise, Direction::CounterClockwise)
        };
        let arc = |direction| ConicMove { from, to, coefficients, direction, turns: 0 };
        let conic = Conic::new(&arc(onwards))
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        let steps = check(&conic, from, to)?;
        let points = points(from, &steps);
        let inner = points.get(2..points.len().saturating_sub(2)).unwrap_or(&[]);
        let error = inner
            .iter()
            .map(|&at| distance_from_conic(coefficients, at))
            .fold(0.0, f64::max);
        // In addition to the curvature, F itself bends: at the vertex by 1/a of its slope.
        prop_assert!(error <= 0.5 + 0.25 / sharpness.min(a), "{error}");
        prop_assert!(Conic::new(&arc(backwards)).is_err());
    }

    /// No input hangs or panics, and every accepted arc ends exactly.
    #[test]
    fn any_coefficients_end_or_are_refused(
        coefficients in [
            -40_i64..40,
            -40_i64..40,
            -40_i64..40,
            -900_i64..900,
            -900_i64..900,
            -9000_i64..9000,
        ],
        from in [-60_i32..60, -60_i32..60],
        to in [-60_i32..60, -60_i32..60],
        direction in direction(),
    ) {
        if let Ok(conic) = Conic::new(&ConicMove { from, to, coefficients, direction, turns: 0 }) {
            check(&conic, from, to)?;
        }
    }

    /// The events of a circle are those of `Arc`, sweeps included.
    #[test]
    fn equal_axes_make_the_same_steps_as_an_arc(
        radius in 2_i32..400,
        ends in [0.0_f64..6.3, 0.0_f64..6.3],
        direction in direction(),
        turns in 0_u32..2,
    ) {
        let at = |angle: f64| {
            [
                (f64::from(radius) * angle.cos()).round() as i32,
                (f64::from(radius) * angle.sin()).round() as i32,
            ]
        };
        let [from, to] = ends.map(at);
        let residue = |at: [i32; 2]| {
            at.map(|at| i64::from(at) * i64::from(at)).iter().sum::<i64>()
                - i64::from(radius).pow(2)
        };
        let arc = Arc::new(&ArcMove {
            from,
            to,
            centre: [0, 0],
            fraction_bits: 0,
            direction,
            turns,
            rim: Rim::Nominal { start: residue(from), end: residue(to) },
        }).unwrap();
        let conic = Conic::ellipse(&EllipseMove {
            from,
            to,
            centre: [0, 0],
            semi_axes: [radius as u32; 2],
            fraction_bits: 0,
            direction,
            turns,
        }).unwrap();
        prop_assert_eq!(u64::from(conic.unit()), arc.radius());
        prop_assert!(conic.eq(arc));
    }

    /// Large ellipses, up to the largest semi-axes: a few thousand events from any start.
    #[test]
    fn large_ellipses_keep_to_their_curve(
        semi_axes in [500_000_u32..=1 << 20, 500_000_u32..=1 << 20],
        angle in 0.0_f64..6.3,
        way in 0.001_f64..0.004,
    ) {
        let at = |angle: f64| {
            [
                (f64::from(semi_axes[0]) * angle.cos()).round() as i32,
                (f64::from(semi_axes[1]) * angle.sin()).round() as i32,
            ]
        };
        let ellipse = EllipseMove {
            from: at(angle),
            to: at(angle + way),
            centre: [0, 0],
            semi_axes,
            fraction_bits: 0,
            direction: Direction::CounterClockwise,
            turns: 0,
        };
        let conic = Conic::ellipse(&ellipse)
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        let steps = check(&conic, ellipse.from, ellipse.to)?;
        let error = largest_error(&ellipse, &points(ellipse.from, &steps));
        prop_assert!(error <= 0.5001, "{error}");
    }
}

/// The largest possible ellipse makes a full turn.
#[test]
fn the_largest_ellipse_fits() {
    let ellipse = EllipseMove {
        from: [1 << 20, 0],
        to: [1 << 20, 0],
        centre: [0, 0],
        semi_axes: [1 << 20, (1 << 20) - 1],
        fraction_bits: 0,
        direction: Direction::Clockwise,
        turns: 0,
    };
    let conic = Conic::ellipse(&ellipse).unwrap();
    let length = conic.total_sweep() as f64 / f64::from(conic.unit());
    assert!((length / 6_588_394.0 - 1.0).abs() < 1e-3, "{length}");
}
