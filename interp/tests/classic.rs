//! Properties of every line and circle by the classic methods.

use std::collections::BTreeSet;

use husillo_interp::{
    Arc, ArcDda, ArcError, ArcMove, DirectSearch, DirectSearchPrinted, Direction, Interpolator,
    LineDda, LineDdaExact, NarrowArc, Path, Rim, Staircase, Step, TimedDirectSearch,
};
use proptest::prelude::*;

const METHODS: [Method; 6] = [
    Method::DirectSearch,
    Method::DirectSearchPrinted,
    Method::Staircase,
    Method::StaircasePrinted,
    Method::Dda,
    Method::DdaPrinted,
];

#[derive(Copy, Clone, PartialEq, Debug)]
enum Method {
    DirectSearch,
    DirectSearchPrinted,
    Staircase,
    StaircasePrinted,
    Dda,
    DdaPrinted,
}

impl Method {
    fn steps(self, arc: &ArcMove) -> Result<Vec<Step>, ArcError> {
        Ok(match self {
            Method::DirectSearch => all(DirectSearch::new(arc)?),
            Method::DirectSearchPrinted => all(DirectSearchPrinted::new(arc)?),
            Method::Staircase => all(Staircase::new(arc)?),
            Method::StaircasePrinted => all(Staircase::printed(arc)?),
            Method::Dda => all(ArcDda::new(arc)?),
            Method::DdaPrinted => all(ArcDda::printed(arc)?),
        })
    }

    /// Whether a point with D = |P|^2 - R^2 is within the error of the method on a whole circle. In
    /// integers where the bound is proven: |rho - R| < e is |D - e^2| < 2 e R.
    fn is_near(self, d: i64, radius: i64) -> bool {
        let (d, radius) = (i128::from(d), i128::from(radius));
        match self {
            Method::DirectSearch | Method::DirectSearchPrinted => {
                (4 * d - 1).pow(2) < 16 * radius.pow(2)
            }
            Method::Staircase => (2 * d - 1).pow(2) < 8 * radius.pow(2),
            Method::StaircasePrinted => (d - 1).pow(2) < 4 * radius.pow(2),
            Method::Dda => error(d, radius) < 0.97,
            Method::DdaPrinted => error(d, radius) < 1.156,
        }
    }
}

/// |rho - R|.
fn error(d: i128, radius: i128) -> f64 {
    (d as f64 / (((radius * radius + d) as f64).sqrt() + radius as f64)).abs()
}

/// Returns all events and checks on the way the number of remaining events and the sums.
fn all(walk: impl Interpolator + ExactSizeIterator) -> Vec<Step> {
    let mut events = walk.remaining();
    let (mut total, mut largest) = (0, 0);
    let mut steps = Vec::new();
    let mut rest = walk.clone();
    while let Some(step) = rest.next() {
        events -= 1;
        assert_eq!(rest.remaining(), events);
        assert!(step.sweep > 0 && step.axes < 4 && step.negative & !step.axes == 0);
        total += u64::from(step.sweep);
        largest = largest.max(step.sweep);
        steps.push(step);
    }
    assert_eq!((events, rest.next()), (0, None));
    assert_eq!(walk.len(), steps.len());
    assert_eq!(walk.total_sweep(), total);
    assert_eq!(walk.largest_sweep(), largest);
    steps
}

fn points(from: [i32; 2], steps: &[Step]) -> Vec<[i32; 2]> {
    let mut at = from;
    let mut points = vec![at];
    for step in steps {
        let [dx, dy] = step.deltas();
        at = [at[0] + i32::from(dx), at[1] + i32::from(dy)];
        points.push(at);
    }
    points
}

fn circle(start: [i32; 2], direction: Direction) -> ArcMove {
    ArcMove {
        from: start,
        to: start,
        centre: [0, 0],
        fraction_bits: 0,
        direction,
        turns: 0,
        rim: Rim::Spiral,
    }
}

fn square([x, y]: [i32; 2]) -> i64 {
    i64::from(x).pow(2) + i64::from(y).pow(2)
}

