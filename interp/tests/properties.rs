//! Properties of every line, arc and helix.

use husillo_interp::{
    Arc, ArcError, ArcMove, Direction, Helix, Interpolator, Line, Moves, NarrowArc, Path, Rim,
    Step, fraction_bits_for,
};
use proptest::prelude::*;

/// Positions after each event, the start included.
fn points<const N: usize>(from: [i32; N], steps: impl Iterator<Item = Step>) -> Vec<[i64; N]> {
    let mut at = from.map(i64::from);
    let mut points = vec![at];
    for step in steps {
        for (at, delta) in at.iter_mut().zip(step.deltas::<N>()) {
            *at += i64::from(delta);
        }
        points.push(at);
    }
    points
}

fn direction() -> impl Strategy<Value = Direction> {
    prop_oneof![
        Just(Direction::Clockwise),
        Just(Direction::CounterClockwise)
    ]
}

/// The lattice point nearest to the point of the circle at `angle`.
fn on_circle(centre: [i64; 2], bits: u8, radius: f64, angle: f64) -> [i32; 2] {
    let one = f64::from(1_u32 << bits);
    [
        (centre[0] as f64 / one + radius * angle.cos()).round() as i32,
        (centre[1] as f64 / one + radius * angle.sin()).round() as i32,
    ]
}

fn square(at: [i64; 2], arc: &ArcMove) -> i128 {
    let scaled = |at: i64, centre: i64| i128::from((at << arc.fraction_bits) - centre);
    scaled(at[0], arc.centre[0]).pow(2) + scaled(at[1], arc.centre[1]).pow(2)
}

/// A nominal arc; each residue is rounded once, to nearest, as the caller has to do.
fn nominal(mut arc: ArcMove, radius_squared: i128) -> ArcMove {
    let half = (1_i128 << arc.fraction_bits) / 2;
    let residue = |at: [i32; 2]| {
        let exact = square(at.map(i64::from), &arc) - radius_squared;
        ((exact + half) >> arc.fraction_bits) as i64
    };
    let (start, end) = (residue(arc.from), residue(arc.to));
    arc.rim = Rim::Nominal { start, end };
    arc
}

prop_compose! {
    /// Radii of all magnitudes up to 3000 BLU, any centre, any ends near the rim.
    fn small_arc()(
        bits in 0_u8..=16,
        centre in [-50_000_000_i64..50_000_000, -50_000_000_i64..50_000_000],
        magnitude in 0.5_f64..8.0,
        from in 0.0_f64..6.3,
        to in 0.0_f64..6.3,
        stretch in -2.0_f64..2.0,
        direction in direction(),
        turns in 0_u32..3,
    ) -> ArcMove {
        let radius = magnitude.exp();
        ArcMove {
            from: on_circle(centre, bits, radius, from),
            to: on_circle(centre, bits, radius + stretch, to),
            centre,
            fraction_bits: bits,
            direction,
            turns,
            rim: Rim::Spiral,
        }
    }
}

prop_compose! {
    /// Radii up to 2^28 BLU, about a thousand events long.
    fn huge_arc()(
        bits in 0_u8..=16,
        magnitude in 10.0_f64..28.0,
        angle in 0.0_f64..6.3,
        length in 1.0_f64..1000.0,
        fraction in [0_i64..65536, 0_i64..65536],
        direction in direction(),
    ) -> ArcMove {
        let radius = magnitude.exp2();
        let centre = fraction.map(|fraction| fraction >> (16 - bits));
        let way = match direction {
            Direction::Clockwise => -length / radius,
            Direction::CounterClockwise => length / radius,
        };
        ArcMove {
            from: on_circle(centre, bits, radius, angle),
            to: on_circle(centre, bits, radius, angle + way),
            centre,
            fraction_bits: bits,
            direction,
            turns: 0,
            rim: Rim::Spiral,
        }
    }
}

/// Rounding of a lattice point may place the end slightly behind the start. The arc is then a whole
/// turn, which is too long to walk for huge radii.
fn is_short(arc: &ArcMove) -> bool {
    let [x, y] =
        [0, 1].map(|axis| i64::from(arc.from[axis]) - (arc.centre[axis] >> arc.fraction_bits));
    let [dx, dy] = [0, 1].map(|axis| i64::from(arc.to[axis]) - i64::from(arc.from[axis]));
    let ahead = x * dy - y * dx;
    let ahead = if arc.direction == Direction::Clockwise {
        -ahead
    } else {
        ahead
    };
    ahead > 2 * (x.abs() + y.abs())
}

