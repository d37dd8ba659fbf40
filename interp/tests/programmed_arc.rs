//! Arcs from nanometres to steps, compared with the recorded arcs and with the exact circle.

use husillo_interp::{Arc, ArcError, Direction, ProgrammedArc, Scale};
use proptest::prelude::*;
use serde_json::Value;

/// A step of 2^16 nm: the centre of a record, with up to 16 bits after the point, is then a whole
/// number.
const NM: i64 = 1 << 16;

fn pair(value: &Value) -> [i64; 2] {
    [0, 1].map(|index| value[index].as_i64().expect("an integer"))
}

/// -4 to 4 for the nine steps, as in the record: (x + 1) * 3 + y + 1.
fn digit([x, y]: [i8; 2]) -> char {
    char::from(b'0' + ((x + 1) * 3 + y + 1) as u8)
}

#[test]
fn recorded_arcs_come_from_nanometres() {
    let oracle: Value = serde_json::from_str(include_str!("data/arcs_general.json")).unwrap();
    let scale = Scale::new(NM as u32, 1).unwrap();
    let (mut circles, mut spirals) = (0, 0);
    for record in oracle["arcs"].as_array().unwrap() {
        // A record with its own nominal radius is not a programmed arc, whose ends are exact.
        if !record["R2"].is_null() {
            continue;
        }
        let steps = [pair(&record["S"]), pair(&record["E"])];
        let bits = record["f"].as_i64().unwrap();
        let centre = pair(&record["C"]).map(|at| at << (16 - bits));
        let [from, to] = steps.map(|at| at.map(|step| step * NM));
        let square = |at: [i64; 2]| {
            let [x, y] = [at[0] - centre[0], at[1] - centre[1]].map(i128::from);
            x * x + y * y
        };
        let radii = [from, to].map(|at| (square(at) as f64).sqrt());
        let is_spiral = square(from) != square(to);
        if is_spiral && bits != 16 {
            // The record spreads the change of radius in coarser units.
            continue;
        }
        let arc = ProgrammedArc {
            from,
            to,
            centre,
            direction: Direction::from_clockwise(record["dir"] == "cw"),
            turns: record["turns"].as_u64().unwrap() as u32,
            // With a mismatch of a step the path passes through both ends, as that of the record
            // does.
            mismatch_nm: if is_spiral { NM as u64 } else { 0 },
        };
        let steps = steps.map(|at| at.map(|step| step as i32));
        let grid = arc
            .on_grid(scale, steps)
            .expect("a recorded arc is possible");
        let larger = radii[0].max(radii[1]) / NM as f64;
        assert!(
            (f64::from(grid.radius_steps) - larger).abs() <= 0.5,
            "{record}"
        );
        let walked: String = Arc::new(&grid.arc)
            .unwrap()
            .map(|step| digit(step.deltas()))
            .collect();
        assert_eq!(walked, record["steps"].as_str().unwrap(), "{record}");
        if is_spiral {
            spirals += 1;
        } else {
            circles += 1;
        }
    }
    assert_eq!((circles, spirals), (48, 9));
}

#[test]
fn what_cannot_go_round_says_so() {
    let scale = Scale::new(1000, 1).unwrap();
    let arc = |from, to, centre, is_clockwise| ProgrammedArc {
        from,
        to,
        centre,
        direction: Direction::from_clockwise(is_clockwise),
        turns: 0,
        mismatch_nm: 0,
    };
    let on_grid = |arc: ProgrammedArc| {
        let steps = [arc.from, arc.to].map(|at| at.map(|nm| scale.nearest(nm).unwrap()));
        arc.on_grid(scale, steps)
    };
    // Both ends round to one step. A short arc has no motion; the long one is a whole turn.
    let tiny = arc([10_000, 0], [10_000, 10], [0, 0], false);
    assert_eq!(on_grid(tiny), Err(ArcError::Degenerate));
    let long = ProgrammedArc {
        direction: Direction::from_clockwise(true),
        ..tiny
    };
    let circle = on_grid(long).unwrap();
    assert_eq!(Arc::new(&circle.arc).unwrap().quadrants(), 4);
    // 2^28 steps of radius.
    let large = 1000 << 28;
    let huge = arc([large, 0], [0, large], [0, 0], false);
    assert_eq!(on_grid(huge), Err(ArcError::TooLarge));
    let nearly = on_grid(arc([large - 1000, 0], [0, large - 1000], [0, 0], false));
    assert_eq!(nearly.unwrap().radius_steps, (1 << 28) - 1);
}