/// Whole circles of every radius up to 2000 by every method: each quadrant is the previous one
/// rotated by a right angle, every point is within the bound, the end is the start.
#[test]
fn circles_are_near_and_the_same_in_all_quadrants() {
    for radius in 1..=2000 {
        for method in METHODS {
            let arc = circle([radius, 0], Direction::CounterClockwise);
            let steps = method.steps(&arc).unwrap();
            assert_eq!(steps.len() % 4, 0);
            let quadrant = steps.len() / 4;
            for (before, after) in steps.iter().zip(&steps[quadrant..]) {
                let [dx, dy] = before.deltas();
                assert_eq!(after.deltas(), [-dy, dx], "{method:?} {radius}");
            }
            let mut at = arc.from;
            for step in &steps {
                at = [
                    at[0] + i32::from(step.delta(0)),
                    at[1] + i32::from(step.delta(1)),
                ];
                let d = square(at) - i64::from(radius).pow(2);
                assert!(
                    method.is_near(d, radius.into()),
                    "{method:?} {radius} {at:?}"
                );
            }
            assert_eq!(at, arc.from);
        }
    }
}

/// Clockwise is the mirror image of counter-clockwise, and a circle may begin on any axis.
#[test]
fn directions_and_starts_are_symmetric() {
    let quarter = |[x, y]: [i8; 2]| [-y, x];
    for radius in (1..=120).chain([373, 1000]) {
        for method in METHODS {
            let steps = |start, direction| method.steps(&circle(start, direction)).unwrap();
            let deltas = |steps: &[Step]| -> Vec<[i8; 2]> {
                steps.iter().map(|step| step.deltas()).collect()
            };
            let mut expected = deltas(&steps([radius, 0], Direction::CounterClockwise));
            for start in [[radius, 0], [0, radius], [-radius, 0], [0, -radius]] {
                let found = deltas(&steps(start, Direction::CounterClockwise));
                assert_eq!(found, expected);
                let [x, y] = start;
                let mirrored = deltas(&steps([x, -y], Direction::Clockwise));
                let expected_mirrored: Vec<_> = expected.iter().map(|[x, y]| [*x, -y]).collect();
                assert_eq!(mirrored, expected_mirrored);
                expected = expected.into_iter().map(quarter).collect();
            }
        }
    }
}

/// Between points on the circle direct search visits the same points in both directions.
#[test]
fn direct_search_goes_back_on_the_same_points() {
    let ends = [
        [25, 0],
        [24, 7],
        [20, 15],
        [15, 20],
        [7, 24],
        [-7, 24],
        [-20, -15],
        [15, -20],
    ];
    for from in ends {
        for to in ends {
            let there = ArcMove {
                to,
                ..circle(from, Direction::CounterClockwise)
            };
            let back = ArcMove {
                to: from,
                ..circle(to, Direction::Clockwise)
            };
            let visited = |arc: &ArcMove| -> BTreeSet<[i32; 2]> {
                points(arc.from, &all(DirectSearch::new(arc).unwrap()))
                    .into_iter()
                    .collect()
            };
            assert_eq!(visited(&there), visited(&back));
        }
    }
}

/// Several turns repeat the circle.
#[test]
fn turns_repeat_the_circle() {
    for method in METHODS {
        for start in [[30, 0], [24, -18], [5, 0], [1, 0]] {
            let once = method.steps(&circle(start, Direction::Clockwise)).unwrap();
            let more = ArcMove {
                turns: 2,
                ..circle(start, Direction::Clockwise)
            };
            let thrice = method.steps(&more).unwrap();
            let end = points(start, &thrice).pop();
            assert_eq!(end, Some(start));
            if square(start) == 25 || start[1] == 0 {
                assert_eq!(thrice, once.repeat(3), "{method:?} {start:?}");
            }
        }
    }
}

fn direction() -> impl Strategy<Value = Direction> {
    prop_oneof![
        Just(Direction::Clockwise),
        Just(Direction::CounterClockwise)
    ]
}

fn on_circle(radius: f64, angle: f64) -> [i32; 2] {
    [
        (radius * angle.cos()).round() as i32,
        (radius * angle.sin()).round() as i32,
    ]
}

/// The same arc about another centre.
fn moved(arc: ArcMove, [x, y]: [i32; 2]) -> ArcMove {
    let add = |[a, b]: [i32; 2]| [a + x, b + y];
    ArcMove {
        from: add(arc.from),
        to: add(arc.to),
        centre: [i64::from(x), i64::from(y)],
        ..arc
    }
}