/// Checks all properties of an arc; returns `None` where there is no arc.
fn check_arc(arc_move: &ArcMove) -> Result<Option<Vec<[i64; 2]>>, TestCaseError> {
    let arc = match Arc::new(arc_move) {
        Ok(arc) => arc,
        Err(ArcError::Degenerate) => return Ok(None),
        Err(error) => return Err(TestCaseError::fail(error.to_string())),
    };
    let wide = Arc::wide(arc_move).unwrap();
    // The arc with 32-bit state is the same arc where it is accepted.
    match NarrowArc::new(arc_move) {
        Ok(narrow) => prop_assert!(arc.is_narrow() && narrow.eq(arc.clone())),
        Err(error) => prop_assert!(!arc.is_narrow() && error == ArcError::Wide),
    }
    let steps: Vec<Step> = arc.clone().collect();
    // 32-bit and 64-bit state give the same events.
    prop_assert!(steps.iter().copied().eq(wide));
    // The counts and sums of the dry pass are those of the walk.
    prop_assert_eq!(steps.len(), arc.events() as usize);
    prop_assert_eq!(
        steps.iter().map(|step| u64::from(step.sweep)).sum::<u64>(),
        arc.total_sweep()
    );
    prop_assert_eq!(
        steps.iter().map(|step| step.sweep).max(),
        Some(arc.largest_sweep())
    );
    // Every event moves and takes time, and the announced number of events comes.
    prop_assert!(steps.iter().all(|step| step.axes != 0 && step.sweep > 0));
    let points = points(arc_move.from, steps.iter().copied());
    // The arc always ends exactly.
    prop_assert_eq!(points.last(), Some(&arc_move.to.map(i64::from)));
    // The sweep is |P x d|, or half the radius where that is more.
    let one = 1_i128 << arc_move.fraction_bits;
    let shift = i32::from(arc_move.fraction_bits) - i32::from(arc.sweep_bits());
    for (at, step) in points.iter().zip(&steps) {
        let [x, y] =
            [0, 1].map(|axis| i128::from(at[axis]) * one - i128::from(arc_move.centre[axis]));
        let cross = x * i128::from(step.delta(1)) - y * i128::from(step.delta(0));
        let turning = if arc_move.direction == Direction::Clockwise {
            -cross
        } else {
            cross
        };
        let exact = turning >> shift;
        prop_assert!(
            i128::from(step.sweep) == exact
                || (exact < i128::from(step.sweep)
                    && i128::from(step.sweep).abs_diff(i128::from(arc.radius() / 2)) <= 1)
        );
    }
    Ok(Some(points))
}

