//! Circles in planes whose axes have steps of different length, against the exact circle.

use husillo_interp::{ArcError, Direction, Helix, Interpolator, ProgrammedArc, Scale};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A circular arc by its angles, and the two steps.
#[derive(Clone, Debug)]
struct Case {
    scales: [(u32, u32); 2],
    radius_nm: f64,
    from: f64,
    /// Counter-clockwise angle if positive.
    sweep: f64,
    centre: [i64; 2],
}

impl Case {
    fn scales(&self) -> [Scale; 2] {
        self.scales
            .map(|(nm, steps)| Scale::new(nm, steps).unwrap())
    }

    /// Nanometres of a step of each axis.
    fn steps_nm(&self) -> [f64; 2] {
        self.scales
            .map(|(nm, steps)| f64::from(nm) / f64::from(steps))
    }

    fn longer(&self) -> f64 {
        let [x, y] = self.steps_nm();
        x.max(y)
    }

    fn at(&self, angle: f64) -> [i64; 2] {
        let [x, y] = self.centre;
        let (sin, cos) = angle.sin_cos();
        let (off_x, off_y) = (self.radius_nm * cos, self.radius_nm * sin);
        [x + off_x.round() as i64, y + off_y.round() as i64]
    }

    fn arc(&self) -> ProgrammedArc {
        let turns = (self.sweep.abs() / TAU).floor();
        ProgrammedArc {
            from: self.at(self.from),
            to: self.at(self.from + self.sweep),
            centre: self.centre,
            direction: Direction::from_clockwise(self.sweep < 0.0),
            turns: turns as u32,
            mismatch_nm: 0,
        }
    }

    /// Steps of both ends.
    fn ends(&self) -> [[i32; 2]; 2] {
        let arc = self.arc();
        let [x, y] = self.scales();
        [arc.from, arc.to].map(|[at_x, at_y]| [x.nearest(at_x).unwrap(), y.nearest(at_y).unwrap()])
    }

    fn helix(&self, along: i32) -> Result<Helix<3, husillo_interp::Conic>, ArcError> {
        let ellipse = self.arc().on_grids(self.scales(), self.ends())?;
        Helix::of_ellipse(&ellipse, [2, 0], [0, along, 0])
    }
}