/// An arc of a circle of integer radius about the origin, with ends rounded to the lattice.
fn rounded(radius: i64, from: [i32; 2], to: [i32; 2], direction: Direction) -> ArcMove {
    ArcMove {
        to,
        rim: Rim::Nominal {
            start: square(from) - radius.pow(2),
            end: square(to) - radius.pow(2),
        },
        ..circle(from, direction)
    }
}

/// A point rotated into the quadrant of the end.
fn turned(arc: &ArcMove, [x, y]: [i32; 2]) -> [i32; 2] {
    let mirror = |y: i32| {
        if arc.direction == Direction::Clockwise {
            -y
        } else {
            y
        }
    };
    let (x, y) = (x, mirror(y));
    match (arc.to[0], mirror(arc.to[1])) {
        (a, b) if a > 0 && b >= 0 => [x, y],
        (a, b) if a <= 0 && b > 0 => [y, -x],
        (a, b) if a < 0 && b <= 0 => [-x, -y],
        _ => [-y, x],
    }
}

/// Number of points before the run-off, which are the last ones level with the end.
fn before_run_off(arc: &ArcMove, points: &[[i32; 2]]) -> usize {
    let [u_end, v_end] = turned(arc, arc.to);
    let is_level = |at: &&[i32; 2]| {
        let [u, v] = turned(arc, **at);
        u <= u_end || v >= v_end
    };
    points.len() - points.iter().rev().take_while(is_level).count()
}