/// Index of the last point to which the error bound applies. After it the path runs off to a
/// rounded end, as soon as it is level with it.
fn before_run_off(points: &[[i64; 2]], arc: &ArcMove) -> usize {
    let to = arc.to.map(i64::from);
    let is_near = |at: &[i64; 2]| (at[0] - to[0]).abs() <= 1 && (at[1] - to[1]).abs() <= 1;
    points
        .iter()
        .rposition(|at| !is_near(at))
        .map_or(0, |at| at + 1)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// A line ends on its target, with as many events as its longest axis has steps.
    #[test]
    fn line_ends_on_target(delta in [-3000_i32..3000, -3000_i32..3000, -300_i32..300, -3_i32..3]) {
        let line = Line::new(delta);
        let events = delta.iter().map(|d| d.unsigned_abs()).max().unwrap();
        prop_assert_eq!(line.events(), events);
        prop_assert_eq!(line.len(), events as usize);
        let points = points([0; 4], line);
        prop_assert_eq!(points.len(), events as usize + 1);
        prop_assert_eq!(points.last(), Some(&delta.map(i64::from)));
        // It is never more than half a step off in any axis.
        for (k, point) in points.iter().enumerate() {
            for (at, d) in point.iter().zip(delta) {
                let twice_error = 2 * (at * i64::from(events) - k as i64 * i64::from(d));
                prop_assert!(twice_error.abs() <= i64::from(events));
            }
        }
    }

    /// The return path visits the same points.
    #[test]
    fn line_reverses(delta in [-500_i32..500, -500_i32..500, -500_i32..500]) {
        let there = points([0; 3], Line::new(delta));
        let mut back = points(delta, Line::new(delta.map(|d| -d)));
        back.reverse();
        prop_assert_eq!(there, back);
    }

    /// Lines of any length start according to the formula (the end would take too long).
    #[test]
    fn long_line_follows_the_formula(delta in any::<[i32; 3]>()) {
        let events = delta.iter().map(|d| i64::from(d.unsigned_abs())).max().unwrap();
        for (k, point) in points([0; 3], Line::new(delta).take(300)).iter().enumerate() {
            for (at, d) in point.iter().zip(delta) {
                let twice = 2 * k as i128 * i128::from(d) + i128::from(events);
                let exact = || twice.div_euclid(2 * i128::from(events));
                prop_assert!(events == 0 || i128::from(*at) == exact());
            }
        }
    }

    /// Small arcs, spirals and several turns: end, sums, widths; the distance outside the band
    /// between the two radii is small.
    #[test]
    fn small_arcs_hold(arc in small_arc()) {
        let Some(points) = check_arc(&arc)? else { return Ok(()) };
        let one = f64::from(1_u32 << arc.fraction_bits);
        let radius = |at: [i64; 2]| (square(at, &arc) as f64).sqrt() / one;
        let ends = [arc.from, arc.to].map(|at| radius(at.map(i64::from)));
        let (inner, outer) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        if inner > 12.0 {
            for &at in &points {
                prop_assert!(radius(at) - outer < 0.75 && inner - radius(at) < 0.75);
            }
        }
    }

    /// Huge arcs, which need 64-bit state or few fraction bits.
    #[test]
    fn huge_arcs_hold(arc in huge_arc()) {
        prop_assume!(is_short(&arc));
        check_arc(&arc)?;
    }

    /// Whole-step centre, integer R^2: strictly less than half a step, decided in integers. |rho -
    /// R| < 1/2 where (D - 1/4)^2 < R^2, that is (4 D - 1)^2 < 16 R^2, for D = rho^2 - R^2.
    #[test]
    fn integer_circles_stay_within_half_a_step(
        start in [-3000_i32..3000, -3000_i32..3000],
        centre in [-1000_i64..1000, -1000_i64..1000],
        direction in direction(),
    ) {
        let arc = ArcMove {
            from: start, to: start, centre, fraction_bits: 0, direction, turns: 0, rim: Rim::Spiral,
        };
        let Some(points) = check_arc(&arc)? else { return Ok(()) };
        let squared = square(start.map(i64::from), &arc);
        for at in points {
            let d = square(at, &arc) - squared;
            prop_assert!((4 * d - 1).pow(2) < 16 * squared);
        }
    }

    /// Any centre: at most 0.5 + 2^-f / (4 r) from the nominal circle, except for the first point
    /// and the run-off.
    #[test]
    fn nominal_arcs_stay_within_the_bound(arc in small_arc(), square_offset in 0.0_f64..1.0) {
        // The end has to be on the same circle here.
        let one = f64::from(1_u32 << arc.fraction_bits);
        let start = (square(arc.from.map(i64::from), &arc) as f64).sqrt() / one;
        let radius = start + 0.3 * (square_offset - 0.5);
        prop_assume!(radius > 2.0);
        let from_centre = |axis: usize| f64::from(arc.to[axis]) - arc.centre[axis] as f64 / one;
        let mut arc = arc;
        let angle = from_centre(1).atan2(from_centre(0));
        arc.to = on_circle(arc.centre, arc.fraction_bits, radius, angle);
        let squared = (radius * one).powi(2) as i128;
        let arc = nominal(arc, squared);
        let Some(points) = check_arc(&arc)? else { return Ok(()) };
        let radius = (squared as f64).sqrt() / one;
        let bound = 0.5 + 1.0 / (one * 4.0 * radius) + 1e-6;
        let bound = if arc.fraction_bits == 0 { bound + 0.5 / radius } else { bound };
        for &at in points.get(2..before_run_off(&points, &arc)).unwrap_or(&[]) {
            let error = (square(at, &arc) as f64).sqrt() / one - radius;
            prop_assert!(error.abs() <= bound, "{} > {} at {:?}", error, bound, at);
        }
    }

    /// The other axes of a helix end exactly and stay within one step of their share of the sweep.
    /// Events with these axes alone take time too, and the sums are those announced.
    #[test]
    fn helix_is_in_proportion(
        arc in small_arc(),
        along in [-20_000_i32..20_000, -2_000_i32..2_000],
    ) {
        let along = [along[0], 7, along[1], 9];
        let helix = match Path::<4>::arc(&arc, [3, 1], along) {
            Ok(Path::Arc(helix)) => helix,
            Ok(_) => unreachable!("an arc"),
            Err(_) => return Ok(()),
        };
        let steps: Vec<Step> = helix.clone().collect();
        prop_assert_eq!(steps.len(), helix.events() as usize);
        let sweep = steps.iter().map(|step| u64::from(step.sweep)).sum::<u64>();
        prop_assert_eq!(sweep, helix.total_sweep());
        prop_assert_eq!(steps.iter().map(|step| step.sweep).max(), Some(helix.largest_sweep()));
        // Half a step of rounding at the events of the plane and another half within bursts. The
        // shares of a burst are whole units of sweep.
        let one_step = u128::from(helix.total_sweep()) * 65537 / 65536;
        let mut at = [0_i64; 4];
        let mut sweep = 0_u128;
        for step in &steps {
            prop_assert!(step.sweep > 0 && step.axes != 0);
            for (at, delta) in at.iter_mut().zip(step.deltas::<4>()) {
                *at += i64::from(delta);
            }
            sweep += u128::from(step.sweep);
            for axis in [0, 2] {
                let share = i128::from(along[axis]) * sweep as i128;
                let error = i128::from(at[axis]) * i128::from(helix.total_sweep()) - share;
                prop_assert!(error.unsigned_abs() <= one_step);
            }
        }
        let plane = [1, 0].map(|axis| i64::from(arc.to[axis]) - i64::from(arc.from[axis]));
        prop_assert_eq!(at, [i64::from(along[0]), plane[0], i64::from(along[2]), plane[1]]);
        let alone: Vec<[i8; 2]> = steps.iter().map(|step| [step.delta(3), step.delta(1)])
            .filter(|delta| *delta != [0, 0]).collect();
        prop_assert!(alone.into_iter().eq(Arc::new(&arc).unwrap().map(Step::deltas)));
    }

    /// No input panics, and every accepted arc is within its bounds.
    #[test]
    fn any_arc_is_accepted_or_refused(
        from in any::<[i32; 2]>(), to in any::<[i32; 2]>(), centre in any::<[i64; 2]>(),
        fraction_bits in any::<u8>(), direction in direction(), turns in any::<u32>(),
        residues in any::<[i64; 2]>(),
    ) {
        let [start, end] = residues;
        for rim in [Rim::Spiral, Rim::Nominal { start, end }] {
            let result = Arc::new(&ArcMove {
                from,
                to,
                centre,
                fraction_bits,
                direction,
                turns,
                rim,
            });
            prop_assert!(result.is_err() || fraction_bits <= 30);
        }
    }
}