fn cases() -> impl Strategy<Value = Case> {
    let scale = prop_oneof![
        Just((2500, 1)),
        Just((1250, 1)),
        Just((1_000_000, 107)),
        Just((1_000_000, 80)),
        Just((25_400_000, 4001)),
        (500_u32..20_000, 1_u32..5),
    ];
    let centre = [-300_000_000_i64..300_000_000, -300_000_000_i64..300_000_000];
    (
        [scale.clone(), scale],
        // From 3 steps of the longer axis to 20 mm.
        0.0_f64..1.0,
        0.0..TAU,
        -2.5 * TAU..2.5 * TAU,
        centre,
    )
        .prop_map(|(scales, size, from, sweep, centre)| {
            let mut case = Case {
                scales,
                radius_nm: 0.0,
                from,
                sweep,
                centre,
            };
            let least = 3.01 * case.longer();
            case.radius_nm = least * (20e6 / least).powf(size);
            case
        })
        .prop_filter("a real arc", |case| {
            let [x, y] = case.steps_nm();
            case.sweep.abs() * case.radius_nm > 3.0 * case.longer() && x != y
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// The path ends at its end. No point is farther from the circle than half of the longer step
    /// (and a little where the circle is small); the first point and the run-off at the end are
    /// rounded in both axes. Each axis reverses where the circle does. Time is proportional to the
    /// angle.
    #[test]
    fn the_circle_is_followed(case in cases()) {
        let helix = case.helix(0);
        prop_assert!(helix.is_ok(), "{:?}", helix.err());
        let helix = helix.unwrap();
        let [start, end] = case.ends();
        let steps_nm = case.steps_nm();
        let real = |at: [i32; 2]| {
            let [x, y] = [0, 1].map(|axis| f64::from(at[axis]) * steps_nm[axis]);
            [x - case.centre[0] as f64, y - case.centre[1] as f64]
        };
        let total = helix.total_sweep() as f64;
        let (mut at, mut swept, mut turned, mut worst) = (start, 0.0, 0.0, 0.0_f64);
        let (mut ways, mut reversals) = ([0_i8; 2], [0_u32; 2]);
        let mut before = real(start);
        let events = helix.remaining();
        for (event, step) in (1..).zip(helix.clone()) {
            let [second, none, first]: [i8; 3] = step.deltas();
            prop_assert_eq!(none, 0);
            for (axis, delta) in [first, second].into_iter().enumerate() {
                at[axis] += i32::from(delta);
                if delta != 0 {
                    reversals[axis] += u32::from(ways[axis] == -delta);
                    ways[axis] = delta;
                }
            }
            let now = real(at);
            let off = (now[0].hypot(now[1]) - case.radius_nm).abs() / case.longer();
            if event + 2 < events {
                worst = worst.max(off);
            }
            prop_assert!(off < 1.1, "event {} of {}: {} steps off", event, events, off);
            let cross = before[0] * now[1] - before[1] * now[0];
            turned += cross.atan2(before[0] * now[0] + before[1] * now[1]);
            before = now;
            swept += f64::from(step.sweep);
            // The angle of the time is that of the point, within two steps.
            let angle = swept / total * case.sweep;
            let small = case.longer() / case.radius_nm;
            let slack = 3.0 * small + (2e-3 + 2.0 * small * small) * case.sweep.abs();
            prop_assert!((angle - turned).abs() < slack, "{event}: {angle} {turned} {slack}");
        }
        prop_assert_eq!(at, end);
        let small = case.longer() / case.radius_nm;
        prop_assert!(worst <= 0.5 + 0.3 * small + 2e-3, "{worst} at {}", 1.0 / small);
        // An axis reverses at most where the circle does, and at an end that rounding moved.
        let quarter = TAU / 4.0;
        for axis in [0, 1] {
            let first = (case.from / quarter - f64::from(axis)) / 2.0;
            let last = ((case.from + case.sweep) / quarter - f64::from(axis)) / 2.0;
            let exact = (last.floor() - first.floor()).abs();
            let found = f64::from(reversals[axis as usize]);
            prop_assert!((found - exact).abs() <= 2.0, "{found} {exact}");
        }
        // Length of the path, from its sweep and its radius in steps of the first axis.
        let length = total / helix.radius() as f64 * steps_nm[0];
        let exact = case.radius_nm * case.sweep.abs();
        // Rounded at both ends, and where the axis of the rows changes. A circle of a few steps is
        // a polygon.
        let slack = (2.5 + case.sweep.abs() / quarter) * case.longer()
            + (1e-4 + 4.0 * small * small) * exact;
        prop_assert!((length - exact).abs() < slack, "{length} {exact}");
    }

    /// Another axis moves in proportion to the angle and arrives.
    #[test]
    fn helices_rise_evenly(case in cases(), along in -3000_i32..3000) {
        let flat = case.helix(0);
        let helix = case.helix(along);
        prop_assert_eq!(flat.is_ok(), helix.is_ok());
        let Ok(helix) = helix else { return Ok(()) };
        let total = helix.total_sweep() as f64;
        let (mut risen, mut swept) = (0, 0.0);
        for step in helix {
            risen += i32::from(step.delta(1));
            swept += f64::from(step.sweep);
            prop_assert!((f64::from(along) * swept / total - f64::from(risen)).abs() < 1.6);
        }
        prop_assert_eq!(risen, along);
    }
}

/// An arc as a CAM system prints it: ends and centre are rounded to this unit, so the radii differ.
fn printed(case: &Case, unit_nm: i64) -> ProgrammedArc {
    let exact = case.arc();
    let [from, to, centre] = [exact.from, exact.to, exact.centre]
        .map(|point| point.map(|at| (at + unit_nm / 2).div_euclid(unit_nm) * unit_nm));
    let radius = |[x, y]: [i64; 2]| ((x - centre[0]) as f64).hypot((y - centre[1]) as f64);
    ProgrammedArc {
        from,
        to,
        centre,
        mismatch_nm: (radius(from) - radius(to)).abs().round() as u64,
        turns: 0,
        ..exact
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    /// What `on_grids` takes is an arc that reaches its end. Only an arc shorter than two of the
    /// longer steps has no path.
    #[test]
    fn printed_arcs_have_a_path(
        case in cases(),
        unit_nm in prop_oneof![Just(100), Just(1000), Just(2540), Just(10_000), Just(25_400)],
    ) {
        let arc = printed(&case, unit_nm);
        let scales = case.scales();
        let ends = [arc.from, arc.to]
            .map(|at| [0, 1].map(|axis| scales[axis].nearest(at[axis]).unwrap()));
        let Ok(grid) = arc.on_grids(scales, ends) else { return Ok(()) };
        match Helix::<2, _>::of_ellipse(&grid, [0, 1], [0, 0]) {
            Ok(helix) => {
                let mut at = ends[0];
                for step in helix {
                    let deltas: [i8; 2] = step.deltas();
                    for (at, delta) in at.iter_mut().zip(deltas) {
                        *at += i32::from(delta);
                    }
                }
                prop_assert_eq!(at, ends[1]);
            }
            Err(error) => {
                let chord = ((arc.to[0] - arc.from[0]) as f64)
                    .hypot((arc.to[1] - arc.from[1]) as f64);
                prop_assert!(chord < 2.0 * case.longer(), "{error:?}, {chord} nm, {arc:?}");
            }
        }
    }
}

/// Circles whose ends are the same or a little apart are short or whole as the program has it, from
/// any point of the circle.
#[test]
fn close_ends_are_short_or_whole_as_programmed() {
    for (angle, radius_nm) in (0..360).zip([40_000.0, 300_000.0, 5e6].into_iter().cycle()) {
        for step in [-3.0, -1.0, 0.0, 1.0, 3.0] {
            for clockwise in [1.0, -1.0] {
                let mut case = Case {
                    scales: [(2500, 1), (1250, 1)],
                    radius_nm,
                    from: f64::from(angle).to_radians(),
                    sweep: clockwise * (TAU - 0.4 * step * 2500.0 / radius_nm),
                    centre: [1_000_300, -2_000_700],
                };
                if step <= 0.0 {
                    // Beyond a whole turn it is a short arc, or a whole one where nothing is left.
                    case.sweep -= clockwise * TAU;
                    if step == 0.0 {
                        case.sweep = clockwise * TAU;
                    }
                }
                let arc = ProgrammedArc {
                    turns: 0,
                    ..case.arc()
                };
                let grid = arc.on_grids(case.scales(), case.ends()).unwrap();
                let helix = Helix::<2, _>::of_ellipse(&grid, [0, 1], [0, 0]);
                let Ok(helix) = helix else {
                    assert!(step < 0.0, "{case:?}");
                    continue;
                };
                let length = helix.total_sweep() as f64 / helix.radius() as f64 * 2500.0;
                let exact = case.sweep.abs() * radius_nm;
                assert!(
                    (length - exact).abs() < 10_000.0,
                    "{case:?}: {length} {exact}"
                );
            }
        }
    }
}

/// Radii that differ, as a program with three decimals of an inch has them: the centre moves, and
/// the path stays within the difference.
#[test]
fn a_wrong_radius_moves_the_centre() {
    for (angle, sweep) in [
        (0.3, 1.0),
        (2.0, -3.0),
        (4.0, 4.5),
        (5.5, -0.2),
        (1.0, 0.01),
    ] {
        let case = Case {
            scales: [(2500, 1), (1250, 1)],
            radius_nm: 20e6,
            from: angle,
            sweep,
            centre: [0, 0],
        };
        let mut arc = case.arc();
        let longer = Case {
            radius_nm: 20_030_000.0,
            ..case.clone()
        };
        arc.to = longer.arc().to;
        arc.mismatch_nm = 30_000;
        let [x, y] = case.scales();
        let ends = [arc.from, arc.to]
            .map(|[at_x, at_y]| [x.nearest(at_x).unwrap(), y.nearest(at_y).unwrap()]);
        let grid = arc.on_grids(case.scales(), ends).unwrap();
        let helix = Helix::<2, _>::of_ellipse(&grid, [0, 1], [0, 0]).unwrap();
        let [mut at, end] = ends;
        for step in helix {
            for (at, delta) in at.iter_mut().zip(step.deltas::<2>()) {
                *at += i32::from(delta);
            }
            let radius = (f64::from(at[0]) * 2500.0).hypot(f64::from(at[1]) * 1250.0);
            assert!(
                (20e6 - 35_000.0..20e6 + 65_000.0).contains(&radius),
                "{angle} {sweep}: {radius}"
            );
        }
        assert_eq!(at, end);
    }
    // Almost a whole turn: no circle near the programmed one has both ends.
    let case = Case {
        scales: [(2500, 1), (1250, 1)],
        radius_nm: 20e6,
        from: 0.0,
        sweep: 6.0,
        centre: [0, 0],
    };
    let mut arc = case.arc();
    arc.to = [20_030_000, -1000];
    arc.mismatch_nm = 30_000;
    let ends = [[8000, 0], [8012, -1]];
    assert_eq!(arc.on_grids(case.scales(), ends), Err(ArcError::Unequal));
}

#[test]
fn what_is_out_of_range_is_an_error() {
    let case = |scales, radius_nm| Case {
        scales,
        radius_nm,
        from: 0.2,
        sweep: 2.0,
        centre: [0, 0],
    };
    let found = |case: Case| case.helix(0).map(|_| ());
    let usual = [(2500, 1), (1250, 1)];
    assert_eq!(found(case(usual, 7_000.0)), Err(ArcError::Degenerate));
    assert_eq!(found(case(usual, 2.7e9)), Err(ArcError::TooLarge));
    assert_eq!(found(case(usual, 2.6214e9)), Ok(()));
    assert_eq!(found(case([(1250, 1), (320_000, 1)], 2.6214e9)), Ok(()));
    assert_eq!(
        found(case([(2500, 1), (9, 1)], 1e6)),
        Err(ArcError::Unequal)
    );
    assert_eq!(found(case([(2500, 1), (10, 1)], 0.1e6)), Ok(()));
    let ellipse = case(usual, 1e6)
        .arc()
        .on_grids(case(usual, 1e6).scales(), [[0; 2]; 2]);
    let plane = Helix::<2, _>::of_ellipse(&ellipse.unwrap(), [1, 1], [0, 0]);
    assert_eq!(plane.err(), Some(ArcError::Plane));
}