/// Checks a partial arc: it ends exactly, within the proven number of events, near the circle.
fn check(method: Method, arc: &ArcMove, radius: i64) -> Result<(), TestCaseError> {
    let steps = match method.steps(arc) {
        Ok(steps) => steps,
        Err(ArcError::Degenerate) => return Ok(()),
        Err(error) => return Err(TestCaseError::fail(format!("{method:?} {error}"))),
    };
    let points = points(arc.from, &steps);
    prop_assert_eq!(points.last(), Some(&arc.to));
    // Every event decreases u or increases v, each by at most R and 2 per quadrant; idle events are
    // fewer.
    let quadrants = 5 + 4 * i64::from(arc.turns);
    prop_assert!(steps.len() as i64 <= quadrants * (2 * radius + 8));
    if !matches!(method, Method::Dda | Method::DdaPrinted) {
        prop_assert!(steps.iter().all(|step| step.axes != 0));
    }
    if matches!(method, Method::Staircase | Method::StaircasePrinted) {
        prop_assert!(steps.iter().all(|step| step.axes.count_ones() == 1));
    }
    let run_off = before_run_off(arc, &points);
    for (index, at) in (0..).zip(&points) {
        let d = square(*at) - radius.pow(2);
        let error = error(d.into(), radius.into());
        // A rounded end is up to 0.7071 away, plus the straight path to it.
        prop_assert!(error < 1.75, "{method:?} {error} at {at:?}");
        let is_rounding = index < 2 || index >= run_off;
        if !is_rounding && method != Method::DdaPrinted {
            prop_assert!(
                method.is_near(d, radius),
                "{method:?} {error} at {at:?}, number {index}"
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    /// Arcs of all sizes up to 3000 BLU with rounded ends, also of several turns, anywhere.
    #[test]
    fn partial_arcs_end_and_are_near(
        magnitude in 0.0_f64..8.0,
        from in 0.0_f64..6.3,
        to in 0.0_f64..6.3,
        direction in direction(),
        turns in 0_u32..2,
    ) {
        let radius = magnitude.exp().round();
        let arc = rounded(radius as i64, on_circle(radius, from), on_circle(radius, to), direction);
        for method in METHODS {
            check(method, &ArcMove { turns, ..arc }, radius as i64)?;
        }
    }

    /// The position of the centre does not matter.
    #[test]
    fn arcs_are_the_same_anywhere(
        magnitude in 0.0_f64..7.0,
        from in 0.0_f64..6.3,
        to in 0.0_f64..6.3,
        direction in direction(),
        offset in [-1_000_000_000_i32..1_000_000_000, -1_000_000_000_i32..1_000_000_000],
    ) {
        let radius = magnitude.exp().round();
        let arc = rounded(radius as i64, on_circle(radius, from), on_circle(radius, to), direction);
        for method in METHODS {
            prop_assert_eq!(method.steps(&arc), method.steps(&moved(arc, offset)));
        }
    }

    /// Radii up to 2^28, about a thousand events.
    #[test]
    fn pieces_of_huge_circles_are_near(
        magnitude in 10.0_f64..28.0,
        angle in 0.0_f64..6.3,
        length in 10.0_f64..1000.0,
        direction in direction(),
    ) {
        let radius = magnitude.exp2().floor();
        let way = match direction {
            Direction::Clockwise => -length / radius,
            Direction::CounterClockwise => length / radius,
        };
        let arc = rounded(
            radius as i64, on_circle(radius, angle), on_circle(radius, angle + way), direction,
        );
        for method in METHODS {
            check(method, &arc, radius as i64)?;
        }
    }

    /// The two tests choose the same points as the three-way comparison and as the general arc; the
    /// times add up.
    #[test]
    fn direct_search_is_direct_search(
        magnitude in 0.0_f64..8.0,
        from in 0.0_f64..6.3,
        to in 0.0_f64..6.3,
        direction in direction(),
        stretch in -1.0_f64..1.0,
        is_nominal in any::<bool>(),
        turns in 0_u32..3,
        ticks_per_blu in 1_u32..100_000,
    ) {
        let radius = magnitude.exp().round();
        let arc = rounded(
            radius as i64, on_circle(radius, from), on_circle(radius + stretch, to), direction,
        );
        let rim = if is_nominal { arc.rim } else { Rim::Spiral };
        let arc = ArcMove { turns, rim, ..arc };
        let Ok(search) = DirectSearch::new(&arc) else { return Ok(()) };
        let steps = all(search.clone());
        let printed = all(DirectSearchPrinted::new(&arc).unwrap());
        let sides = |steps: &[Step]| -> Vec<[i8; 2]> {
            steps.iter().map(|step| step.deltas()).collect()
        };
        prop_assert_eq!(sides(&steps), sides(&printed));
        if is_nominal {
            // Between ends of different radii the general arc is a spiral, this one is not.
            prop_assert_eq!(&steps, &all(Arc::new(&arc).unwrap()));
        }
        let mut timed = TimedDirectSearch::new(search.clone(), ticks_per_blu);
        let nominal = square(arc.from) - (radius as i64).pow(2);
        let squared = square(arc.from) - if is_nominal { nominal } else { 0 };
        let factor = f64::from(ticks_per_blu) / (squared as f64).sqrt();
        let (mut sweep, mut ticks, mut left) = (0_u64, 0_u64, search.len());
        for step in &steps {
            prop_assert_eq!(timed.len(), left);
            left -= 1;
            let event = timed.next().unwrap();
            prop_assert_eq!(event.step, *step);
            sweep += u64::from(step.sweep);
            ticks += u64::from(event.wait_ticks);
            let exact = sweep as f64 * factor;
            // Never late and at most a tick early, except for the rounding of the factor.
            let rounding = sweep as f64 / 8e9 + exact * 1e-9;
            let ticks = ticks as f64;
            prop_assert!(ticks <= exact + rounding && ticks + 1.0 >= exact - rounding);
        }
        prop_assert_eq!(timed.next(), None);
    }

    /// Constant path speed: on a circle the time of an event is that of its chord except for 1/R
    /// and a tick.
    #[test]
    fn timed_speed_is_constant(radius in 5_i32..2000, ticks_per_blu in 100_u32..10_000) {
        let arc = circle([0, radius], Direction::Clockwise);
        let timed = TimedDirectSearch::new(DirectSearch::new(&arc).unwrap(), ticks_per_blu);
        let mut at = arc.from.map(f64::from);
        for event in timed {
            let [dx, dy] = event.step.deltas().map(f64::from);
            let after = [at[0] + dx, at[1] + dy];
            let cross = at[0] * after[1] - at[1] * after[0];
            let swept = cross.atan2(at[0] * after[0] + at[1] * after[1]).abs();
            let ticks = swept * f64::from(radius) * f64::from(ticks_per_blu);
            let ripple = ticks * 1.1 / f64::from(radius) + 1.0;
            prop_assert!((f64::from(event.wait_ticks) - ticks).abs() <= ripple);
            at = after;
        }
    }

    /// A DDA line ends exactly after round(L) events, each axis always within half a step of its
    /// share. The return path visits the same points.
    #[test]
    fn dda_lines_share_the_length(delta in [-3000_i32..3000, -300_i32..300, -30_i32..30]) {
        let line = LineDda::new(delta).unwrap();
        let length = delta.iter().map(|d| f64::from(*d).powi(2)).sum::<f64>().sqrt();
        prop_assert_eq!(f64::from(line.events()), length.round());
        let events = i64::from(line.events());
        let mut at = [0_i64; 3];
        let mut points = vec![at];
        for (step, pass) in line.clone().zip(1..) {
            for (at, delta) in at.iter_mut().zip(step.deltas::<3>()) {
                *at += i64::from(delta);
            }
            for (at, delta) in at.iter().zip(delta) {
                prop_assert!((2 * (at * events - pass * i64::from(delta))).abs() <= events);
            }
            points.push(at);
        }
        prop_assert_eq!(at, delta.map(i64::from));
        let mut back = vec![at];
        for step in LineDda::new(delta.map(|d| -d)).unwrap() {
            for (at, delta) in at.iter_mut().zip(step.deltas::<3>()) {
                *at += i64::from(delta);
            }
            back.push(at);
        }
        back.reverse();
        prop_assert_eq!(points, back);
    }

    /// No input panics; an arc is refused before it is walked.
    #[test]
    fn any_arc_is_accepted_or_refused(
        from in any::<[i32; 2]>(),
        to in any::<[i32; 2]>(),
        near in [-9_i32..9, -9_i32..9],
        centre in any::<[i64; 2]>(),
        fraction_bits in any::<u8>(),
        direction in direction(),
        turns in 0_u32..9,
        start in any::<i64>(),
    ) {
        let rims = [
            Rim::Spiral,
            Rim::Nominal { start, end: 0 },
            Rim::Nominal { start: start >> 58, end: 0 },
        ];
        for rim in rims {
            let arc = ArcMove { from, to, centre, fraction_bits, direction, turns, rim };
            let small = ArcMove { from: near, to: to.map(|at| at >> 28), centre: [0, 0], ..arc };
            for method in METHODS {
                let _ = method.steps(&arc);
                if let Ok(steps) = method.steps(&small) {
                    prop_assert_eq!(points(small.from, &steps).pop(), Some(small.to));
                }
            }
        }
    }
}

/// All arcs about the origin with radii up to 4 and ends up to two BLU off them, with and without
/// one more turn. Every method ends exactly, and direct search makes the events of the general arc
/// with the same sweeps.
#[test]
fn tiny_arcs_end() {
    let near = |radius: i64| -> Vec<[i32; 2]> {
        let points = (-7..=7).flat_map(|x| (-7..=7).map(move |y| [x, y]));
        let is_near = |at: &[i32; 2]| (square(*at) - radius.pow(2)).abs() <= 4 * radius + 4;
        points.filter(is_near).filter(|at| *at != [0, 0]).collect()
    };
    for radius in 1..=4 {
        for from in near(radius) {
            for to in near(radius) {
                for (direction, turns) in
                    [(Direction::Clockwise, 0), (Direction::CounterClockwise, 1)]
                {
                    let arc = ArcMove {
                        turns,
                        ..rounded(radius, from, to, direction)
                    };
                    for method in METHODS {
                        let steps = method.steps(&arc).unwrap();
                        assert_eq!(points(from, &steps).pop(), Some(to), "{method:?} {arc:?}");
                        assert!(steps.len() as i64 <= 9 * (2 * radius + 8));
                    }
                    let search = DirectSearch::new(&arc).unwrap();
                    let timed = TimedDirectSearch::with_factor(search.clone(), 1 << 32);
                    assert!(timed.clone().map(|event| event.step).eq(search.clone()));
                    let waits = timed.map(|event| u64::from(event.wait_ticks)).sum::<u64>();
                    assert_eq!(waits, search.total_sweep());
                    if let Ok(general) = Arc::new(&arc) {
                        assert!(general.eq(search), "{arc:?}");
                    }
                }
            }
        }
    }
}

/// Every line up to 120 steps in both axes by the printed methods: floor(L) + 1 passes, the end is
/// met, less than 1 BLU from the line.
#[test]
fn printed_lines_end_after_their_length() {
    for a in 0..=120_i32 {
        for b in 0..=120_i32 {
            let squared = u64::from(a.unsigned_abs()).pow(2) + u64::from(b.unsigned_abs()).pow(2);
            let expected = if squared == 0 {
                0
            } else {
                squared.isqrt() as usize + 1
            };
            let passes = [
                all(LineDda::printed([a, -b]).unwrap()),
                all(LineDdaExact::new([a, -b]).unwrap()),
            ];
            for steps in passes {
                assert_eq!(steps.len(), expected);
                let visited = points([0, 0], &steps);
                for [x, y] in &visited {
                    let across = i64::from(x * b + y * a);
                    assert!(across.unsigned_abs().pow(2) <= squared);
                }
                assert_eq!(visited.last(), Some(&[a, -b]));
            }
        }
    }
}

/// The longest possible lines, without overflow.
#[test]
fn longest_lines() {
    assert_eq!(LineDda::new([i32::MIN, 0]), None);
    assert_eq!(LineDda::new([i32::MAX, i32::MAX]), None);
    let line = LineDda::new([i32::MAX, 0, -1]).unwrap();
    assert_eq!(line.events(), i32::MAX.unsigned_abs());
    let line = LineDda::printed([i32::MAX, 0]).unwrap();
    assert_eq!(line.events(), 1 << 31);
    let axes: Vec<u8> = line.take(4).map(|step| step.axes).collect();
    assert_eq!(axes, [0, 1, 1, 1]);
    let axes: Vec<u8> = LineDdaExact::new([i32::MAX, 0])
        .unwrap()
        .take(4)
        .map(|step| step.axes)
        .collect();
    assert_eq!(axes, [0, 1, 1, 1]);
    assert_eq!(LineDda::new([0; 3]).unwrap().next(), None);
}

/// Refused arcs: no motion, out of range, or only for the general method.
#[test]
fn refusals() {
    let fine = circle([5, 0], Direction::Clockwise);
    for method in METHODS {
        let error = |arc: &ArcMove| method.steps(arc).err();
        assert_eq!(error(&fine), None);
        assert_eq!(
            error(&ArcMove {
                from: [0, 0],
                ..fine
            }),
            Some(ArcError::Degenerate)
        );
        let half = ArcMove {
            centre: [1, 0],
            fraction_bits: 1,
            ..fine
        };
        assert_eq!(error(&half), Some(ArcError::Centre));
        // A whole step, in any unit.
        assert_eq!(
            error(&ArcMove {
                centre: [1 << 20, 0],
                fraction_bits: 20,
                ..fine
            }),
            None
        );
        assert_eq!(
            error(&ArcMove { to: [9, 0], ..fine }),
            Some(ArcError::OffRim)
        );
        assert_eq!(error(&ArcMove { to: [7, 0], ..fine }), None);
        assert_eq!(
            error(&ArcMove {
                turns: u32::MAX,
                ..fine
            }),
            Some(ArcError::TooLong)
        );
        let large = circle([1 << 29, 0], Direction::Clockwise);
        assert_eq!(error(&large), Some(ArcError::TooLarge));
    }
}

/// Size of the state of the kernels: 64 bytes, plus the times where they are updated too.
#[test]
fn sizes() {
    assert!(
        size_of::<DirectSearch>() <= 64,
        "{}",
        size_of::<DirectSearch>()
    );
    assert!(size_of::<TimedDirectSearch>() <= 96);
    for size in [size_of::<DirectSearchPrinted>(), size_of::<Staircase>()] {
        assert!(size <= 64, "{size}");
    }
    assert!(size_of::<ArcDda>() <= 80, "{}", size_of::<ArcDda>());
    assert!(size_of::<Arc>() <= 152, "{}", size_of::<Arc>());
    assert!(size_of::<NarrowArc>() <= 96, "{}", size_of::<NarrowArc>());
    assert!(size_of::<Path<3>>() <= 264, "{}", size_of::<Path<3>>());
}