/// The longest possible line, without overflow.
#[test]
fn longest_line() {
    let line = Line::new([i32::MIN, i32::MAX, 0]);
    assert_eq!(line.events(), 1 << 31);
    let first: Vec<_> = line.take(3).map(Step::deltas::<3>).collect();
    assert_eq!(first, [[-1, 1, 0]; 3]);
}

/// Fraction bits at the edges of the rule.
#[test]
fn fraction_bits() {
    assert_eq!(fraction_bits_for(0), 16);
    assert_eq!(fraction_bits_for(10_829), 16);
    assert_eq!(fraction_bits_for(10_830), 15);
    assert_eq!(fraction_bits_for(44_374_996), 4);
    assert_eq!(fraction_bits_for(44_374_997), 16);
    assert_eq!(fraction_bits_for(u64::MAX), 16);
}

/// Refused arcs: one without motion, and one that would be too long.
#[test]
fn refusals() {
    let arc = ArcMove {
        from: [0, 0],
        to: [5, 5],
        centre: [0, 0],
        fraction_bits: 0,
        direction: Direction::Clockwise,
        turns: 0,
        rim: Rim::Spiral,
    };
    assert_eq!(Arc::new(&arc).err(), Some(ArcError::Degenerate));
    let long = ArcMove {
        from: [5, 5],
        turns: u32::MAX,
        ..arc
    };
    assert_eq!(Arc::new(&long).err(), Some(ArcError::TooLong));
    let off = ArcMove {
        from: [5, 5],
        rim: Rim::Nominal {
            start: 1000,
            end: 0,
        },
        ..arc
    };
    assert_eq!(Arc::new(&off).err(), Some(ArcError::OffRim));
    let fine = ArcMove {
        from: [5, 5],
        ..arc
    };
    assert_eq!(
        Helix::new(&fine, [1, 1], [0; 3]).err(),
        Some(ArcError::Plane)
    );
}