#[test]
fn any_integers_are_answered() {
    let edges = [i64::MIN, i64::MIN + 1, -1, 0, 1, i64::MAX];
    let scales = [(1, 1), (u32::MAX, 1), (1, u32::MAX)].map(|(nm, steps)| Scale::new(nm, steps));
    for scale in scales.into_iter().flatten() {
        for a in edges {
            for b in edges {
                let arc = ProgrammedArc {
                    from: [a, b],
                    to: [b, a],
                    centre: [b, b],
                    direction: Direction::from_clockwise(a > b),
                    turns: u32::MAX,
                    mismatch_nm: u64::MAX,
                };
                let [[low, high], _] = arc.extent();
                assert!(low <= high);
                let _ = arc.on_grid(scale, [[i32::MIN, i32::MAX], [i32::MAX, i32::MIN]]);
            }
        }
    }
}

proptest! {
    /// The whole path is on the exact circle within half a step and the rounding of the centre. Its
    /// first and last steps are within the rounding of the ends. The path stays within the extent.
    #[test]
    fn the_path_follows_the_exact_circle(
        (nm, per) in prop_oneof![Just((1_000_000, 107)), Just((140, 1)), Just((3_000_000, 1_001))],
        radius in 20.0..3000.0_f64,
        (start, sweep) in (0.0..std::f64::consts::TAU, 0.1..6.2_f64),
        centre in prop::array::uniform2(-1_000_000_i64..1_000_000),
        is_clockwise: bool,
    ) {
        let scale = Scale::new(nm, per).unwrap();
        let step = f64::from(nm) / f64::from(per);
        let at = |angle: f64| [
            centre[0] + (radius * step * angle.cos()).round() as i64,
            centre[1] + (radius * step * angle.sin()).round() as i64,
        ];
        let end = if is_clockwise { start - sweep } else { start + sweep };
        let arc = ProgrammedArc {
            from: at(start),
            to: at(end),
            centre,
            direction: Direction::from_clockwise(is_clockwise),
            turns: 0,
            mismatch_nm: 1,
        };
        let [first, last] = [arc.from, arc.to].map(|at| at.map(|nm| scale.nearest(nm).unwrap()));
        let grid = arc.on_grid(scale, [first, last]).unwrap();
        // The ends are on whole nanometres.
        let off = (f64::from(grid.radius_steps) - radius).abs();
        prop_assert!(off <= 0.5 + 1.0 / step, "{off}");
        let path = Arc::new(&grid.arc).unwrap();
        let events = path.events();
        prop_assert!((f64::from(events) / (radius * sweep) - 0.85).abs() < 0.3);
        let exact = (arc.spokes()[0][0] as f64).hypot(arc.spokes()[0][1] as f64) / step;
        let [[low_x, high_x], [low_y, high_y]] = arc.extent();
        let mut at = first;
        for (number, event) in (1..).zip(path) {
            at = [0, 1].map(|axis| at[axis] + i32::from(event.delta(axis)));
            let [x, y] = [0, 1].map(|axis| f64::from(at[axis]) - centre[axis] as f64 / step);
            let error = (x.hypot(y) - exact).abs();
            let bound = if number + 3 > events { 0.7072 } else { 0.5001 };
            prop_assert!(error < bound, "{error} at {number} of {events}");
            let [x, y] = at.map(|at| scale.position(at) as f64);
            let slack = 0.7072 * step + 1.0;
            prop_assert!(x > low_x as f64 - slack && x < high_x as f64 + slack);
            prop_assert!(y > low_y as f64 - slack && y < high_y as f64 + slack);
        }
        prop_assert_eq!(at, last);
    }
}
